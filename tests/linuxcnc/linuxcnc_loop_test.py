"""A running LinuxCNC applies the tables of an identified machine as volcal says, and wrong tables are seen.

Usage: linuxcnc_loop_test.py VOLCAL     (the program; exit 77 where there is no LinuxCNC)
"""

import concurrent.futures
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LOOP = ROOT / "scripts" / "linuxcnc-loop"
SKIPPED = 77
POINTS = 32  # from both sides
FEW = 4  # of tables that must be found wrong
AT_ONCE = 6  # LinuxCNCs: each moves its axes in real time and leaves the processors alone

# Reversals differ by axis in size and sign, so that no swap of axes or directions goes unseen.
STUDY = """format = "volcal-study-1"
machine = "machine.toml"
seed = 5
[truth]
kind = "random"
reversals_um = { EXX = 6.0, EYY = -4.0, EZZ = 5.0 }
reversals_urad = { ECX = 4.0, EBY = -3.0 }
[[measurements]]
kind = "laser-tracer"
grid = [4, 4, 4]
"""
REVERSALS = ("EXX", "EYY", "EZZ", "ECX", "EBY")


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)


def volcal(*words):
    done = run(PROGRAM, *words)
    if done.returncode != 0:
        raise RuntimeError(f"volcal {words[0]}: {done.stdout}{done.stderr}")


def identify(folder):
    """Folder of the result of a simulated machine with reversal."""
    (folder / "machine.toml").write_text((ROOT / "datasets" / "demo" / "machine.toml").read_text())
    (folder / "study.toml").write_text(STUDY)
    campaign = folder / "campaign"
    volcal("simulate", folder / "study.toml", "-o", campaign)
    effects = [word for symbol in REVERSALS for word in ("--effect", f"reversal:{symbol}")]
    volcal("extend", campaign / "model.toml", *effects, "-o", campaign / "reversal.toml")
    volcal("fit", campaign / "campaign.toml", "--model", campaign / "reversal.toml", "--noise", "white",
           "-o", folder / "result")
    return folder / "result"


def identify_five_axes(structure, folder):
    """Folder of the result of a simulated machine with rotary axes."""
    volcal("init", structure, "-o", folder / "start")
    volcal("simulate", folder / "start" / "study.toml", "-o", folder / "campaign")
    volcal("fit", folder / "campaign" / "campaign.toml", "--noise", "white", "-o", folder / "result")
    return folder / "result"


def loop(*words, result=None):
    return run(sys.executable, LOOP, "--volcal", PROGRAM, result or RESULT, *words)


def mapped(path, change):
    """Every row of numbers of a table changed."""
    rows = [line if line[0] in "#v" else " ".join(change(line.split())) for line in path.read_text().splitlines()]
    path.write_text("\n".join(rows) + "\n")


def turned_by_3_nanoradians(text):
    """The rows of what is added to C."""
    lines, rows = [], 0
    for line in text.splitlines():
        words = line.split()
        if rows:
            rows -= 1
            line = " ".join([words[0], *(f"{float(word) + 1.8e-7:.12f}" for word in words[1:])])
        elif words[:2] == ["own", "C"]:
            rows = int(words[2])
        lines.append(line)
    return "\n".join(lines) + "\n"


def negated(word):
    return word[1:] if word.startswith("-") else "-" + word


