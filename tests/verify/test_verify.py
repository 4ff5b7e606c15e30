"""The manual notices what is wrong: values, words, missing ones."""
import unittest

import verify


class Judged(unittest.TestCase):
    def test_numbers_are_relative_and_zero_is_absolute(self):
        self.assertTrue(verify.judged(("q", 100.0, 100.0 + 1e-8, 1e-9))[1])
        self.assertFalse(verify.judged(("q", 100.0, 100.0 + 1e-6, 1e-9))[1])
        self.assertTrue(verify.judged(("q", 0.0, 1e-10, 1e-9))[1])
        self.assertFalse(verify.judged(("q", 0.0, -1e-8, 1e-9))[1])

    def test_counts_words_and_truth_are_equal_or_not(self):
        self.assertTrue(verify.judged(("q", 8, 8, 0))[1])
        self.assertFalse(verify.judged(("q", 8, 9, 0))[1])
        self.assertFalse(verify.judged(("q", "wedge", "sliding", 0))[1])
        self.assertFalse(verify.judged(("q", True, False, 0))[1])

    def test_what_is_missing_or_no_number_is_not_ok(self):
        self.assertFalse(verify.judged(("q", 1.0, None, 1))[1])
        self.assertFalse(verify.judged(("q", 1.0, float("nan"), 1))[1])
        self.assertFalse(verify.judged(("q", 0.0, float("inf"), 1))[1])


class Chapters(unittest.TestCase):
    def test_every_section_has_a_case_and_every_example_is_there(self):
        cases = [c for m in (verify.cases_elastic, verify.cases_contact) for c in m.cases() if c.section]
        self.assertEqual({c.section for c in cases}, set(verify.SECTIONS))
        named = {c.scene for c in cases if isinstance(c.scene, verify.Path)}
        for scene in named:
            self.assertTrue(scene.exists(), scene)
        for folder in ("arch", "sliding_block", "toppling_columns", "tunnel_roof", "goodman_bray"):
            for scene in (verify.ROOT / "examples" / folder).glob("*.toml"):
                self.assertIn(scene, named)

    def test_the_table_tells_what_is_not_ok(self):
        case = verify.cases_contact.Case("c", "t", "", "", None, None, "7.5.2")
        text = verify.table_of_chapters([(case, "c", ("way (m)", 1.0, 2.0, 0.1), 1.0, False), (case, "c", ("stands", True, True, 0), "", True)])
        self.assertIn("| 7.5.2 Block on an incline | c | way (m) | 1 | 2 | 1.0e+00 (not ok) |", text)
        self.assertIn("| stands | yes | yes |  |", text)


if __name__ == "__main__":
    unittest.main()
