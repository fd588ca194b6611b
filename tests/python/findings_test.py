"""What the command line says of its figures, in Python: findings, warnings, the head of a rewritten program."""

import gc
import json
import shutil
import unittest
from collections.abc import Sequence

import volcal
from support import HIDDEN, Case, FittedCase, coarse, run_program, white_fit

FILE = HIDDEN / "21" / "campaign.toml"
PROGRAM = "G21 G90\nG0 X0 Y0 Z-10\nG1 X100 F1000\nM2\n"


class Fitted(FittedCase):
    def setUp(self) -> None:
        super().setUp()
        self.folder_of_result = self.folder / "result"
        self.result.write(self.folder_of_result, report=False)

    def told(self, findings: Sequence[volcal.Finding]) -> list[str]:
        return [str(finding) for finding in findings]


class Findings(Fitted):
    def test_their_data_are_their_own(self) -> None:
        read = volcal.read_result(self.folder_of_result)
        notes = volcal.read_campaign(HIDDEN / "25" / "campaign.toml").notes
        findings = self.result.findings + read.findings + read.invisible + notes
        self.assertGreater(len(findings), 0)
        for finding in findings:
            data = finding.data
            gc.collect()
            self.assertEqual((type(data), data), (dict, finding.data))
            json.dumps(data)


class Validation(Fitted):
    def test_readings_of_the_fit_prove_nothing(self) -> None:
        told = json.loads(run_program("validate", self.folder_of_result, FILE, "--json"))
        figures = volcal.validate(self.campaign, self.result)
        self.assertEqual(figures["fitted_readings"], told["fitted_readings"])
        self.assertIn("this is the campaign that the fit was made from", figures["warning"])
        self.assertNotIn("--", figures["warning"])
        self.assertEqual(self.told(figures["findings"]), told.get("notes", []))

    def test_of_a_machine_with_tables(self) -> None:
        tables = volcal.tables(self.result, format="csv", step_mm=50.0)
        tables.write(self.folder / "tables")
        told = json.loads(run_program("validate", self.folder_of_result, FILE, "--tables", self.folder / "tables", "--json"))
        figures = volcal.validate(self.campaign, self.result, tables=tables)
        for name in ("rms_before", "rms_after", "max_after", "compensated_rms", "compensated_max"):
            self.assertAlmostEqual(figures[name] * 1e6, told[name + "_um"], places=9)
        self.assertAlmostEqual(figures["reduced_chi2"], told["reduced_chi2"], places=9)
        self.assertEqual(self.told(figures["findings"]), told.get("notes", []))
        self.assertNotIn("compensated_rms", volcal.validate(self.campaign, self.result))

    def test_of_a_machine_with_superimposed_tables(self) -> None:
        """The files and figures of the command line, for errors identified with the former tables active."""
        measured = self.folder / "measured"
        shutil.copytree(FILE.parent, measured)
        file = measured / FILE.name
        file.write_text('active_compensations = "L-POS of May"\n' + FILE.read_text())
        campaign = volcal.read_campaign(file)
        result = volcal.fit(campaign, coarse(campaign), noise="white", screening=False)
        result.write(self.folder / "again", report=False)
        former = volcal.tables(self.result, format="neutral-csv", type="L-POS", step_mm=100.0)
        former.write(self.folder / "former")
        tables = volcal.tables(result, format="neutral-csv", step_mm=100.0, superimpose=former)
        tables.write(self.folder / "tables")
        run_program("tables", self.folder / "again", "--format", "neutral-csv", "--step", "100", "--superimpose",
                    self.folder / "former", "-o", self.folder / "by_program")
        names = sorted(path.relative_to(self.folder / "tables") for path in (self.folder / "tables").rglob("*.csv"))
        self.assertEqual(names, sorted(path.relative_to(self.folder / "by_program")
                                       for path in (self.folder / "by_program").rglob("*.csv")))
        self.assertIn("superimposed_on/metadata.csv", map(str, names))
        for name in names:
            self.assertEqual((self.folder / "tables" / name).read_bytes(), (self.folder / "by_program" / name).read_bytes(), name)
        told = json.loads(run_program("validate", self.folder / "again", file, "--tables", self.folder / "tables", "--json"))
        figures = volcal.validate(campaign, result, tables=tables)
        self.assertAlmostEqual(figures["rms_after"] * 1e6, told["rms_after_um"], places=6)
        self.assertEqual(self.told(figures["findings"]), told.get("notes", []))
        # Beyond the former tables they correct what tables do that stand beside these.
        beside = volcal.tables(result, format="neutral-csv", step_mm=100.0)
        alone = volcal.validate(campaign, result, tables=beside)
        self.assertAlmostEqual(figures["rms_after"] * 1e6, alone["rms_after"] * 1e6, places=5)

    def test_of_an_aligned_result(self) -> None:
        aligned = volcal.align(self.result, primary="Y", secondary="X").result
        one, other = (volcal.validate(self.campaign, each) for each in (self.result, aligned))
        self.assertAlmostEqual(one["rms_after"] * 1e6, other["rms_after"] * 1e6, places=3)

    def test_comparisons_say_it_too(self) -> None:
        told = json.loads(run_program("compare", FILE, self.folder_of_result, "--json"))
        comparison = volcal.compare(self.campaign, [self.result])
        self.assertEqual(self.told(comparison.findings), told.get("notes", []))


