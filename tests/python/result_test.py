"""Fits, diagnoses, tables and draws: the numbers of the command line, to the last bit."""

import functools
import importlib.util
import json
import pickle
import sys
import types
import unittest
from typing import Any

import numpy as np

import volcal
from support import COARSE, HIDDEN, SOURCE, Case, coarse, csv_table, run_program, setups_as_arrays, without_times

FOLDER = HIDDEN / "21"
FILE = FOLDER / "campaign.toml"
MODEL = FOLDER / "model.toml"


@functools.cache
def fitted() -> tuple[volcal.Campaign, volcal.Result]:
    campaign = volcal.read_campaign(FILE)
    return campaign, volcal.fit(campaign, coarse(campaign))


class Fitted(Case):
    """One campaign with its result, for all tests."""

    campaign: volcal.Campaign
    result: volcal.Result

    @classmethod
    def setUpClass(cls) -> None:
        cls.campaign, cls.result = fitted()

    def setUp(self) -> None:
        super().setUp()
        self.model_file = self.folder / "coarse.toml"
        self.model_file.write_text(COARSE)


class AgainstTheProgram(Fitted):
    def test_a_fit_writes_the_same_bytes(self) -> None:
        run_program("fit", FILE, "--model", self.model_file, "-o", self.folder / "program")
        self.result.write(self.folder / "module")
        names = sorted(path.name for path in (self.folder / "program").iterdir() if path.name != ".volcal")
        self.assertEqual(names, sorted(p.name for p in (self.folder / "module").iterdir() if p.name != ".volcal"))
        for name in names:
            one, other = ((self.folder / which / name).read_text() for which in ("program", "module"))
            if name == "result.json":
                self.assertEqual(without_times(one), without_times(other))
                self.assertGreater(len(without_times(one)), 0.9 * len(one))
            elif name != "report.html":
                self.assertEqual(one, other, name)

    def test_a_fit_of_arrays_has_the_same_numbers(self) -> None:
        campaign = volcal.Campaign.from_arrays(self.campaign.machine, setups_as_arrays(self.campaign, FOLDER))
        result = volcal.fit(campaign, coarse(campaign), threads=1)
        self.assertEqual(without_times(result.to_json()), without_times(self.result.to_json()))
        self.assertTrue(np.array_equal(result.residuals["w"], self.result.residuals["w"]))

    def test_options_are_those_of_the_program(self) -> None:
        run_program("fit", FILE, "--model", self.model_file, "--noise", "white", "--outliers", "remove", "--first-order",
                    "--robust", "huber", "--keep-stated-sigma", "-o", self.folder / "program")
        model = volcal.Model.read(self.model_file, self.campaign.machine)
        result = volcal.fit(self.campaign, model, noise="white", outliers="remove", first_order=True, robust="huber",
                            keep_stated_sigma=True)
        self.assertEqual(without_times((self.folder / "program" / "result.json").read_text()),
                         without_times(result.to_json()).rstrip("\n"))
        self.refused(lambda: volcal.fit(self.campaign, noise="pink"), "pink", "auto, white")

    def test_tables_have_the_same_bytes(self) -> None:
        self.result.write(self.folder / "result", report=False)
        of_csv = {"step_mm": 50.0, "run": str(self.folder / "result")}
        choices: list[tuple[str, dict[str, Any]]] = [("linuxcnc", {}), ("csv", of_csv)]
        for name, options in choices:
            arguments = ["--step", "50"] if "step_mm" in options else []
            run_program("tables", self.folder / "result", "--format", name, *arguments, "-o", self.folder / name)
            tables = volcal.tables(self.result, format=name, **options)
            for file, content in tables.files.items():
                self.assertEqual(content, (self.folder / name / file).read_bytes(), file)
            tables.write(self.folder / (name + "-again"))
            self.assertTrue((self.folder / (name + "-again") / next(iter(tables.files))).exists())
            self.assertLess(tables.error_left["tables"]["rms_um"], tables.error_left["before"]["rms_um"])
        self.assertIn("linuxcnc", volcal.table_formats())
        self.refused(lambda: volcal.tables(self.result, format="linux"), "linux is not a table format")

    def test_draws_are_the_same(self) -> None:
        said = run_program("montecarlo", FILE, "--model", self.model_file, "-n", "200", "--refits", "1", "--grid", "0", "--path", "linear",
                           "--json", "-o", self.folder / "program")
        study = volcal.montecarlo(self.campaign, self.result, draws=200, refits=1, grid=0, path="linear")
        told, own = json.loads(said), study.to_dict()
        for each in (told, own):
            each.pop("check", None)  # seconds of the sample of refits
        self.assertEqual(told, own)
        self.assertEqual(study.u.shape, (len(study.names),))
        self.assertEqual((study.draws, study.path), (200, "linear"))
        study.write(self.folder / "module", report=False)
        self.assertEqual((self.folder / "module" / "montecarlo.csv").read_bytes(),
                         (self.folder / "program" / "montecarlo.csv").read_bytes())

    def test_a_diagnosis_is_the_same(self) -> None:
        said = run_program("diagnose", FILE, "--auto", "--json", "-o", self.folder / "program")
        diagnosis = volcal.diagnose(self.campaign, climb=True)
        self.assertEqual(diagnosis.to_json(), said)
        self.assertEqual(diagnosis.verdict, "NAMED")
        self.assertEqual([effect.name for effect in diagnosis.effects],
                         ["reversal:EXX:dir_x:step", "axis-coupling:ECX:z:linear"])
        amplitude = diagnosis.effects[0].amplitudes[0]
        self.assertAlmostEqual(amplitude["value"] / amplitude["si_per_unit"], 1.38, places=2)
        self.assertEqual([step.model for step in diagnosis.ladder], ["0", "1", "2"])
        self.assertLess(diagnosis.ladder[2].rms_heldout, diagnosis.ladder[0].rms_heldout)
        diagnosis.write(self.folder / "module", report=False)
        for name in ("diagnosis.json", "diagnosis.txt", "extended.toml"):
            self.assertEqual((self.folder / "module" / name).read_text(),
                             (self.folder / "program" / name).read_text(), name)
        self.check_extended(diagnosis)
        self.check_read_again(volcal.read_diagnosis(self.folder / "module"))

    def check_extended(self, diagnosis: volcal.Diagnosis) -> None:
        extended = diagnosis.extended_model()
        self.assertEqual(len(extended.effects), 2)
        by_hand = volcal.Model(self.campaign.machine)
        for effect in diagnosis.effects:
            by_hand = by_hand.extend(effect, self.campaign)
        self.assertEqual(by_hand.effects, extended.effects)
        self.refused(lambda: extended.extend("reversal:EXX"), "reversal:EXX")
        better = volcal.fit(self.campaign, extended, screening=False, noise="white")
        self.assertLess(better.sigma0, 1.02)
        self.assertIn("reversal EXX", better.names)
        self.assertIn("NAMED", diagnosis._repr_html_())

    def check_read_again(self, diagnosis: volcal.Diagnosis) -> None:
        self.assertEqual(diagnosis.verdict, "NAMED")
        self.assertEqual(len(volcal.Model(self.campaign.machine).extend(diagnosis.effects[1]).effects), 1)
        self.refused(diagnosis.extended_model, "read from files")


