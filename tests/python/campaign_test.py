"""Campaigns from files and from arrays."""

import unittest

import numpy as np

import volcal
from support import HIDDEN, Case, csv_table, setups_as_arrays

FOLDER = HIDDEN / "25"


class FromFiles(Case):
    def test_what_a_file_holds(self) -> None:
        campaign = volcal.read_campaign(FOLDER / "campaign.toml")
        self.assertEqual(campaign.reading_count, 1536)
        self.assertEqual(campaign.machine.structure, "w X' Y' b Z t")
        self.assertEqual(campaign.machine.travel["x_mm"], (-300.0, 300.0))
        setup = campaign.setups[0]
        self.assertEqual((setup.name, setup.instrument, len(setup)), ("P1_short", "laser-tracer", 192))
        table = csv_table(FOLDER / "P1_short.csv")
        np.testing.assert_allclose(setup["length_mm"], table["length_mm"], rtol=0, atol=1e-10)
        np.testing.assert_array_equal(setup["dir_x"], table["dir_x"])
        self.assertEqual(list(setup.to_dict()), setup.columns)
        self.assertEqual((list(setup), "x_mm" in setup, "q_mm" in setup, 3 in setup), (setup.columns, True, False, False))
        with self.assertRaisesRegex(KeyError, "length_mm"):
            setup["length_m"]

    def test_what_is_wrong_with_a_file(self) -> None:
        text = (FOLDER / "P1_short.csv").read_text().splitlines()
        text[16] = text[16].replace(",", ";", 1)
        for name in ("campaign.toml", "machine.toml", *(f.name for f in FOLDER.glob("*.csv"))):
            (self.folder / name).write_text((FOLDER / name).read_text())
        (self.folder / "P1_short.csv").write_text("\n".join(text) + "\n")
        error = self.refused(lambda: volcal.read_campaign(self.folder / "campaign.toml"))
        self.assertEqual(error.file, str(self.folder / "P1_short.csv"))
        self.assertEqual(error.line, 17)
        self.assertNotEqual(error.problem, "")
        self.assertNotEqual(error.remedy, "")
        self.assertIsInstance(error, ValueError)

    def test_a_campaign_is_written_again(self) -> None:
        campaign = volcal.read_campaign(FOLDER / "campaign.toml")
        campaign.write(self.folder / "again")
        again = volcal.read_campaign(self.folder / "again" / "campaign.toml")
        np.testing.assert_allclose(again.setups[3]["length_mm"], campaign.setups[3]["length_mm"], rtol=0, atol=1e-7)

    def test_its_record_is_written_again(self) -> None:
        for name in ("machine.toml", *(f.name for f in FOLDER.glob("*.csv"))):
            (self.folder / name).write_text((FOLDER / name).read_text())
        record = '[record]\noperator = "A. Müller"\n[record.instruments]\n"laser-tracer" = "No. 12"\n'
        (self.folder / "campaign.toml").write_text((FOLDER / "campaign.toml").read_text() + record)
        volcal.read_campaign(self.folder / "campaign.toml").write(self.folder / "again")
        self.assertTrue((self.folder / "again" / "campaign.toml").read_text().endswith("\n" + record))
        volcal.read_campaign(self.folder / "again" / "campaign.toml")


class FromArrays(Case):
    def setUp(self) -> None:
        super().setUp()
        self.files = volcal.read_campaign(FOLDER / "campaign.toml")
        self.machine = volcal.Machine.read(FOLDER / "machine.toml")
        self.setups = setups_as_arrays(self.files, FOLDER)

    def readings(self, setup: int) -> dict[str, object]:
        readings = self.setups[setup]["readings"]
        assert isinstance(readings, dict)
        return readings

    def test_the_same_numbers_as_from_files(self) -> None:
        campaign = volcal.Campaign.from_arrays(self.machine, self.setups)
        self.assertEqual(campaign.reading_count, self.files.reading_count)
        for one, other in zip(campaign.setups, self.files.setups, strict=True):
            self.assertEqual(one.columns, other.columns)
            for column in one.columns:
                np.testing.assert_array_equal(one[column], other[column])

    def test_arrays_are_refused_by_setup_and_row(self) -> None:
        x = np.array(self.readings(1)["x_mm"])
        x[4] = 1e5
        self.readings(1)["x_mm"] = x
        error = self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "outside the travel of X")
        self.assertEqual((error.file, error.line), ("readings of P1_side_x", 5))
        x[4] = np.nan
        error = self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "not a finite number")
        self.assertEqual((error.file, error.line), ("readings of P1_side_x", 5))

    def test_arrays_that_do_not_fit(self) -> None:
        readings = self.readings(0)
        readings["x_mm"] = np.array(readings["x_mm"])[:-1]
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "has 191 rows", "P1_short")
        readings["x_mm"] = "here"
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "x_mm", "one dimension")
        del readings["x_mm"]
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "x_mm")
        del self.setups[0]["readings"]
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "P1_short", "no readings")

    def test_keys_are_those_of_campaign_toml(self) -> None:
        self.setups[0]["instrumnt"] = "laser-tracer"
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "instrumnt")
        del self.setups[0]["instrumnt"]
        self.setups[0]["station_mm"] = object()
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "station_mm is a object")
        self.setups[0]["station_mm"] = [1.0, 2.0]
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "station_mm")

    def test_what_holds_itself(self) -> None:
        endless: list[object] = []
        endless.append(endless)
        ring: dict[str, object] = {}
        ring["constant_um"] = ring
        self.setups[0]["station_mm"] = endless
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, self.setups), "station_mm is nested too deeply")
        self.refused(lambda: volcal.Campaign.from_arrays(self.machine, [], noise=ring), "constant_um is nested too deeply")

    def test_lists_and_integers_are_converted(self) -> None:
        readings = self.readings(2)
        readings["dir_x"] = [int(value) for value in np.asarray(readings["dir_x"])]
        readings["line"] = np.asarray(readings["line"]).astype(np.int16)
        readings["y_mm"] = np.repeat(np.asarray(readings["y_mm"]), 2)[::2]
        campaign = volcal.Campaign.from_arrays(self.machine, self.setups)
        for column in ("dir_x", "line", "y_mm"):
            np.testing.assert_array_equal(campaign.setups[2][column], self.files.setups[2][column])

    def test_a_machine_of_text(self) -> None:
        machine = volcal.Machine.parse(self.machine.to_toml())
        self.assertEqual(machine.tools, self.machine.tools)
        error = self.refused(lambda: volcal.Machine.parse("format = 1", "mine.toml"), "mine.toml:1")
        self.assertEqual(error.line, 1)


if __name__ == "__main__":
    unittest.main()
