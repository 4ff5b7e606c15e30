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


if __name__ == "__main__":
    unittest.main()