class Arrays(Fitted):
    def test_parameters_are_views(self) -> None:
        count = len(self.result.names)
        for array, shape in ((self.result.parameters, (count,)), (self.result.covariance, (count, count)),
                             (self.result.residuals, (1536,))):
            self.assertEqual(array.shape, shape)
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)
            with self.assertRaises(ValueError):
                array[0] = array[0]
        pointer = self.result.parameters.__array_interface__["data"][0]
        self.assertEqual(self.result.parameters.__array_interface__["data"][0], pointer)
        self.assertEqual(len(self.result.units), count)
        self.assertEqual(self.result.si_per_unit.shape, (count,))
        np.testing.assert_array_equal(self.result.u, np.sqrt(np.maximum(0.0, np.diag(self.result.covariance))))

    def test_views_keep_the_result_alive(self) -> None:
        residuals = volcal.fit(self.campaign, coarse(self.campaign), noise="white", screening=False).residuals
        self.assertTrue(np.all(np.isfinite(residuals["reading"])))

    def test_names_and_values_are_those_of_the_file(self) -> None:
        told = self.result.to_dict()
        np.testing.assert_array_equal(self.result.parameters, told["parameters"])
        squareness = {each["symbol"]: each["value"] for each in told["locations"]}
        place = self.result.names.index("EC0Y")
        self.assertEqual(self.result.parameters[place], squareness["EC0Y"])
        self.assertEqual((self.result.units[place], self.result.si_per_unit[place]), ("urad", 1e-6))
        self.assertIn("EXX 0", self.result.names)
        self.assertEqual(len(set(self.result.names)), len(self.result.names))
        self.assertEqual((self.result.status, self.result.sigma0), (told["status"], told["sigma0"]))

    def test_residuals_are_those_of_the_file(self) -> None:
        self.result.write(self.folder / "result", report=False)
        table = csv_table(self.folder / "result" / "residuals.csv")
        residuals = self.result.residuals
        np.testing.assert_allclose((residuals["reading"] - residuals["predicted"]) * 1e6, table["residual_um"],
                                   atol=1e-3)
        np.testing.assert_array_equal(residuals["source_line"], table["row"])
        self.assertEqual([self.result.setups[i] for i in residuals["setup"]], list(table["setup"]))

    def test_errors_at_points(self) -> None:
        errors = self.result.errors_at(x_mm=[0.0, 100.0], z_mm=np.array([-50.0, -60.0]), tool="short",
                                       approach={"X": 1})
        self.assertEqual((errors["value"].shape, errors["u"].shape), ((2, 6), (2, 6)))
        self.result.write(self.folder / "result", report=False)
        told = json.loads(run_program("tables", self.folder / "result", "--at", "X=100,Z=-60", "--tool", "short",
                                      "--approach", "X+", "--json"))["volumetric_errors"][0]
        np.testing.assert_allclose(errors["value"][1, :3] * 1e6, told["error_um"], rtol=1e-12)
        np.testing.assert_allclose(errors["u"][1, 3:] * 1e6, told["u_rotation_urad"], rtol=1e-12)
        self.refused(lambda: self.result.errors_at(w_mm=[1.0]), "w_mm")
        self.refused(lambda: self.result.errors_at(x_mm=[1.0, 2.0], y_mm=[1.0]), "y_mm", "another length")
        self.refused(lambda: self.result.errors_at(x_mm=[1.0], tool="hammer"), "hammer")

    def test_error_table(self) -> None:
        table = self.result.error_table(positions=11)
        self.assertEqual(set(table["symbol"][table["axis"] == "X"]), {"EXX", "EYX", "EZX", "EAX", "EBX", "ECX"})
        self.assertEqual(np.count_nonzero(table["symbol"] == "EXX"), 11)
        self.assertTrue(np.all(np.isnan(table["position"][table["symbol"] == "EC0Y"])))
        self.refused(lambda: self.result.error_table(zero="left"), "left")

    def test_validation(self) -> None:
        figures = volcal.validate(self.campaign, self.result)
        self.assertLess(figures["rms_after"], figures["rms_before"])
        self.assertEqual(figures["readings"], 1536)
        self.assertEqual(figures["findings"], [])

    def test_a_result_read_again(self) -> None:
        self.result.write(self.folder / "result", report=False)
        again = volcal.read_result(self.folder / "result")
        lower = np.tril_indices(len(again.names))
        np.testing.assert_array_equal(again.covariance[lower], self.result.covariance[lower])
        self.assertEqual(again.to_json(), self.result.to_json())
        self.assertEqual(again.residuals.shape, (0,))
        self.refused(lambda: again.write(self.folder / "again"), "without its readings")
        self.assertEqual(self.result.provenance["command"], f'volcal.fit(volcal.read_campaign("{FILE}"), model="model")')


