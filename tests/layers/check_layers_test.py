"""check-layers must accept the real tree and reject each kind of wrong include."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "check-layers"


def check(root):
    return subprocess.run([sys.executable, SCRIPT, root], capture_output=True, text=True, check=False)


class RealTree(unittest.TestCase):
    def test_passes(self):
        done = check(ROOT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class MadeUpTree(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "docs").mkdir()
        shutil.copy(ROOT / "docs" / "layers.md", self.root / "docs")

    def write(self, path, *lines):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def assert_accepted(self, path, *lines):
        self.write(path, *lines)
        done = check(self.root)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def assert_rejected(self, path, line, *words):
        self.write(path, "#pragma once", line)
        done = check(self.root)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        first = done.stdout.splitlines()[0]
        self.assertTrue(first.startswith(f"{path}:2: "), first)
        for word in words:
            self.assertIn(word, first)

    def test_downward_arrows_are_accepted(self):
        self.assert_accepted("model/observation/a.h", '#include "volcal/model/description/machine.h"',
                             '#include "volcal/model/functions/basis.h"', "#include <ceres/jet.h>")
        self.assert_accepted("identify/solve/a.cpp", '#include "volcal/model/kinematics/chain.h"',
                             "#include <ceres/ceres.h>")
        self.assert_accepted("identify/io/a.cpp", '#include "volcal/identify/text/csv_table.h"', "#include <fstream>")
        self.assert_accepted("studies/a.cpp", '#include "volcal/sim/study.h"')
        self.assert_accepted("identify/cli/a.cpp", '#include "volcal/sim/truth.h"', "#include <CLI/CLI.hpp>")
        self.assert_accepted("tests/model/a_test.cpp", '#include "volcal/identify/solve/fit.h"', '#include "near.h"')

    def test_physics_in_plain_data(self):
        self.assert_rejected("model/description/a.h", '#include "volcal/model/kinematics/chain.h"',
                             "description may not include model")

    def test_solver_in_physics(self):
        self.assert_rejected("model/effects/a.h", '#include "volcal/identify/solve/fit.h"',
                             "model may not include solve")
        self.assert_rejected("model/effects/a.h", "#include <ceres/ceres.h>", "<ceres/ceres.h>")

    def test_spaces_do_not_hide_an_include(self):
        self.assert_rejected("model/effects/a.h", '  #  include  "volcal/sim/truth.h"', "may not include sim")

    def test_physics_in_sim(self):
        self.assert_rejected("sim/a.cpp", '#include "volcal/model/kinematics/chain.h"', "sim may not include model")
        self.assert_rejected("sim/a.cpp", '#include "volcal/identify/text/text_file.h"', "sim may not include text")
        self.assert_rejected("sim/a.cpp", "#include <ceres/jet.h>", "<ceres/jet.h>")

    def test_noise_below_result_below_solve_below_criticism(self):
        self.assert_accepted("identify/criticism/a.h", '#include "volcal/identify/solve/fit.h"',
                             '#include "volcal/identify/noise/noise_model.h"')
        self.assert_accepted("identify/standards/a.h", '#include "volcal/identify/result/result.h"')
        self.assert_rejected("identify/standards/b.h", '#include "volcal/identify/criticism/diagnosis.h"',
                             "standards may not include criticism")
        self.assert_rejected("identify/result/b.h", '#include "volcal/identify/solve/fit.h"',
                             "result may not include solve")

    def test_criticism_in_solve(self):
        self.assert_rejected("identify/solve/a.h", '#include "volcal/identify/criticism/diagnosis.h"',
                             "solve may not include criticism")

    def test_results_in_noise(self):
        self.assert_accepted("identify/noise/a.h", '#include "volcal/identify/statistics/normal.h"')
        self.assert_rejected("identify/noise/a.h", '#include "volcal/identify/result/result.h"',
                             "noise may not include result")

    def test_noise_in_dense_matrices(self):
        self.assert_rejected("identify/numeric/a.h", '#include "volcal/identify/noise/noise_model.h"',
                             "numeric may not include noise")

    def test_rooms(self):
        self.assert_accepted("identify/criticism/search/a.h", '#include "volcal/identify/criticism/scans/b.h"',
                             '#include "volcal/identify/criticism/search/b.h"')
        self.assert_accepted("identify/criticism/a.h", '#include "volcal/identify/criticism/search/b.h"')
        self.assert_rejected("identify/criticism/scans/a.h", '#include "volcal/identify/criticism/search/b.h"',
                             "identify/criticism/scans may not include identify/criticism/search")
        self.assert_rejected("identify/criticism/data/a.h", '#include "volcal/identify/criticism/a.h"',
                             "criticism-data may not include criticism")

    def test_a_circle_of_rooms(self):
        page = self.root / "docs" / "layers.md"
        text = page.read_text(encoding="utf-8")
        page.write_text(text.replace("| data projection |", "| data projection search |", 1), encoding="utf-8")
        done = check(self.root)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("identify/criticism/catalogue", done.stderr)

    def test_a_diagnosis_in_the_report(self):
        self.assert_accepted("identify/report/a.h", '#include "volcal/identify/criticism/data/diagnosis_data.h"')
        self.assert_rejected("identify/report/b.h", '#include "volcal/identify/criticism/diagnosis.h"',
                             "report may not include criticism")

    def test_errors_in_criticism(self):
        self.assert_rejected("identify/criticism/a.h", '#include "volcal/identify/errors/error_tables.h"',
                             "criticism may not include errors")

    def test_sim_in_identify(self):
        self.assert_rejected("identify/standards/a.cpp", '#include "volcal/sim/study.h"', "may not include sim")

    def test_sim_in_io(self):
        self.assert_rejected("identify/io/a.cpp", '#include "volcal/sim/study.h"', "io may not include sim")

    def test_folders(self):
        self.write("identify/solve/elsewhere/a.cpp", "")
        done = check(self.root)
        self.assertEqual(done.returncode, 1)
        self.assertIn("identify/solve/elsewhere:1: the folder is in no table", done.stdout)
        (self.root / "identify/solve/elsewhere/a.cpp").unlink()
        for number in range(18):
            self.write(f"identify/noise/a{number}.cpp", "")
        done = check(self.root)
        self.assertEqual(done.returncode, 1)
        self.assertIn("identify/noise:1: 18 sources", done.stdout)

    def assert_length_rejected(self, *words):
        done = check(self.root)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        for word in words:
            self.assertIn(word, done.stdout)

    def test_long_sources(self):
        self.assert_accepted("identify/noise/a.cpp", *["//"] * 500)
        self.write("identify/noise/a.cpp", *["//"] * 501)
        self.assert_length_rejected("identify/noise/a.cpp:501: 501 lines", "500 are allowed")
        self.write("scripts/long_sources.txt", "# today's", "identify/noise/a.cpp 501")
        self.assertEqual(check(self.root).returncode, 0)
        self.write("identify/noise/a.cpp", *["//"] * 502)
        self.assert_length_rejected("identify/noise/a.cpp:502: 502 lines", "501 are allowed")

    def test_the_list_of_long_sources_shrinks(self):
        self.write("scripts/long_sources.txt", "identify/noise/a.cpp 510", "identify/noise/gone.cpp 520")
        self.write("identify/noise/a.cpp", *["//"] * 505)
        self.assert_length_rejected("scripts/long_sources.txt:1: identify/noise/a.cpp has 505 lines",
                                    "scripts/long_sources.txt:2: identify/noise/gone.cpp is no longer")
        self.write("scripts/long_sources.txt", "identify/noise/a.cpp 510")
        self.write("identify/noise/a.cpp", *["//"] * 500)
        self.assert_length_rejected("scripts/long_sources.txt:1: identify/noise/a.cpp is no longer", "off the list")

    def test_files_in_physics(self):
        for header in ("fstream", "filesystem"):
            self.assert_rejected("model/instruments/a.cpp", f"#include <{header}>", f"<{header}>")

    def test_include_by_relative_path(self):
        self.assert_rejected("model/functions/a.cpp", '#include "../kinematics/chain.h"', "volcal/<folder>/chain.h")

    def test_names_of_instruments(self):
        self.write("model/instruments/bar.cpp", "const InstrumentSchema kBar = {", '    .name = "ball-bar",', "};")
        self.write("model/instruments/angle.cpp", "const InstrumentSchema kAngle = {", '    .name = "angle",', "};")
        self.assert_accepted("identify/planning/instruments/bar.cpp", 'return "ball-bar";')
        self.assert_accepted("identify/solve/word.cpp", 'add("angle");  // as "ball-bar"', 'add("ball-bar-length");')
        constant = 'inline constexpr const char* kBallBar = "ball-bar";'
        self.assert_accepted("sim/measurement/measurements.h", constant)
        self.assert_accepted("sim/measurement/bar.cpp", "plan.instrument = kBallBar;")
        self.assert_accepted("studies/bar.cpp", "plan.instrument = sim::kBallBar;")
        wrong = 'if (setup.instrument == "angle") return;'
        self.assert_rejected("identify/solve/a.cpp", wrong, "names an instrument", "InstrumentTraits")
        self.write("identify/solve/a.cpp", "")
        self.assert_rejected("studies/a.cpp", 'find(setups, "ball-bar", &Setup::instrument)', "names an instrument")
        self.write("studies/a.cpp", "")
        self.assert_rejected("sim/measurement/b.cpp", 'if (plan.instrument == "ball-bar") return;', "names an instrument")
        self.write("sim/measurement/b.cpp", "")
        self.assert_rejected("identify/cli/commands/a.cpp", "head(name, sim::kBallBar);", "sim::kBallBar", "InstrumentTraits")

    def test_names_of_open_kinds(self):
        self.write("model/effects/kinds/open/empirical.cpp", 'constexpr const char* kEmpirical = "empirical";',
                   "const EffectSchema kSchema = {.kind = kEmpirical};")
        self.assert_accepted("identify/criticism/search/a.cpp", "return empirical_effect().make(spec, {});")
        self.assert_accepted("sim/known/a.cpp", 'return {{"empirical", known_empirical}};')
        self.assert_rejected("identify/criticism/search/b.cpp", 'return spec.kind == "empirical";', "names a kind of effect")

    def test_folder_without_a_layer(self):
        self.write("model/elsewhere/a.h", "#pragma once")
        done = check(self.root)
        self.assertEqual(done.returncode, 1)
        self.assertIn("model/elsewhere/a.h:1: the folder is in no layer", done.stdout)

    def test_unreadable_page(self):
        (self.root / "docs" / "layers.md").write_text("# Layers\n", encoding="utf-8")
        self.assertEqual(check(self.root).returncode, 2)


if __name__ == "__main__":
    unittest.main()
