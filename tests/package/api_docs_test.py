#!/usr/bin/env python3
"""The documentation of the public headers is made without a warning, and a header with a wrong text is refused."""
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
WRONG = """#pragma once
/// What it returns.
/// \\param none that there is
int of_one(int value);
"""


def run_in(folder, *more):
    return subprocess.run([str(ROOT / "scripts/api-docs"), "-o", f"{folder}/docs", *more], capture_output=True, text=True)


class ApiDocs(unittest.TestCase):
    def test_public_headers(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run_in(folder)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            page = (pathlib.Path(folder) / "docs/html/structvolcal_1_1FitResult.html").read_text(encoding="utf-8")
            self.assertIn("&lt;volcal/identify/result/result.h&gt;", page)
            self.assertIn("singular by the datum", page)

    def test_a_wrong_text_is_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            header = pathlib.Path(folder) / "wrong.h"
            header.write_text(WRONG, encoding="utf-8")
            done = run_in(folder, str(header))
            self.assertEqual(done.returncode, 1)
            self.assertIn("argument 'none'", done.stderr)


if __name__ == "__main__":
    unittest.main()
