#!/usr/bin/env python3
"""volcal montecarlo under mpirun: two ranks give the files of one process, and a study whose rank was killed
goes on to the same files.

Usage: ranks_test.py VOLCAL CAMPAIGN.toml (a program built with VOLCAL_MPI). Exit 77 where mpirun is missing.
"""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, CAMPAIGN = sys.argv[1:3]
DRAWS = ["-n", "60000", "--path", "linear", "--refits", "1", "--threads", "1", "--checkpoint-every", "0"]
MODEL = 'format = "volcal-model-1"\n[functions]\ndefault = { basis = "legendre", degree = 2 }\n'  # a quick fit
ENVIRONMENT = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def command(ranks, output, *more):
    model = str(pathlib.Path(output).parent / "model.toml")
    alone = [PROGRAM, "montecarlo", CAMPAIGN, "-m", model, *DRAWS, "-o", output, *more]
    return alone if ranks == 1 else ["mpirun", "--oversubscribe", "-n", str(ranks), *alone]


def run(ranks, output, *more):
    return subprocess.run(command(ranks, output, *more), env=ENVIRONMENT, capture_output=True, text=True, check=False)


def files_of(folder):
    """The report states the command, which names the folder."""
    command = re.compile(rb" -o \S*" + pathlib.Path(folder).name.encode() + rb"( --resume)?")
    return {file.name: command.sub(b"", file.read_bytes()) for file in pathlib.Path(folder).iterdir()
            if not file.name.startswith(".")}


def kill_last_rank(pid):
    children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()
    os.kill(int(children[-1]), signal.SIGKILL)


class Ranks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        pathlib.Path(cls.path("model.toml")).write_text(MODEL, encoding="utf-8")
        cls.alone = cls.path("alone")
        done = run(1, cls.alone)
        if done.returncode != 0:
            raise AssertionError(done.stderr)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def assert_same_files(self, one, other):
        """By name: unittest would compare two reports letter by letter, for minutes."""
        one, other = files_of(one), files_of(other)
        self.assertEqual(sorted(one), sorted(other))
        self.assertEqual([name for name in one if one[name] != other[name]], [])

    @classmethod
    def path(cls, name):
        return str(pathlib.Path(cls.scratch.name) / name)

    def test_two_ranks_give_the_files_of_one_and_report_once(self):
        done = run(2, self.path("two"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_same_files(self.path("two"), self.alone)
        self.assertEqual(done.stdout.count("Monte Carlo, 60,000 draws"), 1)

    def test_a_lost_rank_is_reported_and_the_study_resumed(self):
        output = self.path("lost")
        checkpoint = pathlib.Path(output + ".checkpoint")
        with subprocess.Popen(command(2, output), env=ENVIRONMENT, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True) as ranks:
            while ranks.poll() is None and not checkpoint.exists():
                time.sleep(0.002)
            kill_last_rank(ranks.pid)
            words, _ = ranks.communicate(timeout=120)
        self.assertNotEqual(ranks.returncode, 0)
        self.assertIn("signal 9 (Killed)", words)
        self.assertFalse(pathlib.Path(output).exists())
        done = run(2, output, "--resume")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_same_files(output, self.alone)


if __name__ == "__main__":
    if shutil.which("mpirun") is None:
        print("skipped: mpirun not found; install openmpi-bin")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
