"""The Python of docs/python.md runs as it stands there, and prints what the page says."""
import contextlib
import io
import os
import re
import tempfile
import unittest
from pathlib import Path

root = Path(os.environ["CLEAVE_ROOT"])


class Page(unittest.TestCase):
    def test_code_of_the_page(self):
        text = (root / "docs/python.md").read_text()
        parts = re.findall(r"```python\n(.*?)```\n(?:prints\n\n```\n(.*?)```)?", text, re.S)
        self.assertGreaterEqual(len(parts), 4)
        self.assertGreaterEqual(sum(bool(printed) for _, printed in parts), 2)
        names, here = {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                os.symlink(root / "examples", "examples")
                for code, printed in parts:
                    out = io.StringIO()
                    with contextlib.redirect_stdout(out):
                        exec(compile(code, "docs/python.md", "exec"), names)
                    if printed:
                        self.assertEqual(out.getvalue().strip(), printed.strip())
            finally:
                os.chdir(here)


if __name__ == "__main__":
    unittest.main()
