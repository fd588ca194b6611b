#!/usr/bin/env python3
"""An effect, an instrument, one that can be planned for, a basis, a table format and a command are one file and one line
each.

  plugins_test.py BUILD       (BUILD: a build folder with the program and the tests built, Ninja)

Adds those of samples/ to a copy of the sources and counts what it touched. Then the registries and the samples are
compiled and linked before the libraries of the build, so that the tests over everything registered and the program know
them, and these must pass. With samples that are wrong (VOLCAL_WRONG_SAMPLE) the same tests must fail: they were found
without an edit of a test.
"""
import concurrent.futures
import filecmp
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BUILD = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else ROOT / "build/release"

# sample -> (its file, the registry, the list in it, the line)
PLUGINS = {
    "effect": ("model/effects/kinds/drive/sample.cpp", "model/effects/registry.cpp", "EFFECT", "sample_effect"),
    "instrument": ("model/instruments/sample.cpp", "model/instruments/registry.cpp", "INSTRUMENT", "sample_instrument"),
    "planned": ("identify/planning/instruments/sample.cpp", "identify/planning/registry.cpp", "INSTRUMENT",
                "planned_sample"),
    "basis": ("model/functions/sample.cpp", "model/functions/registry.cpp", "BASIS", "kSampleBasis"),
    "format": ("identify/compensation/formats/sample.cpp", "identify/compensation/table_formats.cpp", "FORMAT",
               "sample_format"),
    "command": ("identify/cli/commands/sample_command.cpp", "identify/cli/commands.cpp", "COMMAND", "sample_command"),
}
# What finds a plug-in: program of tests, suites, and the sample that a wrong one of breaks it.
CONTRACTS = [("model_tests", "EffectContract.*", "effect"), ("model_tests", "*InstrumentContract*", "instrument"),
             ("model_tests", "*BasisContract*", "basis"), ("identify_tests", "*TableFormatContract*sample*", "format"),
             ("identify_tests", "PlanInstruments.*", "planned")]
# The other suites that go through a registry: they must pass as they stand.
LOOPS = {
    "model_tests": ["DriverCheck.*", "EffectMeanings.*", "*EffectAgainstJet*", "EffectName.*", "InstrumentTraits.*",
                    "ScaleExpansions.*"],
    "identify_tests": ["*TablesInTheLoop*sample*", "Alignment.*", "DrawGradients.*", "DriverPolynomials.*", "EffectWords.*",
                       "ErrorField.*", "KnownTruth.*", "TableReaders.*"],
    "io_tests": ["*MistakenFiles*sample*", "ControlTables.*", "EffectBadInput.*", "Mutation.*", "StudyOfAPlan.*"],
}
REGISTRIES = re.compile(r"\b(effect_kinds|instruments|plan_instruments|basis_kinds|table_formats)\(\)")
SOURCES = ("model", "identify", "include")


def copy_tree(target):
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", *SOURCES], capture_output=True, text=True)
    names = listed.stdout.split("\n")[:-1] if listed.returncode == 0 else []
    if not names:  # not a checkout
        names = [str(path.relative_to(ROOT)) for top in SOURCES for path in (ROOT / top).rglob("*")
                 if path.suffix in (".h", ".cpp") or path.is_symlink()]
    for name in names:
        source = ROOT / name
        if source.suffix in (".h", ".cpp") or source.is_symlink():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target / name, follow_symlinks=False)


def register(root, plugin):
    file, registry, macro, line = PLUGINS[plugin]
    shutil.copy(HERE / "samples" / f"{plugin}.cpp", root / file)
    text = (root / registry).read_text(encoding="utf-8")
    # below the first, which may be the one that a user who says nothing has
    changed, count = re.subn(rf"(#define VOLCAL_\w+\({macro}\) *\\\n.*\\\n)", rf"\1  {macro}({line}) \\\n", text)
    assert count == 1, f"{registry} has no list of {macro}"
    (root / registry).write_text(changed, encoding="utf-8")


