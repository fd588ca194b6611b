"""Effects of one's own, in Python."""

import threading
import unittest

import numpy as np
from numpy.typing import NDArray

import volcal
from support import HIDDEN, Case, coarse

CAMPAIGN = HIDDEN / "25" / "campaign.toml"


def thermal_reversal(readings: volcal.Readings) -> NDArray[np.float64]:
    """Lost motion that grows with the temperature."""
    return readings["dir_x"] * (readings["T_air"] - 20.0)


class OwnEffects(Case):
    def setUp(self) -> None:
        super().setUp()
        self.campaign = volcal.read_campaign(CAMPAIGN)
        self.model = coarse(self.campaign)

    def fit(self, model: volcal.Model, threads: int = 0) -> volcal.Result:
        return volcal.fit(self.campaign, model, threads=threads, noise="white", screening=False)

    def register(self, kind: str = "thermal-play", **changed: object) -> None:
        arguments: dict[str, object] = {
            "target": ["EXX", "EYY", "EQQ"][:2], "driver": thermal_reversal, "variables": ["dir_x", "T_air"], **changed}
        volcal.register_effect(kind, **arguments)  # type: ignore[arg-type]
        self.addCleanup(volcal.unregister_effect, kind)

    def test_fitted_like_the_same_expression(self) -> None:
        self.register()
        own = self.model.extend("thermal-play:EXX", self.campaign)
        self.assertIn('kind = "thermal-play"', own.effects[0])
        custom = {"kind": "custom", "target": "EXX", "expression": "dir_x * (T_air - 20)"}
        one = self.fit(own)
        other = self.fit(self.model.extend(custom, self.campaign))
        place = one.names.index("thermal-play EXX")
        self.assertEqual(place, other.names.index("EXX by dir_x * (T_air - 20)"))
        np.testing.assert_array_equal(one.parameters, other.parameters)
        self.assertGreater(abs(one.parameters[place]), 20 * one.u[place])
        one.write(self.folder / "result", report=False)
        again = volcal.read_result(self.folder / "result")
        self.assertEqual(again.model.effects, one.model.effects)
        volcal.unregister_effect("thermal-play")
        self.refused(lambda: self.fit(own), "thermal-play", "taken back")
        self.register()

    def test_threads_do_not_matter(self) -> None:
        self.register()
        own = self.model.extend("thermal-play:EXX", self.campaign)
        fits = [self.fit(own, threads) for threads in (1, 4)]
        np.testing.assert_array_equal(fits[0].parameters, fits[1].parameters)

    def test_two_fits_at_a_time(self) -> None:
        self.register()
        own = self.model.extend("thermal-play:EXX", self.campaign)
        results: list[volcal.Result] = []
        workers = [threading.Thread(target=lambda: results.append(self.fit(own)))
                   for _ in range(2)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        np.testing.assert_array_equal(results[0].parameters, results[1].parameters)

    def test_what_a_driver_sees(self) -> None:
        seen: dict[str, volcal.Readings] = {}

        def driver(readings: volcal.Readings) -> NDArray[np.float64]:
            self.assertEqual(readings.points_mm.shape, (len(readings), 3))
            self.assertEqual(readings.variables, ["x", "tool_length"])
            self.assertEqual((list(readings), "x" in readings, "y" in readings), (["x", "tool_length"], True, False))
            self.assertEqual(readings.instrument, "laser-tracer")
            self.assertEqual(len(set(readings["tool_length"])), 1)
            with self.assertRaisesRegex(KeyError, "y is not among the variables"):
                readings["y"]
            seen[readings.setup] = readings
            return np.abs(readings["x"]) / 300.0

        self.register("seen", driver=driver, target="tool z", variables=["x", "tool_length"])
        self.fit(self.model.extend("seen:tool z", self.campaign))
        self.assertEqual(sorted(seen), sorted(setup.name for setup in self.campaign.setups))
        with self.assertRaisesRegex(RuntimeError, "while the driver is called"):
            len(next(iter(seen.values())))

    def test_what_drivers_do_wrong(self) -> None:
        def refused(driver: object, *words: str) -> None:
            self.register("wrong", driver=driver, target="EXX", variables=["x"])
            model = self.model.extend("wrong:EXX", self.campaign)
            self.refused(lambda: self.fit(model), "effect wrong", *words)

        refused(lambda readings: readings["x"][:-1], "(192,)")
        refused(lambda readings: readings["x"] * np.nan, "not finite")
        refused(lambda readings: "none", "(192,)")
        refused(lambda readings: readings["x"] * 1j, "complex", "real numbers")
        refused(lambda readings: readings["x"] * 1e200, "beyond 1e+12", "scale it")

        kept: list[volcal.Readings] = []

        def raises(readings: volcal.Readings) -> NDArray[np.float64]:
            kept.append(readings)
            raise ZeroDivisionError("mine")

        self.register("wrong", driver=raises, target="EXX", variables=["x"])
        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
            self.fit(self.model.extend("wrong:EXX", self.campaign), threads=4)
        with self.assertRaisesRegex(RuntimeError, "while the driver is called"):
            kept[0]["x"]

    def test_what_is_not_recorded(self) -> None:
        self.register("hot", variables=["T_spindle"], driver=lambda readings: readings["T_spindle"])
        self.refused(lambda: self.model.extend("hot:EXX", self.campaign), "names nothing that could act here")
        hot = {"kind": "hot", "target": "EXX"}
        self.refused(lambda: self.model.extend(hot, self.campaign), "T_spindle_degC", "its driver uses T_spindle")

    def test_what_cannot_be_registered(self) -> None:
        self.refused(lambda: self.register("reversal"), "one of the library's")
        for kind in ("a:b", "", "a b", "a;b"):
            self.refused(lambda: self.register(kind), "cannot be the name of a kind", "letters, digits, - and _")
        self.refused(lambda: self.register("a", target="EQQ"), "EQQ", "not a target")
        self.refused(lambda: self.register("a", variables=["speed"]), "speed is not a variable")
        self.refused(lambda: self.register("a", variables=[]), "depends on nothing")
        self.refused(lambda: self.register("a", parameters={"depth_mm": (1.0, 2.0, 3.0)}), "depth_mm")
        self.refused(lambda: volcal.unregister_effect("reversal"), "none of your own")
        self.assertNotIn("a", volcal.effect_kinds())
        self.assertIn("reversal", volcal.effect_kinds())

    def test_a_parameter_of_the_shape(self) -> None:
        periods: set[float] = set()

        def wave(readings: volcal.Readings, *, period_mm: float) -> NDArray[np.float64]:
            periods.add(period_mm)
            return np.asarray(np.sin(2.0 * np.pi * readings["y"] / period_mm))

        self.register("wave", driver=wave, target="EBX", variables=["y"], parameters={"period_mm": (330.0, 200.0, 500.0)})
        model = self.model.extend({"kind": "wave", "target": "EBX", "period_mm": 250.0, "period_sigma_mm": 30.0})
        result = self.fit(model)
        self.assertGreater(len(periods), 1)
        self.assertIn(250.0, {round(period, 9) for period in periods})
        self.assertTrue(any("wave EBX" in name and "period" in name for name in result.names), result.names)


if __name__ == "__main__":
    unittest.main()