class Programs(Fitted):
    def test_a_program_says_what_it_is_valid_for(self) -> None:
        program = self.folder / "part.ngc"
        program.write_text(PROGRAM)
        said = json.loads(run_program("compensate", self.folder_of_result, program, "-o", self.folder / "out.ngc", "--check",
                                      "--work-offset", "G54=X1.5,Y0,Z-100", "--tool-length", "H1=50", "--json"))
        read = volcal.read_result(self.folder_of_result)
        done = volcal.compensate(read, PROGRAM, work_offsets={"G54": (1.5, 0.0, -100.0)}, tool_lengths={1: 50.0},
                                 name=str(program))
        self.assertEqual(done.text, (self.folder / "out.ngc").read_text())
        self.assertIn("G54=X1.5,Y0,Z-100 H1=50", done.text)
        del said["file"]
        self.assertEqual(done.summary, said)
        self.assertEqual(self.told(done.findings), said["effects_not_compensated"] + said["invisible"] + said["contradicted"]
                         + said["of_tables"])
        fresh = volcal.compensate(self.result, PROGRAM, work_offsets={"G54": (0.0, 0.0, -100.0)})
        self.assertIn("volcal compensate: a fit of", fresh.text)

    def test_a_result_that_lacks_something_says_so(self) -> None:
        self.assertEqual(self.result.status, "lack_of_fit")
        done = volcal.compensate(self.result, PROGRAM, work_offsets={"G54": (0.0, 0.0, -100.0)})
        self.assertNotEqual(done.findings, [])
        self.assertNotEqual(done.summary["contradicted"], [])

    def test_what_turns_rotary_axes(self) -> None:
        at = {"G54": (0.0, 0.0, -100.0)}
        self.refused(lambda: volcal.compensate(self.result, PROGRAM, work_offsets=at, orientation=True),
                     "no tool centre point motion", "leave orientation out")
        self.refused(lambda: volcal.compensate(self.result, PROGRAM, work_offsets=at, rotary_decimals=9), "rotary_decimals is 9")


class TurningPrograms(Case):
    def test_a_program_with_tool_centre_point_motion(self) -> None:
        _, result = white_fit(HIDDEN / "61" / "campaign.toml")
        result.write(self.folder / "result", report=False)
        program = self.folder / "part.ngc"
        program.write_text("G21 G90\nG43.4 H1\nG0 X0 Y0 Z-150 A0 C0\nG1 X20 Y10 Z-160 A10 C20 F1000\nG49\nM2\n")
        said = json.loads(run_program("compensate", self.folder / "result", program, "-o", self.folder / "out.ngc", "--check",
                                      "--work-offset", "G54=X0,Y0,Z-100", "--tool-length", "H1=150", "--orientation",
                                      "--rotary-decimals", "6", "--json"))
        done = volcal.compensate(volcal.read_result(self.folder / "result"), program.read_text(),
                                 work_offsets={"G54": (0.0, 0.0, -100.0)}, tool_lengths={1: 150.0}, orientation=True,
                                 rotary_decimals=6, name=str(program))
        del said["file"]
        self.assertEqual((done.text, done.summary), ((self.folder / "out.ngc").read_text(), said))
        self.assertLess(done.rms_after, 0.1 * done.rms_before)


if __name__ == "__main__":
    unittest.main()