def touched(root):
    """Files that are new, and changed ones with the number of lines that they have more."""
    new, changed = [], {}
    for path in sorted(root.rglob("*.cpp")) + sorted(root.rglob("*.h")):
        name = path.relative_to(root)
        if name.parts[0] == "include":
            continue
        if not (ROOT / name).exists():
            new.append(str(name))
        elif not filecmp.cmp(path, ROOT / name, shallow=False):
            lines = [each.read_text(encoding="utf-8").count("\n") for each in (path, ROOT / name)]
            changed[str(name)] = lines[0] - lines[1]
    return new, changed


def flags_of(target):
    """Compiler and flags of a source of `target`, without its precompiled header."""
    for entry in json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8")):
        words = shlex.split(entry["command"])
        special = "cmake_pch" in entry["file"] or any("avx" in word for word in words)
        if special or f"/{target}.dir/" not in entry["command"]:
            continue
        start = next(i for i, word in enumerate(words) if re.search(r"(c\+\+|g\+\+)[-\d.]*$", word))
        kept, skip = [], 0
        for word in words[start:]:
            if skip:
                skip -= 1
            elif word in ("-o", "-c", "-MT", "-MF", "-include"):
                skip = 1
            elif word not in ("-MD", "-Winvalid-pch", "-fpch-preprocess") and not re.match(r"-O\d", word):
                kept.append(word)
        return kept
    raise AssertionError(f"compile_commands.json has no source of {target}")


def failures_in(text):
    """What gtest says of each failure, without the tests that passed."""
    return "\n".join(line for line in text.splitlines() if not re.match(r"\[ +(OK|RUN|-+) |\[-+\]", line))[-6000:]


def link_command(program):
    done = subprocess.run(["ninja", "-C", str(BUILD), "-t", "commands", program], capture_output=True, text=True, check=True)
    link = done.stdout.strip().splitlines()[-1]
    return shlex.split(re.search(r": && (.* -o \S+ .*?) && ", link).group(1))