class Loop(unittest.TestCase):
    def assert_agrees(self, done, points, joints=3):
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("agrees within 1 nm", done.stdout)
        self.assertIn(f"{points} positions from both sides, {joints} joints", done.stdout)
        print(re.search("^LinuxCNC.*$", done.stdout, re.MULTILINE).group())

    def assert_disagrees(self, done):
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("DISAGREES", done.stdout)

    def damaged(self, form, *options, result=None):
        """A folder of tables, to be damaged."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=WORK)) / "tables"
        volcal("tables", result or RESULT, "--format", form, *options, "-o", folder)
        return folder


class AxisTables(Loop):
    def wrong(self, tables):
        return loop("--points", FEW, "--tables", tables, "--", "--step", 50)

    def test_are_applied_as_predicted(self):
        self.assert_agrees(loop("--points", POINTS), POINTS)

    def test_in_inches(self):
        self.assert_agrees(loop("--points", FEW, "--", "--set", "units=inch"), FEW)

    def test_given_as_files(self):
        self.assert_agrees(self.wrong(self.damaged("linuxcnc", "--step", 50)), FEW)

    def test_a_flipped_sign_is_seen(self):
        tables = self.damaged("linuxcnc", "--step", 50)
        mapped(tables / "z.comp", lambda row: [row[0], negated(row[1]), negated(row[2])])
        self.assert_disagrees(self.wrong(tables))

    def test_swapped_axes_are_seen(self):
        tables = self.damaged("linuxcnc", "--step", 50)
        x, y = (tables / "x.comp").read_text(), (tables / "y.comp").read_text()
        (tables / "x.comp").write_text(y)
        (tables / "y.comp").write_text(x)
        self.assert_disagrees(self.wrong(tables))

    def test_swapped_directions_are_seen(self):
        tables = self.damaged("linuxcnc", "--step", 50)
        mapped(tables / "y.comp", lambda row: [row[0], row[2], row[1]])
        self.assert_disagrees(self.wrong(tables))

    def test_a_row_off_by_two_nanometres_is_seen(self):
        tables = self.damaged("linuxcnc", "--step", 50)
        mapped(tables / "x.comp", lambda row: [row[0], *(f"{float(word) + 2e-6:.8f}" for word in row[1:])])
        self.assert_disagrees(self.wrong(tables))


class Volume(Loop):
    def wrong(self, tables):
        return loop("--volumetric", "--points", FEW, "--tables", tables, "--", "--step", 100)

    def test_is_applied_as_predicted(self):
        self.assert_agrees(loop("--volumetric", "--points", POINTS, "--", "--tool", "side_x"), POINTS)

    def test_in_inches(self):
        self.assert_agrees(loop("--volumetric", "--points", FEW, "--", "--step", 100, "--set", "units=inch"), FEW)

    def test_a_flipped_sign_is_seen(self):
        tables = self.damaged("linuxcnc-grid", "--step", 100)
        mapped(tables / "volcal.grid", lambda row: row[:4] + [negated(row[4])] + row[5:])
        self.assert_disagrees(self.wrong(tables))

    def test_swapped_axes_are_seen(self):
        tables = self.damaged("linuxcnc-grid", "--step", 100)
        mapped(tables / "volcal.grid", lambda row: row[:3] + [row[4], row[3]] + row[5:])
        self.assert_disagrees(self.wrong(tables))

    def test_swapped_directions_are_seen(self):
        tables = self.damaged("linuxcnc-grid", "--step", 100)
        mapped(tables / "volcal.grid", lambda row: row[:6] + [negated(word) for word in row[6:9]] + row[9:])
        self.assert_disagrees(self.wrong(tables))

    def test_a_damaged_grid_is_not_loaded(self):
        for what, change in {"15 numbers": lambda row: row[:-1],
                             "not a complete grid": lambda row: [row[0], row[1], row[2] + "1", *row[3:]]}.items():
            tables = self.damaged("linuxcnc-grid", "--step", 100)
            text = (tables / "volcal.grid").read_text().splitlines()
            text[-2] = " ".join(change(text[-2].split()))
            (tables / "volcal.grid").write_text("\n".join(text) + "\n")
            done = self.wrong(tables)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn(f"volcal.grid:{len(text) - 1}: ", done.stderr)
            self.assertIn(what, done.stderr)


class RotaryAxes(Loop):
    """A table on a cradle, X Y Z A C, and a head on a moving table, X Y Z B C."""

    OPTIONS = ("--step", 100, "--rotary-step", 15)

    def setUp(self):
        with IDENTIFYING:
            for name, structure in {"table": "w C' A' b X Y Z t", "head": "w X' b Y Z C B t"}.items():
                if name not in FIVE_AXES:
                    folder = pathlib.Path(tempfile.mkdtemp(dir=WORK))
                    FIVE_AXES[name] = identify_five_axes(structure, folder)

    def five(self, name, points, *options):
        return loop("--volumetric", "--points", points, "--", *self.OPTIONS, *options, result=FIVE_AXES[name])

    def wrong(self, name, change):
        tables = self.damaged("linuxcnc-grid", *self.OPTIONS, result=FIVE_AXES[name])
        text = (tables / "volcal.rotary").read_text()
        changed = change(text)
        self.assertNotEqual(text, changed)
        (tables / "volcal.rotary").write_text(changed)
        return loop("--volumetric", "--points", FEW, "--tables", tables, "--", *self.OPTIONS,
                    result=FIVE_AXES[name])

    def test_of_a_table_are_applied_as_predicted(self):
        self.assert_agrees(self.five("table", POINTS), POINTS, 5)

    def test_of_a_head_are_applied_as_predicted(self):
        self.assert_agrees(self.five("head", POINTS), POINTS, 5)

    def test_in_inches(self):
        self.assert_agrees(self.five("head", FEW, "--set", "units=inch"), FEW, 5)

    def test_a_part_of_the_types(self):
        self.assert_agrees(self.five("table", FEW, "--type", "L-VOL+R-POR"), FEW, 5)

    def test_mistakes_are_seen(self):
        for name, what in {"table": lambda text: text.replace("tool 0.000000 0.000000 -", "tool 0.000000 0.000000 "),
                           "head": lambda text: re.sub(r"^(centre B) \S+", r"\1 90.0", text, flags=re.MULTILINE)
                           }.items():
            self.assert_disagrees(self.wrong(name, what))
        self.assert_disagrees(self.wrong("table", turned_by_3_nanoradians))

    def test_damaged_files_are_not_loaded(self):
        for what, change in {"no axis": lambda text: text.replace("chain C'", "chain Q'"),
                             "between linear axes": lambda text: text.replace("b X Y Z", "b X Y C Z"),
                             "do not make a turn": lambda text: re.sub("^own A (.*) 0$", r"own A \1 1", text,
                                                                       flags=re.MULTILINE),
                             "the other body": lambda text: text.replace("twists table", "twists tool"),
                             "3 numbers": lambda text: re.sub(r"^(own A .*\n\S+ \S+) \S+$", r"\1", text,
                                                              flags=re.MULTILINE)}.items():
            done = self.wrong("table", change)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn(what, done.stderr)


class SideBySide(unittest.TestSuite):
    def run(self, result, debug=False):
        def alone(test):
            own = unittest.TestResult()
            test.run(own)
            return own

        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            for own in pool.map(alone, self):
                result.testsRun += own.testsRun
                result.failures += own.failures
                result.errors += own.errors
        return result


def load_tests(loader, _tests, _pattern):
    cases = (AxisTables, Volume, RotaryAxes)
    return SideBySide(test for case in cases for test in loader.loadTestsFromTestCase(case))


if __name__ == "__main__":
    FIVE_AXES = {}
    IDENTIFYING = threading.Lock()
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
    AVAILABLE = run(sys.executable, LOOP, "--check")
    if AVAILABLE.returncode != 0:
        print(AVAILABLE.stdout + AVAILABLE.stderr)
        sys.exit(AVAILABLE.returncode)
    with tempfile.TemporaryDirectory() as WORK:
        RESULT = identify(pathlib.Path(WORK))
        unittest.main()
