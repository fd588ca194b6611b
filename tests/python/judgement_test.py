"""Alignment, budgets, comparisons, effects that are tried, certificates: the numbers of the command line."""

import json
import unittest
from typing import Any

import numpy as np

import volcal
from support import HIDDEN, SOURCE, FittedCase, coarse, run_program, without_times

FOLDER = HIDDEN / "21"
FILE = FOLDER / "campaign.toml"


class Fitted(FittedCase):
    def setUp(self) -> None:
        super().setUp()
        self.folder_of_result = self.folder / "result"
        self.result.write(self.folder_of_result, report=False)


class Alignment(Fitted):
    def test_an_aligned_result_is_that_of_the_program(self) -> None:
        told = json.loads(run_program("align", self.folder_of_result, "--primary", "Y", "--secondary", "X", "--origin",
                                      "X=10,Z=-60", "--json", "-o", self.folder / "program"))
        wished: dict[str, Any] = {"primary": "Y", "secondary": "X", "origin": {"x_mm": 10.0, "z_mm": -60.0}}
        aligned = volcal.align(volcal.read_result(self.folder_of_result), **wished)
        self.assertEqual(aligned.description, told["alignment"])
        self.assertEqual(list(aligned.frame_rotation / 1e-6), [angle["urad"] for angle in told["frame_rotation"]])
        self.assertEqual(list(np.sqrt(np.diag(aligned.frame_covariance)) / 1e-6),
                         [angle["u_urad"] for angle in told["frame_rotation"]])
        self.assertEqual(without_times(aligned.result.to_json()).rstrip("\n"),
                         without_times((self.folder / "program" / "result.json").read_text()).rstrip("\n"))
        self.assertIn("primary Y", volcal.tables(aligned.result, format="csv").files["metadata.csv"].decode())
        # Of the fit in memory, whose covariance is symmetric but for rounding, and whose residuals are at hand.
        fresh = volcal.align(self.result, **wished)
        np.testing.assert_allclose(fresh.frame_covariance, aligned.frame_covariance, rtol=1e-12)
        fresh.result.write(self.folder / "module")
        for name in ("error_tables.csv", "volumetric_grid.csv", "residuals.csv", "machine.toml", "identified.toml"):
            one, other = ((self.folder / which / name).read_text() for which in ("program", "module"))
            self.assertEqual([line for line in one.splitlines() if not line.startswith("# ")],
                             [line for line in other.splitlines() if not line.startswith("# ")], name)
        self.assertTrue((self.folder / "module" / "report.html").exists())

    def test_a_result_of_files_is_aligned_too(self) -> None:
        aligned = volcal.align(volcal.read_result(self.folder_of_result), reference="spindle", spindle_tilt_urad=(12.0, -5.0))
        run_program("align", self.folder_of_result, "--align", "spindle", "--spindle-tilt", "A=12,B=-5", "-o",
                    self.folder / "program")
        aligned.result.write(self.folder / "module", report=False)
        self.assertEqual((self.folder / "module" / "error_tables.csv").read_text(),
                         (self.folder / "program" / "error_tables.csv").read_text())

    def test_what_cannot_be_aligned(self) -> None:
        self.refused(lambda: volcal.align(self.result), "nothing is to be aligned")
        self.refused(lambda: volcal.align(self.result, primary="C"), "primary", "C")
        self.refused(lambda: volcal.align(self.result, primary="X", secondary="X"), "primary")
        self.refused(lambda: volcal.align(self.result, origin={"w_mm": 1.0}), "w_mm")
        self.refused(lambda: volcal.align(self.result, origin={"x_mm": 1e6}), "travel")
        self.refused(lambda: volcal.align(self.result, reference="table"), "table")
        self.refused(lambda: volcal.align(self.result, spindle_tilt_urad=(1.0, 2.0)), "spindle")


