"""Arrays look into the result, stay valid when it is let go, and agree with each other."""
import gc
import os
import unittest
from pathlib import Path

import numpy as np

import cleave

root = Path(os.environ["CLEAVE_ROOT"])


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = cleave.run(root / "examples/wedge_slope/wedge_slope.toml")

    def test_they_share_memory_and_cannot_be_written(self):
        result = self.result
        self.assertTrue(np.shares_memory(result.points, result.points))
        self.assertTrue(np.shares_memory(result.blocks.volume, result._made.block_arrays()["volume"]))
        for array in (result.points, result.blocks.volume, result.faces.normal):
            with self.assertRaises(ValueError):
                array[0] = 1

    def test_they_outlive_the_result(self):
        result = cleave.run(root / "examples/wedge_slope/wedge_slope.toml")
        volume, points, before = result.blocks.volume, result.points, result.blocks.volume.copy()
        del result
        gc.collect()
        np.testing.assert_array_equal(volume, before)
        self.assertTrue(np.isfinite(points).all())

    def test_volumes_follow_from_faces(self):
        """Divergence: V = sum of (area * normal . centroid) / 3 over the faces of a block."""
        faces, blocks = self.result.faces, self.result.blocks
        middle = blocks.centroid[faces.block]
        share = faces.area * np.einsum("ij,ij->i", faces.normal, faces.centroid - middle) / 3
        np.testing.assert_allclose(np.bincount(faces.block, share, len(blocks)), blocks.volume, rtol=1e-12)
        np.testing.assert_array_equal(np.bincount(faces.block, minlength=len(blocks)), blocks.faces)

    def test_areas_follow_from_corners(self):
        faces, points = self.result.faces, self.result.points
        for i in range(len(faces)):
            area = np.zeros(3)
            for loop in faces.loops(i):
                corner = points[loop]
                area += np.cross(corner, np.roll(corner, -1, axis=0)).sum(axis=0) / 2
            self.assertAlmostEqual(area @ faces.normal[i], faces.area[i], delta=1e-9 * max(1, faces.area[i]))
        with self.assertRaises(IndexError):
            faces.loops(len(faces))

    def test_roles_and_numbers(self):
        faces, blocks = self.result.faces, self.result.blocks
        self.assertEqual(cleave.ROLES[faces.role.min()], "joint")
        joint = faces.role == cleave.ROLES.index("joint")
        self.assertTrue((faces.joint[joint] >= 0).all())
        self.assertTrue((faces.joint[~joint] == -1).all())
        has_fixed = np.bincount(faces.block, faces.role == cleave.ROLES.index("fixed"), len(blocks)) > 0
        np.testing.assert_array_equal(has_fixed, blocks.fixed)

    def test_cells_are_what_pyvista_takes(self):
        cells = self.result._made.cell_arrays()
        self.assertAlmostEqual(cells["volume"].sum(), self.result.blocks.volume.sum(), delta=1e-9)
        self.assertEqual(len(cells["face_ends"]), len(cells["block"]))
        self.assertEqual(cells["face_ends"][-1], len(cells["face_stream"]))
        try:
            import pyvista  # noqa: F401
        except ImportError:
            return
        self.assertEqual(self.result.to_pyvista().n_cells, len(cells["block"]))


if __name__ == "__main__":
    unittest.main()