class Plugins(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.tree = pathlib.Path(cls.folder.name) / "tree"
        copy_tree(cls.tree)
        for plugin in PLUGINS:
            register(cls.tree, plugin)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            jobs = [(source, wrong) for file, registry, _, _ in PLUGINS.values()
                    for source, wrong in ((file, False), (file, True), (registry, False))
                    if not (wrong and source == PLUGINS["command"][0])]
            list(pool.map(lambda job: cls.compile(*job), jobs))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def object_of(cls, source, wrong):
        return pathlib.Path(cls.folder.name) / (source.replace("/", "-") + ("-wrong.o" if wrong else ".o"))

    @classmethod
    def compile(cls, source, wrong):
        layers = {"model": "volcal_model", "identify/cli": "volcal_cli", "identify/planning": "volcal_planning"}
        target = next((each for top, each in layers.items() if source.startswith(top + "/")), "volcal_compensation")
        words = [word.replace(f"-I{ROOT}/include", f"-I{cls.tree}/include") for word in flags_of(target)]
        wrongly = ["-DVOLCAL_WRONG_SAMPLE"] if wrong else []
        subprocess.run([*words, "-O1", *wrongly, "-c", str(cls.tree / source), "-o", str(cls.object_of(source, wrong))],
                       check=True)

    def linked(self, program, wrong=None):
        """The program of the build with the samples and their registries before the libraries."""
        plugins = [name for name in PLUGINS if program == "volcal" or name != "command"]
        objects = [str(self.object_of(PLUGINS[name][0], name == wrong)) for name in plugins]
        objects += [str(self.object_of(PLUGINS[name][1], False)) for name in plugins]
        words = link_command(program)
        out = words.index("-o")
        words[out + 1] = f"{self.folder.name}/{program}-{wrong}"
        subprocess.run([words[0], "-Wl,--allow-multiple-definition", *objects, *words[1:]], cwd=BUILD, check=True)
        return words[out + 1]

    def test_one_file_and_one_line_each(self):
        new, changed = touched(self.tree)
        self.assertEqual(sorted(new), sorted(file for file, _, _, _ in PLUGINS.values()))
        self.assertEqual(changed, {registry: 1 for _, registry, _, _ in PLUGINS.values()})

    def run_contract(self, program, suites):
        return subprocess.run([program, f"--gtest_filter={suites}"], capture_output=True, text=True, cwd=self.folder.name)

    def test_every_suite_over_a_registry_is_listed(self):
        filters = [suites for _, suites, _ in CONTRACTS] + [each for suites in LOOPS.values() for each in suites]
        listed = {re.search(r"[A-Za-z]+", each).group() for each in filters}
        for path in sorted((ROOT / "tests").rglob("*_test.cpp")):
            text = path.read_text(encoding="utf-8")
            if REGISTRIES.search(text):
                suites = set(re.findall(r"^TEST(?:_[FP])?\((\w+),", text, re.MULTILINE))
                self.assertTrue(suites & listed, f"{path} goes through a registry: add its suite to LOOPS")

    def test_the_tests_over_everything_registered_pass(self):
        for program, loops in sorted(LOOPS.items()):
            own = [(suites, plugin) for other, suites, plugin in CONTRACTS if other == program]
            right = self.linked(program)
            done = self.run_contract(right, ":".join([*(suites for suites, _ in own), *loops]))
            self.assertEqual(done.returncode, 0, failures_in(done.stdout))
            self.assertNotIn("0 tests from 0", done.stdout)
            for suites, plugin in own:
                done = self.run_contract(self.linked(program, plugin), suites)
                self.assertEqual(done.returncode, 1, f"a wrong {plugin} is not found by {suites}")

    def test_the_program_knows_them(self):
        program = self.linked("volcal")

        def said(*arguments):
            done = subprocess.run([program, *arguments], capture_output=True, text=True)
            return done.stdout + done.stderr

        self.assertEqual(said("sample"), "a sample\n")
        self.assertIn("sample ", said("--help"))
        self.assertIn("sample ", said("diagnose", "--list"))
        self.assertIn("sample", said("tables", "--help"))
        model = pathlib.Path(self.folder.name) / "model.toml"
        demo = ROOT / "datasets/demo/campaign"
        model.write_text(f'format = "volcal-model-1"\nmachine = "{demo}/machine.toml"\n'
                         '[functions]\ndefault = { basis = "sample-cosines", degree = 5 }\n'
                         '[[effects]]\nkind = "sample"\nsymbol = "EXX"\n', encoding="utf-8")
        fitted = said("fit", str(demo / "campaign.toml"), "--model", str(model), "-o", f"{self.folder.name}/result",
                      "--noise", "white")
        self.assertIn("written: ", fitted)
        self.assertIn("sample EXX", (pathlib.Path(self.folder.name) / "result/result.json").read_text(encoding="utf-8"))
        campaign = pathlib.Path(self.folder.name) / "campaign.toml"
        (pathlib.Path(self.folder.name) / "readings.csv").write_text("x_mm,y_mm,z_mm,gauge_um\n0,0,0,1\n10,0,0,10002\n20,0,0,19999\n",
                                                                    encoding="utf-8")
        campaign.write_text(f'format = "volcal-campaign-1"\nmachine = "{demo}/machine.toml"\n[[setups]]\nname = "G"\n'
                            'instrument = "sample-gauge"\ntool = "short"\ndata = "readings.csv"\n'
                            'noise = { constant_um = 1 }\n', encoding="utf-8")
        compared = said("compare", str(campaign), "nominal")
        self.assertIn("sample-gauge", compared)
        self.assertIn("sample-bar", said("plan", "--help"))
        planned = pathlib.Path(self.folder.name) / "plan"
        said("plan", str(demo / "machine.toml"), "--instrument", "sample-bar", "--bar-mm", "100", "--stations", "2",
             "--readings", "48", "--seed", "1", "-o", str(planned))
        # a circle of 12 positions, there and back, is taken whole
        written = sorted(planned.glob("**/*.csv"))
        rows = sum(len(each.read_text(encoding="utf-8").splitlines()) - 1 for each in written if "_XY" in each.name)
        self.assertEqual((rows > 0, rows % 24), (True, 0), [str(each) for each in written])


if __name__ == "__main__":
    unittest.main()
