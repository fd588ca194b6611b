"""Arguments that cannot be meant are refused by name."""

import math
import re
import unittest
from collections.abc import Callable
from typing import Any

import numpy as np

import volcal
from support import HIDDEN, FittedCase, setups_as_arrays

FOLDER = HIDDEN / "21"
NAN = math.nan
PROGRAM = "G21 G90\nG0 X0 Y0 Z-10\nG1 X100 F1000\nM2\n"


masked: Callable[..., Any] = np.ma.array


class Fitted(FittedCase):
    def of_type(self, what: Callable[[], object]) -> None:
        with self.assertRaises(TypeError):
            what()


class Nothing(Fitted):
    def test_none_is_no_campaign_result_or_machine(self) -> None:
        none: Any = None
        for what in (lambda: volcal.fit(none), lambda: volcal.diagnose(none), lambda: volcal.Session(none),
                     lambda: volcal.compare(none, ["nominal"]), lambda: volcal.try_effect(none, "EXX: dir_x"),
                     lambda: volcal.validate(none, self.result), lambda: volcal.montecarlo(none, self.result),
                     lambda: volcal.Campaign.setups.fget(none)):  # type: ignore[attr-defined]
            self.of_type(what)
        for what in (lambda: volcal.validate(self.campaign, none), lambda: volcal.montecarlo(self.campaign, none),
                     lambda: volcal.tables(none), lambda: volcal.align(none, primary="Y"),
                     lambda: volcal.compensate(none, PROGRAM), lambda: volcal.certificate(none, none),
                     lambda: volcal.budget(none), lambda: volcal.compare(self.campaign, [none])):
            self.of_type(what)
        for what in (lambda: volcal.Model(none), lambda: volcal.Model.parse("", none), lambda: volcal.plan(none, readings=64),
                     lambda: volcal.Campaign.from_arrays(none, []), lambda: volcal.Model.read("model.toml", none)):
            self.of_type(what)


class FromArrays(Fitted):
    def setUp(self) -> None:
        super().setUp()
        self.setups = setups_as_arrays(self.campaign, FOLDER)[:1]
        readings = self.setups[0]["readings"]
        assert isinstance(readings, dict)
        self.readings: dict[Any, Any] = readings

    def campaign_of(self, **more: object) -> volcal.Campaign:
        return volcal.Campaign.from_arrays(self.campaign.machine, [{**self.setups[0], **more}])

    def test_masked_readings(self) -> None:
        length = np.array(self.readings["length_mm"])
        mask = np.zeros(len(length), dtype=bool)
        self.readings["length_mm"] = masked(length, mask=mask)
        self.campaign_of()
        mask[2] = True
        self.readings["length_mm"] = masked(length, mask=mask)
        error = self.refused(self.campaign_of, "row 3", "length_mm", "masked", "leave out rows without a reading")
        self.assertEqual(error.line, 3)

    def test_complex_readings_and_dates(self) -> None:
        length = np.array(self.readings["length_mm"])
        self.readings["length_mm"] = length + 1j
        self.refused(self.campaign_of, "length_mm is complex")
        self.readings["length_mm"] = np.full(len(length), np.datetime64("2026-01-01"))
        self.refused(self.campaign_of, "length_mm is not an array of numbers")

    def test_keys_of_files(self) -> None:
        for key, value in (("skip_rows", 2), ("delimiter", ";"), ("decimal", ","), ("encoding", "cp1252"), ("data", "a.csv")):
            self.refused(lambda: self.campaign_of(**{key: value}), key, "the readings are arrays", "leave " + key + " out")

    def test_names_that_are_no_texts(self) -> None:
        self.readings[3] = self.readings["x_mm"]
        self.refused(self.campaign_of, "3", "is not a text")
        del self.readings[3]
        self.refused(lambda: self.campaign_of(noise={1: 0.3}), "noise", "is not a text")
        machine = self.campaign.machine
        wrong: Any = ["a"]
        self.refused(lambda: volcal.Campaign.from_arrays(machine, wrong), "setup 1 is a str", "mappings")
        noise: Any = 0.3
        self.refused(lambda: volcal.Campaign.from_arrays(machine, self.setups, noise=noise), "noise is a float")

    def test_messages_name_the_readings(self) -> None:
        self.readings["dirx"] = np.zeros(len(self.readings["x_mm"]))
        notes = [str(note) for note in self.campaign_of().notes]
        self.assertTrue(any("dirx of readings of P1" in note for note in notes), notes)