class Budgets(Fitted):
    def test_the_budget_of_a_result(self) -> None:
        said = run_program("budget", self.folder_of_result, "--tool", "short", "--grid", "5", "--json")
        budget = volcal.budget(volcal.read_result(self.folder_of_result), tool="short", grid=5)
        self.assertEqual(budget.to_json(), said)
        fresh = volcal.budget(self.result, tool="short", grid=5)  # its covariance is symmetric but for rounding
        self.assertEqual(fresh.total.rms, budget.total.rms)
        self.assertAlmostEqual(fresh.total.u_rms / budget.total.u_rms, 1.0, places=12)
        told = json.loads(said)
        self.assertEqual(budget.to_dict(), told)
        self.assertEqual(budget.tool, "short")
        self.assertAlmostEqual(sum(line.share for line in budget.contributions), 1.0, places=9)
        self.assertAlmostEqual(sum(line.share for line in budget.causes), 1.0, places=9)
        self.assertEqual(budget.contributions[0].rms, max(line.rms for line in budget.contributions))
        self.assertGreater(budget.total.rms, budget.total.u_rms)
        self.assertIn(budget.contributions[0].name, str(budget))
        self.assertTrue(budget._repr_html_().startswith("<pre>"))

    def test_the_budget_of_a_model(self) -> None:
        said = run_program("budget", self.folder_of_result / "identified.toml", "--json")
        budget = volcal.budget(volcal.Model.read(self.folder_of_result / "identified.toml", self.result.machine))
        self.assertEqual(budget.to_json(), said)
        self.refused(lambda: volcal.budget(coarse(self.campaign)), "states no error")

    def test_the_budget_of_tolerances(self) -> None:
        tolerances = self.folder / "tolerances.toml"
        tolerances.write_text('format = "volcal-tolerances-1"\n[tolerances]\npositioning_um = 10.0\nangles_urad = 15.0\n')
        machine = volcal.Machine.read(FOLDER / "machine.toml")
        said = run_program("budget", FOLDER / "machine.toml", "--tolerances", tolerances, "--json")
        budget = volcal.budget(machine, tolerances=tolerances)
        self.assertEqual(budget.to_json(), said)
        self.assertGreater(budget.rms_95, budget.total.u_rms)
        self.refused(lambda: volcal.budget(volcal.Machine.parse(machine.to_toml()), tolerances=tolerances), "of a file")
        self.refused(lambda: volcal.budget(self.result, tolerances=tolerances), "not built yet")
        self.refused(lambda: volcal.budget(self.result, grid=1), "grid=1")
        with self.assertRaises(TypeError):
            volcal.budget(3)  # type: ignore[arg-type]


class Comparisons(Fitted):
    def test_two_models_are_compared_as_by_the_program(self) -> None:
        where = self.folder / "program"
        said = run_program("compare", FILE, "nominal", self.folder_of_result, "--json", "--held-out", "-o", where)
        stages: list[str] = []
        comparison = volcal.compare(self.campaign, ["nominal", self.result], names=["nominal", str(self.folder_of_result)],
                                    held_out=True, progress=lambda stage, done: stages.append(stage))
        self.assertEqual(comparison.to_json(), said)
        self.assertEqual(comparison.names, ["nominal machine", str(self.folder_of_result)])
        self.assertLess(comparison.rms[1], 0.5 * comparison.rms[0])
        self.assertIn("readings by nominal machine", stages)
        comparison.write(self.folder / "module")
        names = sorted(path.name for path in where.iterdir() if path.name != ".volcal")
        self.assertEqual(names, sorted(p.name for p in (self.folder / "module").iterdir() if p.name != ".volcal"))
        for name in names:
            if name not in ("report.html", "comparison.txt"):
                self.assertEqual((where / name).read_text(), (self.folder / "module" / name).read_text(), name)
        self.assertTrue((where / "comparison.txt").read_text().startswith(str(comparison)))

    def test_residuals_are_views(self) -> None:
        comparison = volcal.compare(self.campaign, [self.result])
        residuals = comparison.residuals[0]
        self.assertEqual(comparison.names, ["result"])
        self.assertEqual((residuals.shape, residuals.flags.writeable, residuals.flags.owndata), ((1536,), False, False))
        self.assertAlmostEqual(float(np.sqrt(np.mean((residuals["reading"] - residuals["predicted"]) ** 2))),
                               comparison.rms[0], places=12)
        del comparison
        self.assertTrue(np.all(np.isfinite(residuals["w"])))

    def test_an_aligned_result_explains_the_readings_as_before(self) -> None:
        aligned = volcal.align(self.result, primary="Y", secondary="X").result
        comparison = volcal.compare(self.campaign, [self.result, aligned], names=["as fitted", "aligned"])
        self.assertAlmostEqual(comparison.rms[0] * 1e6, comparison.rms[1] * 1e6, places=3)

    def test_what_cannot_be_compared(self) -> None:
        self.refused(lambda: volcal.compare(self.campaign, []), "0 models")
        self.refused(lambda: volcal.compare(self.campaign, ["nominal"] * 3), "3 models")
        self.refused(lambda: volcal.compare(self.campaign, ["nominal"], names=["a", "b"]), "2 names")
        other = volcal.read_campaign(HIDDEN / "25" / "campaign.toml")
        self.refused(lambda: volcal.compare(other, [self.result]), "another machine")
        for wrong in ("nominal", ["nominel"], [3]):
            with self.assertRaises(TypeError):
                volcal.compare(self.campaign, wrong)  # type: ignore[arg-type]


