#!/usr/bin/env python3
"""scripts/studies with a program that prints its arguments: runs what the page says, once for each program, goes on
with what was interrupted, and shows the lines of the page that were not printed.
"""

import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/studies.md").read_text(encoding="utf-8")


def quoted(command):
    """The lines behind a command of the page."""
    return re.search(rf"^\$ volcal {re.escape(command)}[^\n]*\n(.*?)^```", PAGE, re.M | re.S)[1]


class Studies(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.program, self.prints, self.calls = (self.folder / name for name in ("volcal", "prints", "calls"))
        self.calls.touch()
        self.write_program(0)

    def write_program(self, code, version=""):
        self.program.write_text(f'#!/bin/bash\n# {version}\necho "$*" >>{self.calls}\ncat {self.prints}\nexit {code}\n')
        self.program.chmod(0o755)

    def studies(self, *arguments):
        return subprocess.run([ROOT / "scripts/studies", "--program", self.program, "--output", self.folder / "out",
                               *arguments], capture_output=True, text=True, check=False)

    def called(self):
        return self.calls.read_text().splitlines()

    def test_runs_what_the_page_says_and_finds_its_lines(self):
        self.prints.write_text(quoted("study planning"))
        done = self.studies("planning")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(self.called()[0], r"^study planning -n \d+$")
        self.assertIn("0 lines are not those of the page", done.stdout)

    def test_a_line_that_is_not_printed_is_shown(self):
        lines = quoted("study planning").splitlines(keepends=True)
        self.prints.write_text("".join(lines[:-1]))
        done = self.studies("planning")
        self.assertEqual(done.returncode, 1)
        self.assertIn("page: " + lines[-1].rstrip(), done.stdout)

    def test_what_is_finished_is_run_again_by_another_program_alone(self):
        self.prints.write_text(quoted("study planning"))
        self.studies("planning")
        self.assertIn("finished before", self.studies("planning").stdout)
        self.assertEqual(len(self.called()), 1)
        self.write_program(0, "another")
        self.studies("planning")
        self.assertEqual(len(self.called()), 2)

    def test_an_interrupted_study_of_criticism_goes_on(self):
        self.prints.write_text("")
        self.write_program(1)
        done = self.studies("rows mdb")
        self.assertEqual(done.returncode, 1)
        self.assertIn("1 failed", done.stdout)
        kept = pathlib.Path(self.called()[0].split(" -o ")[1])
        kept.mkdir(parents=True)
        self.studies("rows mdb")
        self.assertTrue(self.called()[1].endswith(f"-o {kept} --resume"))

    def test_a_pattern_that_fits_nothing_is_refused(self):
        self.assertNotEqual(self.studies("no such study").returncode, 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
