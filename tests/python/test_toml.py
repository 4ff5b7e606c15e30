"""cleave.dumps: what is written is read back as the same."""
import random
import tomllib
import unittest
from pathlib import Path

import numpy as np

import cleave


class Dumps(unittest.TestCase):
    def test_values(self):
        scene = {"title": 'a "b"\n\\ é \x7f \x01', "seed": 7, "x": 0.1, "big": 1e300, "yes": True, "path": Path("a/b.csv"),
                 "array": np.array([[1.5, 2], [3, 4]]), "number": np.float64(2.5), "one": np.int64(3), "empty": [],
                 "none": None, "tuple": (1, 2), "table": {"a b": 1, "inner": {"deep": [{"x": 1}, {"x": 2}]}},
                 "tables": [{"name": "A"}, {"name": "B", "none": None}]}
        read = tomllib.loads(cleave.dumps(scene))
        self.assertEqual(read["title"], scene["title"])
        self.assertEqual(read["array"], [[1.5, 2], [3, 4]])
        self.assertEqual(read["path"], "a/b.csv")
        self.assertNotIn("none", read)
        self.assertEqual(read["tables"], [{"name": "A"}, {"name": "B"}])
        self.assertEqual(read["table"], scene["table"])
        self.assertEqual((read["number"], read["one"], read["tuple"]), (2.5, 3, [1, 2]))

    def test_random_scenes_come_back(self):
        draw = random.Random(5)

        def value(depth):
            kind = draw.randrange(6 if depth else 4)
            if kind == 0:
                return draw.uniform(-1e9, 1e9)
            if kind == 1:
                return draw.randrange(-10**12, 10**12)
            if kind == 2:
                return "".join(chr(draw.choice([*range(1, 256), 0x20AC])) for _ in range(draw.randrange(6)))
            if kind == 3:
                return draw.random() < 0.5
            if kind == 4:
                return [value(depth - 1) for _ in range(draw.randrange(4))]
            return {f"k{i} ": value(depth - 1) for i in range(draw.randrange(4))}

        for _ in range(500):
            scene = {f"key{i}": value(3) for i in range(draw.randrange(6))}
            self.assertEqual(tomllib.loads(cleave.dumps(scene)), scene)

    def test_what_a_scene_cannot_hold(self):
        with self.assertRaisesRegex(TypeError, r"domain\.box"):
            cleave.dumps({"domain": {"box": object()}})
        with self.assertRaises(TypeError):
            cleave.dumps({1: 2})


if __name__ == "__main__":
    unittest.main()