class Shown(Fitted):
    def test_a_result_of_files_is_told_as_it_was_fitted(self) -> None:
        self.result.write(self.folder / "result", report=False)
        read = str(volcal.read_result(self.folder / "result"))
        told = str(self.result).splitlines()
        self.assertEqual(read.splitlines()[:2], told[:2])
        self.assertLess(len(read.splitlines()), 30)
        self.assertNotIn("--", read)

    def test_in_a_notebook(self) -> None:
        html = self.result._repr_html_()
        for text in ("<table>", "EXX", "EC0Y", "<svg", "status lack_of_fit"):
            self.assertIn(text, html)
        self.assertNotIn("http", html.replace("http://www.w3.org", ""))
        self.assertIn("1,536 readings in 8 setups", str(self.result))

    def test_frames(self) -> None:
        """A stand-in for pandas, which need not be there."""
        stand_in: Any = types.ModuleType("pandas")
        stand_in.DataFrame = lambda columns: ("frame", columns)
        before = sys.modules.get("pandas")
        sys.modules["pandas"] = stand_in
        try:
            kind, columns = self.result.to_frame()
            self.assertEqual((kind, list(columns)[:2]), ("frame", ["symbol", "axis"]))
            self.assertEqual(self.campaign.setups[0].to_frame()[1]["x_mm"].shape, (192,))
            self.assertIn("w", self.result.residual_frame()[1].dtype.names)
        finally:
            del sys.modules["pandas"]
            if before is not None:
                sys.modules["pandas"] = before


    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed")
    def test_frames_of_pandas(self) -> None:
        frame = self.result.to_frame()
        self.assertEqual(type(frame).__name__, "DataFrame")
        self.assertEqual(str(frame.dtypes["value"]), "float64")
        residuals = self.result.residual_frame()
        self.assertEqual(residuals.shape, (1536, len(self.result.residuals.dtype.names or ())))
        np.testing.assert_array_equal(residuals["w"], self.result.residuals["w"])
        self.assertEqual(len(self.campaign.setups[0].to_frame()), 192)
        budget = volcal.budget(self.result)
        self.assertEqual(list(budget.to_frame()["name"]), [line.name for line in budget.contributions])


