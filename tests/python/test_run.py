"""cleave.run: scenes as files and dicts, what it gives, what it raises."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import cleave

root = Path(os.environ["CLEAVE_ROOT"])
WEDGE = root / "examples/wedge_slope/wedge_slope.toml"


def cube(**more):
    """A cube of 2 m, cut into eight by three planes through its middle."""
    joint = [{"through": [1, 1, 1], "dip": d, "dip_direction": a} for d, a in ((90, 90), (90, 0), (0, 0))]
    scene = {"title": "cube", "domain": {"box": {"min": [0, 0, 0], "max": [2, 2, 2]}},
             "joint": [{"plane": j, "set": "A"} for j in joint]}
    scene.update(more)
    return scene


class Blocks(unittest.TestCase):
    def test_eight_cubes_out_of_a_dict(self):
        result = cleave.run(cube())
        self.assertEqual(result.kind, "blocks")
        self.assertEqual(len(result.blocks), 8)
        np.testing.assert_allclose(result.blocks.volume, 1)
        self.assertEqual(result.summary["blocks"]["count"], 8)
        self.assertEqual(result.complaint, "")
        self.assertIsNone(result.key_blocks)

    def test_tables_in_another_encoding_are_wrong_scenes(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "joints.csv").write_bytes("dip (°),dip_direction,x,y,z\n60,30,1,1,1\n".encode("latin-1"))
            scene = cube(joint=[{"file": "joints.csv"}])
            problems = cleave.check(scene, folder=folder)
            self.assertIn("is not UTF-8 text", problems[0].what)
            self.assertEqual(problems[0].remedy, "save the table as UTF-8")
            with self.assertRaises(cleave.SceneError):
                cleave.run(scene, folder=folder)

    def test_the_same_as_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            subprocess.run([os.environ["CLEAVE_PROGRAM"], "run", WEDGE, "-o", out, "--quiet"], check=True)
            result = cleave.run(WEDGE, threads=2)
            theirs = json.loads((out / "summary.json").read_text())
            ours = result.summary
            for section in ("blocks", "key_blocks", "plan", "seed", "scene_sha256"):
                self.assertEqual(ours[section], theirs[section], section)
            result.write(Path(folder) / "again")
            for name in ("key_blocks.csv", "blocks.vtu"):
                self.assertEqual((out / name).read_bytes(), (Path(folder) / "again" / name).read_bytes(), name)

    def test_key_blocks_are_columns(self):
        table = cleave.run(WEDGE).key_blocks
        self.assertGreater(len(table), 0)
        self.assertEqual(table["volume_m3"].dtype, np.float64)
        self.assertEqual(table["block"].dtype, np.int64)
        row = next(table.rows())
        self.assertEqual(row["mode"], table["mode"][0])
        self.assertEqual(table.columns[:3], ["block", "batch", "key"])

    def test_seed_takes_the_place_of_the_scenes(self):
        drawn = {"domain": {"box": {"min": [0, 0, 0], "max": [10, 10, 10]}},
                 "joint_set": [{"name": "A", "orientation": {"dip": 30, "dip_direction": 30}, "size": "persistent",
                                "intensity": {"p32": 0.5}}]}
        hashes = {seed: cleave.run({"seed": 1, **drawn}, seed=seed).summary["blocks"]["hash"] for seed in (None, 1, 2)}
        self.assertEqual(hashes[None], hashes[1])
        self.assertNotEqual(hashes[1], hashes[2])


class Others(unittest.TestCase):
    def test_monte_carlo_gives_records(self):
        scene = {"seed": 3, "domain": {"box": {"min": [0, 0, 0], "max": [10, 10, 10]}},
                 "joint_set": [{"name": "A", "orientation": {"dip": 30, "dip_direction": 30}, "size": "persistent",
                                "intensity": {"p32": 0.3}}],
                 "monte_carlo": {"realizations": 12}}
        seen = []
        result = cleave.run(scene, threads=2, progress=lambda stage, share: seen.append((stage, share)))
        self.assertEqual(result.kind, "monte_carlo")
        self.assertEqual(result.summary["monte_carlo"]["realizations"], 12)
        self.assertEqual(len(result.records), 12)
        with self.assertRaises(AttributeError):
            result.blocks

    def test_elastic_and_contact(self):
        elastic = cleave.run(root / "examples/bem/free_fall.toml")
        self.assertEqual(elastic.kind, "elastic")
        self.assertEqual(elastic.summary["elastic"]["status"], "converged")
        contact = cleave.run(root / "examples/sliding_block/friction_10.toml")
        self.assertEqual(contact.kind, "contact")
        self.assertGreater(len(contact.bodies), 0)
        self.assertGreater(len(contact.history), 0)


class Wrong(unittest.TestCase):
    def test_problems_have_line_key_and_remedy(self):
        with self.assertRaises(cleave.SceneError) as raised:
            cleave.run(cube(domain={"box": {"min": [0, 0, 0], "max": [2, 2, -2]}}))
        problem = raised.exception.problems[0]
        self.assertGreater(problem.line, 1)
        self.assertIn("domain", problem.key)
        self.assertTrue(problem.what and problem.remedy)
        self.assertIn(problem.what, str(raised.exception))

    def test_check_lists_them_and_runs_nothing(self):
        self.assertEqual(cleave.check(cube()), [])
        wrong = cleave.check(cube(densty=2700))
        self.assertEqual(len(wrong), 1)
        self.assertIn("densty", wrong[0].key)

    def test_a_missing_file_is_pythons_own_error(self):
        with self.assertRaises(FileNotFoundError):
            cleave.run("no_such_scene.toml")

    def test_what_progress_raises_ends_the_run(self):
        class Enough(Exception):
            pass

        def stop(stage, share):
            raise Enough

        scene = cube(domain={"box": {"min": [0, 0, 0], "max": [40, 40, 40]}}, joint=[],
                     joint_set=[{"name": n, "orientation": {"dip": d, "dip_direction": d}, "size": "persistent",
                                 "intensity": {"count": 45}} for n, d in (("A", 10), ("B", 50), ("C", 80))])
        with self.assertRaises(Enough):
            cleave.run(scene, threads=1, progress=stop)

    def test_a_folder_that_cannot_be_made(self):
        with tempfile.NamedTemporaryFile() as file, self.assertRaises(cleave.MachineError):
            cleave.run(cube()).write(Path(file.name) / "out")


if __name__ == "__main__":
    unittest.main()
