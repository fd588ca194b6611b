"""A session in Python against the command line."""

import json
import unittest

import numpy as np

import volcal
from support import HIDDEN, Case, run_program

CAMPAIGN = HIDDEN / "21" / "campaign.toml"
REVERSAL = "reversal:EXX:dir_x:step"


class Session(Case):
    session: volcal.Session

    @classmethod
    def setUpClass(cls) -> None:
        cls.session = volcal.Session(volcal.read_campaign(CAMPAIGN))

    def test_the_error_falls_as_on_the_command_line(self) -> None:
        session = self.session
        before = session.residual()
        first = session.rank()[0]
        self.assertEqual(first.name, REVERSAL)
        preview = session.preview(first)
        self.assertEqual(preview["residual"].shape, before.shape)
        added = session.add(first)
        self.assertEqual((added.number, added.parent, added.standing), (1, 0, "preview"))
        np.testing.assert_allclose(session.residual(), preview["residual"], atol=1e-9)
        stages: list[str] = []
        confirmed = session.confirm(progress=lambda stage, done: stages.append(stage))
        self.assertGreater(len(stages), 3)
        self.assertLess(confirmed.figures.systematic, session.models[0].figures.systematic)
        self.assertIn("reversal", "".join(session.model().effects))
        told = json.loads(run_program("session", CAMPAIGN, "--json", "--do", "add " + REVERSAL, "--do", "confirm"))
        for own, other in zip(session.models, told["models"], strict=True):
            self.assertEqual(own.figures.systematic * 1e6, other["figures"]["systematic_um"])
            self.assertEqual(own.figures.rms_heldout * 1e6, other["figures"]["rms_heldout_um"])
        self.assertNotEqual(confirmed.standing, "preview")
        self.assertEqual(confirmed.standing, told["models"][1]["standing"])
        amplitude = told["models"][1]["effects"][0]["amplitudes"][0]
        own_amplitude = confirmed.effects[0].amplitudes[0]
        self.assertEqual(own_amplitude["value"] * (1.0 / own_amplitude["si_per_unit"]), amplitude["value"])
        self.assertTrue(session.undo())
        self.assertEqual(session.current.number, 0)
        self.assertFalse(session.undo())
        self.assertTrue(session.redo())

    def test_what_is_no_command_is_refused(self) -> None:
        self.refused(lambda: self.session.do("jump"), "jump", "commands are")
        self.refused(lambda: self.session.do("add reversal:EQQ:dir_q:step"), "EQQ")
        with self.assertRaises(IndexError):
            self.session.residual(99)


if __name__ == "__main__":
    unittest.main()