class Models(Fitted):
    def test_machines_and_models_are_pickled(self) -> None:
        machine = pickle.loads(pickle.dumps(self.campaign.machine))
        self.assertEqual((machine.to_toml(), machine.name), (self.campaign.machine.to_toml(), self.campaign.machine.name))
        model = coarse(self.campaign).extend("reversal:EXX", self.campaign)
        again = pickle.loads(pickle.dumps(model))
        self.assertEqual((again.to_toml(), again.effects), (model.to_toml(), model.effects))
        one, other = (volcal.fit(self.campaign, each, noise="white", screening=False) for each in (model, again))
        np.testing.assert_array_equal(one.parameters, other.parameters)
        identified = pickle.loads(pickle.dumps(self.result.model))
        self.assertEqual(volcal.compare(self.campaign, [identified]).rms, volcal.compare(self.campaign, [self.result.model]).rms)
        for what in (self.campaign, self.result, self.campaign.setups[0]):
            with self.assertRaisesRegex(TypeError, "pickle"):
                pickle.dumps(what)

    def test_models_are_read_extended_and_written(self) -> None:
        machine = self.campaign.machine
        model = volcal.Model.read(MODEL, machine)
        custom = {"kind": "custom", "target": "EZX", "expression": "abs(x) / 400 * dir_x"}
        extended = model.extend("reversal:EXX").extend(custom, self.campaign)
        self.assertEqual((len(model.effects), len(extended.effects)), (0, 2))
        extended.write(self.folder / "model.toml")
        again = volcal.Model.read(self.folder / "model.toml", machine)
        self.assertEqual(again.effects, extended.effects)
        self.assertEqual(volcal.Model.parse(extended.to_toml(), machine).effects, extended.effects)
        self.refused(lambda: model.extend("reversal:EYQ"), "reversal:EYQ")
        self.refused(lambda: model.extend({**custom, "expression": "abs(x"}), "abs(x")
        self.refused(lambda: volcal.Model.parse("format = \"volcal-model-1\"\n[functions]\nEQX = 1\n", machine, "m.toml"),
                     "m.toml:3")

class Programs(Fitted):
    def test_a_program_is_compensated_as_by_the_command_line(self) -> None:
        program = (SOURCE / "tests" / "data" / "programs" / "pocket.ngc").read_text()
        result = self.folder / "result"
        self.result.write(result, report=False)
        (self.folder / "part.ngc").write_text(program)
        run_program("compensate", result, self.folder / "part.ngc", "-o", self.folder / "out.ngc", "--work-offset",
                    "G54=X10,Y-20,Z-250", "--tool-length", "H1=150")
        done = volcal.compensate(self.result, program, work_offsets={"G54": (10.0, -20.0, -250.0)},
                                 tool_lengths={1: 150.0})
        told = (self.folder / "out.ngc").read_text().splitlines()
        differing = [pair for pair in zip(done.text.splitlines(), told, strict=True) if pair[0] != pair[1]]
        made_of = f"a fit of {self.campaign.file} G54=X10,Y-20,Z-250 H1=150"
        self.assertEqual([own for own, _ in differing], [f"(volcal compensate: {made_of})"])
        self.assertLess(done.rms_after, 0.1 * done.rms_before)
        stated = volcal.compensate(self.result, program, work_offsets={"G54": (10.0, -20.0, -250.0)},
                                   tool_lengths={1: 150.0}, conditions={"T_column": 23.3})
        self.assertIn("(conditions: T_column_degC=23.3 as stated)", stated.text.splitlines())
        self.refused(lambda: volcal.compensate(self.result, program, work_offsets={"G7": (0.0, 0.0, 0.0)}), "G7")

    def test_a_plan_is_the_same(self) -> None:
        machine = HIDDEN / "21" / "machine.toml"
        said = run_program("plan", machine, "--model", self.model_file, "--readings", "64", "--stations", "2",
                           "--tools", "short", "--json")
        plan = volcal.plan(self.campaign.machine, coarse(self.campaign), readings=64, stations=2, tools=["short"])
        self.assertEqual(plan.to_json(), said)
        self.assertGreater(plan.campaign.reading_count, 32)
        self.refused(lambda: volcal.plan(self.campaign.machine, readings=64, tools=["hammer"]), "hammer")
        other = volcal.Machine.read(SOURCE / "datasets" / "examples" / "mixed-1" / "machine.toml")
        self.refused(lambda: volcal.plan(other, readings=64, campaign=self.campaign), "is not the one that is given")


if __name__ == "__main__":
    unittest.main()