class TriedEffects(Fitted):
    def test_an_effect_is_tried_as_by_the_program(self) -> None:
        campaign_file = SOURCE / "tests" / "data" / "small" / "campaign.toml"
        model_file = SOURCE / "tests" / "data" / "small" / "model.toml"
        campaign = volcal.read_campaign(campaign_file)
        model = volcal.Model.read(model_file, campaign.machine)
        written = "EXX: sin(x / p)"
        said = run_program("try", campaign_file, written, "--model", model_file, "--parameter", "p=250", "--json")
        shares: list[float] = []
        tried = volcal.try_effect(campaign, written, model, parameters=["p=250"],
                                  progress=lambda stage, done: shares.append(done))
        self.assertEqual(tried.to_json(), said)
        told = json.loads(said)
        self.assertEqual([value["name"] for value in tried.values], ["amplitude", "p"])
        self.assertEqual(tried.values[0]["value"], told["values"][0]["value"])
        self.assertTrue(np.isnan(tried.values[1]["u"]))
        self.assertEqual((tried.visible, tried.status), (told["visible"], told["status"]))
        self.assertEqual(tried.verdict_of_what_remains, told["verdict_of_what_remains"])
        if tried.held_out is not None:
            self.assertEqual(tried.held_out["with"]["chi2"], told["held_out"]["with"]["chi2"])
        self.assertEqual(shares, sorted(shares))
        self.assertTrue(str(tried).startswith(written + ": "))

    def test_what_is_no_effect(self) -> None:
        self.refused(lambda: volcal.try_effect(self.campaign, "EXX: dir_x *"), "dir_x *")
        self.refused(lambda: volcal.try_effect(self.campaign, "EQQ: dir_x"), "EQQ")
        with self.assertRaises(StopIteration):
            volcal.try_effect(self.campaign, "EXX: dir_x / 2", coarse(self.campaign), progress=stopping)


def stopping(stage: str, done: float) -> None:
    raise StopIteration(stage)


class Certificates(Fitted):
    def test_a_record_is_on_the_page(self) -> None:
        tables = volcal.tables(self.result, format="linuxcnc")
        record = {"serial_number": "4711-0815", "operator": "A. Müller", "instruments": {"laser-tracer": "No. 12"}}
        html = volcal.certificate(self.result, tables, record=record)
        for text in ("4711-0815", "A. Müller", "No. 12", "Certificate of compensation"):
            self.assertIn(text, html)
        verified = volcal.certificate(self.result, tables, record=record, verified=self.campaign)
        self.assertNotIn('"when":"with the tables"', html)
        self.assertIn('"when":"with the tables"', verified)
        self.assertIn("Signature", volcal.certificate(self.result, tables))
        file = self.folder / "campaign.toml"
        file.write_text(FILE.read_text() + '[record]\nserial_number = "of the file"\n')
        self.assertIn("of the file", volcal.certificate(self.result, tables, record=file))

    def test_what_is_no_record(self) -> None:
        tables = volcal.tables(self.result, format="linuxcnc")
        self.refused(lambda: volcal.certificate(self.result, tables, record={"serial_no": "1"}), "serial_no")
        self.refused(lambda: volcal.certificate(self.result, tables, record={"load": " "}), "load")
        read = volcal.read_result(self.folder_of_result)
        self.refused(lambda: volcal.certificate(read, tables), "without its readings")


if __name__ == "__main__":
    unittest.main()
