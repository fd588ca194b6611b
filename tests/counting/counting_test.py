#!/usr/bin/env python3
"""One ctest entry for each suite, and scripts/count-tests: every case is counted, one that crashes is named.

Usage: counting_test.py COUNTED_TESTS CMAKE CTEST
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

COUNTED, CMAKE, CTEST = sys.argv[1:4]
ROOT = pathlib.Path(__file__).resolve().parents[2]


def run(*command, **more):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **more)


class Counting(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.results = self.folder / "tests.xml"

    def list_suites(self, long="counted Numbers/Sharded 50 2"):
        return run(CMAKE, "-D", f"PROGRAM={COUNTED}", "-D", "FOLDER=counted", "-D", f"LONG={long}",
                   "-D", f"RESULTS={self.folder}/suites", "-D", f"OUTPUT={self.folder}/CTestTestfile.cmake",
                   "-P", ROOT / "tests/list_suites.cmake")

    def count(self, *selection):
        listed = self.list_suites()
        self.assertEqual(listed.returncode, 0, listed.stderr)
        ctest = run(CTEST, "--test-dir", self.folder, "--output-junit", self.results, *selection)
        return ctest.stdout, run(ROOT / "scripts/count-tests", self.results)

    def test_one_entry_for_each_suite_and_shard(self):
        self.list_suites()
        listed = run(CTEST, "--test-dir", self.folder, "-N").stdout
        names = [line.split(": ")[1] for line in listed.splitlines() if " Test " in line]
        self.assertEqual(names, ["counted.Passes", "counted.Fails", "counted.Crashes", "counted.EndsEarly",
                                 "counted.OfType/0", "counted.OfType/1", "counted.Numbers/Sharded.1of2",
                                 "counted.Numbers/Sharded.2of2"])

    def test_a_long_suite_that_is_not_there_is_an_error(self):
        self.assertNotEqual(self.list_suites("counted Nowhere 50 2").returncode, 0)

    def test_passed_cases_are_counted_and_not_suites(self):
        _, counted = self.count("-R", "Passes|Sharded|OfType")
        self.assertEqual(counted.stdout.splitlines()[-1], "9 passed, 0 failed")
        self.assertEqual(counted.returncode, 0)

    def test_a_failed_case_is_named_and_its_neighbours_count(self):
        _, counted = self.count("-R", "Fails")
        self.assertEqual(counted.stdout.splitlines(), ["failed: counted.Fails: Fails.Fails",
                                                       "1 passed, 1 failed, 1 skipped"])
        self.assertEqual(counted.returncode, 1)

    def test_the_case_that_crashed_is_named(self):
        _, counted = self.count("-R", "Crashes")
        self.assertEqual(counted.stdout.splitlines(), [
            "failed: counted.Crashes: Crashes.Fails",
            "failed: counted.Crashes: ended within Crashes.Here; the cases behind it did not run",
            "1 passed, 2 failed"])
        self.assertEqual(counted.returncode, 1)

    def test_a_program_that_ends_early_has_failed_though_it_says_nothing(self):
        ctest, counted = self.count("-R", "EndsEarly")
        self.assertIn("100% tests passed", ctest)
        self.assertIn("ended within EndsEarly.WithSuccess", counted.stdout)
        self.assertEqual(counted.returncode, 1)

    def test_a_missing_program_has_failed(self):
        (self.folder / "CTestTestfile.cmake").write_text('add_test(nowhere "/nowhere/tests")\n')
        run(CTEST, "--test-dir", self.folder, "--output-junit", self.results)
        counted = run(ROOT / "scripts/count-tests", self.results)
        self.assertEqual(counted.stdout.splitlines()[-1], "0 passed, 1 failed")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