class AtPoints(Fitted):
    def test_positions_are_finite(self) -> None:
        for value in (NAN, math.inf):
            self.refused(lambda: self.result.errors_at(x_mm=[0.0, value]), "x_mm of point 2")
        self.refused(lambda: self.result.errors_at(x_mm=masked([0.0, 1.0], mask=[False, True])), "row 2 of x_mm is masked")
        self.refused(lambda: self.result.errors_at(x_mm=np.array([1j])), "x_mm is complex")

    def test_directions(self) -> None:
        at: Callable[[Any], Any] = lambda approach: self.result.errors_at(x_mm=[1.0], approach=approach)["value"]
        np.testing.assert_array_equal(at({"X": 1.0}), at({"X": 1}))
        self.refused(lambda: at({"X": "+"}), "approach X is a str")
        self.refused(lambda: at({"X": 2}), "approach X is 2", "-1, 0 or 1")
        self.refused(lambda: at({"X": NAN}), "approach X is nan")
        self.refused(lambda: at({"Q": 1}), "approach: Q")

    def test_conditions_and_tools_are_named_as_arguments(self) -> None:
        error = self.refused(lambda: self.result.errors_at(x_mm=[1.0], tool="zz"), "tool zz")
        self.assertNotIn("--", str(error))
        error = self.refused(lambda: self.result.errors_at(x_mm=[1.0], conditions={"T_q": 20.0}), "conditions T_q")
        self.assertNotIn("--", str(error))

    def test_rows_of_an_error_table(self) -> None:
        for rows in (1, -1, 100001):
            self.refused(lambda: self.result.error_table(positions=rows), f"positions {rows}", "2 to 100000")


class Alignment(Fitted):
    def test_frames_are_finite(self) -> None:
        self.refused(lambda: volcal.align(self.result, origin={"x_mm": NAN}), "origin x_mm is nan")
        wrong: Any = {"x_mm": "a"}
        self.refused(lambda: volcal.align(self.result, origin=wrong), "origin x_mm is a str")
        self.refused(lambda: volcal.align(self.result, reference="spindle", spindle_tilt_urad=(NAN, 0.0)),
                     "spindle_tilt_urad is nan")


class Tables(Fitted):
    def test_ranges_are_those_of_the_command_line(self) -> None:
        wrong: list[tuple[dict[str, Any], str]] = [
            ({"grid": -3}, "grid -3"), ({"grid": 302}, "1 to 301"), ({"positions": 1}, "positions 1"),
            ({"tolerance_um": NAN}, "tolerance_um nan"), ({"tolerance_um": -5.0}, "tolerance_um -5"),
            ({"step_mm": 50.0, "tolerance_um": 1.0}, "tolerance_um and step_mm"), ({"step_mm": -1.0}, "step_mm -1"),
            ({"step_mm": NAN}, "step_mm nan"), ({"rotary_step_deg": -5.0}, "rotary_step_deg -5"),
            ({"rotary_step_deg": NAN}, "rotary_step_deg nan"), ({"rotary_step_deg": 200.0}, "0.01 to 180")]
        for arguments, words in wrong:
            self.refused(lambda: volcal.tables(self.result, **arguments), words)
        error = self.refused(lambda: volcal.tables(self.result, format="linuxcnc", settings={"zz": "1"}), "settings zz")
        self.assertNotIn("--", str(error))


class Programs(Fitted):
    def compensated(self, **more: Any) -> volcal.CompensatedProgram:
        arguments: dict[str, Any] = {"work_offsets": {"G54": (0.0, 0.0, -100.0)}, **more}
        return volcal.compensate(self.result, PROGRAM, **arguments)

    def test_numbers_are_in_range(self) -> None:
        self.assertIn("X100.", self.compensated(decimals=5).text.replace("X99.", "X100."))
        for decimals in (3, 8, -3):
            self.refused(lambda: self.compensated(decimals=decimals), f"decimals {decimals}", "4 to 7")
        for value in (NAN, -1.0, 0.0):
            self.refused(lambda: self.compensated(tolerance_um=value), "tolerance_um")
            self.refused(lambda: self.compensated(arc_tolerance_um=value), "arc_tolerance_um")
        self.refused(lambda: self.compensated(work_offsets={"G54": (NAN, 0.0, 0.0)}), "work_offsets G54 is nan")
        self.refused(lambda: self.compensated(start=(NAN, 0.0, 0.0)), "start is nan")
        self.refused(lambda: self.compensated(tool_lengths={1: NAN}), "tool_lengths 1 is nan")

    def test_remedies_are_arguments(self) -> None:
        error = self.refused(lambda: volcal.compensate(self.result, PROGRAM), 'work_offsets={"G54": (x, y, z)}')
        self.assertNotIn("--", str(error))
        self.assertNotIn("--", str(self.refused(lambda: volcal.plan(self.campaign.machine), "give readings, time_h or both")))
        self.assertNotIn("--", str(self.refused(lambda: volcal.try_effect(self.campaign, "EXX: sin(x / p)"),
                                                'parameters=["p=250"] (held)')))


class Draws(Fitted):
    def drawn(self, campaign: volcal.Campaign, result: volcal.Result, **more: Any) -> volcal.MonteCarlo:
        return volcal.montecarlo(campaign, result, draws=50, refits=0, grid=0, path="linear", **more)

    def test_only_a_fit_of_the_campaign_is_drawn(self) -> None:
        self.result.write(self.folder / "result", report=False)
        read = volcal.read_result(self.folder / "result")
        self.refused(lambda: self.drawn(self.campaign, read), "read from files, without residuals",
                     "give fit() of this campaign")
        other = volcal.read_campaign(HIDDEN / "25" / "campaign.toml")
        self.refused(lambda: self.drawn(other, self.result), "of another campaign", "give fit() of this campaign")
        part = volcal.Campaign.from_arrays(self.campaign.machine, setups_as_arrays(self.campaign, FOLDER)[:4])
        self.refused(lambda: self.drawn(part, self.result), "of another campaign")
        aligned = volcal.align(self.result, primary="Y", secondary="X").result
        self.refused(lambda: self.drawn(self.campaign, aligned), "aligned", "give fit() of this campaign")
        self.refused(lambda: self.drawn(self.campaign, self.result, minutes=NAN), "minutes is nan")
        same = volcal.read_campaign(FOLDER / "campaign.toml")
        self.assertEqual(self.drawn(same, self.result).draws, 50)

    def test_a_result_of_files_serves_what_needs_no_residuals(self) -> None:
        self.result.write(self.folder / "result", report=False)
        read = volcal.read_result(self.folder / "result")
        self.assertEqual(volcal.validate(self.campaign, read)["readings"], 1536)
        self.assertEqual(len(volcal.compare(self.campaign, [read]).rms), 1)
        self.refused(read.report_html, "fit the campaign again")
        self.assertIn("<table>", read._repr_html_())
        self.assertIn("status", str(read))


class OtherMachines(Fitted):
    def test_a_model_of_another_machine(self) -> None:
        machine = self.campaign.machine
        text = machine.to_toml().replace("travel_mm = [-250, 250]", "travel_mm = [-251, 250]")
        self.assertNotEqual(text, machine.to_toml())
        other = volcal.Model(volcal.Machine.parse(text))
        for what in (lambda: volcal.fit(self.campaign, other), lambda: volcal.Session(self.campaign, other),
                     lambda: volcal.diagnose(self.campaign, other), lambda: volcal.plan(machine, other, readings=64),
                     lambda: volcal.try_effect(self.campaign, "EXX: dir_x", other),
                     lambda: other.extend("reversal:EXX", self.campaign)):
            self.refused(what, "the model is for another machine", "travel of X", "use a model of the same machine")

    def test_a_result_of_another_machine(self) -> None:
        other = volcal.read_campaign(HIDDEN / "25" / "campaign.toml")
        tables = volcal.tables(self.result, format="linuxcnc")
        for what in (lambda: volcal.validate(other, self.result), lambda: volcal.compare(other, [self.result]),
                     lambda: volcal.certificate(self.result, tables, verified=other)):
            self.refused(what, "another machine", "give errors and a campaign of the same machine")


class Numbers(Fitted):
    def test_threads(self) -> None:
        works: list[Callable[[int], object]] = [
            lambda n: volcal.fit(self.campaign, threads=n), lambda n: volcal.validate(self.campaign, self.result, threads=n),
            lambda n: volcal.diagnose(self.campaign, threads=n), lambda n: volcal.Session(self.campaign, threads=n),
            lambda n: volcal.compare(self.campaign, ["nominal"], threads=n),
            lambda n: volcal.try_effect(self.campaign, "EXX: dir_x", threads=n),
            lambda n: volcal.montecarlo(self.campaign, self.result, threads=n),
            lambda n: volcal.plan(self.campaign.machine, readings=64, threads=n)]
        for work in works:
            for threads in (-1, 1025):
                self.refused(lambda: work(threads), f"threads is {threads}", "0 to 1024")

    def test_plans(self) -> None:
        wrong: list[tuple[dict[str, Any], str]] = [
            ({"stations": 0}, "stations is 0"), ({"stations": 13}, "1 to 12"), ({"readings": 1}, "readings is 1"),
            ({"time_h": NAN}, "time_h is nan"), ({"bar_mm": -1.0}, "bar_mm is -1"), ({"bar_sigma_um": 0.0}, "bar_sigma_um is 0")]
        for arguments, words in wrong:
            given: dict[str, Any] = {"readings": 64, **arguments}
            error = self.refused(lambda: volcal.plan(self.campaign.machine, **given), words)
            self.assertNotIn("--", str(error))

    def test_draws(self) -> None:
        wrong: list[tuple[dict[str, Any], str]] = [
            ({"refits": -1}, "refits is -1"), ({"grid": 12}, "0 to 11"), ({"digits": 3}, "digits is 3"),
            ({"most_draws": 0}, "most_draws is 0"), ({"digits": 1, "draws": 50}, "digits and draws are given"),
            ({"disturb": ["reversal:EXX"]}, "disturb reversal:EXX"), ({"conditions": {"T_q": 20.0}}, "conditions T_q")]
        for arguments, words in wrong:
            error = self.refused(lambda: volcal.montecarlo(self.campaign, self.result, **arguments), words)
            self.assertNotIn("--", error.problem)

    def test_effects(self) -> None:
        wrong: Any
        for wrong in (3, None, 2.5):
            self.refused(lambda: volcal.Model(self.campaign.machine).extend(wrong), "an effect is a", "KIND:TARGET")
            self.refused(lambda: volcal.diagnose(self.campaign, separate=[wrong]), "an effect is a")
        self.refused(lambda: volcal.diagnose(self.campaign, readings=7), "readings is 7")
        self.refused(lambda: volcal.diagnose(self.campaign, try_effects=["EXX: dir_x *"]), "dir_x *")
        self.refused(lambda: volcal.diagnose(self.campaign, formula=["model"]), "formula model", "no effect of kind")

    def test_points_beyond_the_readings(self) -> None:
        result = self.result
        self.assertTrue(result.errors_at(x_mm=[0.0, 399.999])["extrapolated"][1])
        self.refused(lambda: result.errors_at(x_mm=[0.0, 399.999], within_readings=True), "point 2", "X at 399.999 mm",
                     "beyond the readings")
        result.errors_at(x_mm=[0.0], within_readings=True)


class Messages(FittedCase):
    def test_options_become_arguments_and_names_of_files_stay(self) -> None:
        text = str(self.refused(lambda: volcal.tables(self.result, tool="zz"), "tool zz"))
        self.assertNotIn("--tool", text)
        declared = (FOLDER / "campaign.toml").read_text()
        machine = f'machine = "{FOLDER / "machine.toml"}"'
        named = re.sub(r'^machine = .*$', machine, re.sub(r'data = "[^"]*"', 'data = "my--tool.csv"', declared), flags=re.M)
        file = self.folder / "campaign.toml"
        file.write_text(named)
        self.refused(lambda: volcal.read_campaign(file), "my--tool.csv")


if __name__ == "__main__":
    unittest.main()
