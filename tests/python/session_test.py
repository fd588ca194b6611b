"""A session in Python against the command line."""

import json
import os
import signal
import threading
import unittest

import numpy as np

import volcal
from support import HIDDEN, Case, coarse, run_program

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

    def test_one_operation_at_a_time(self) -> None:
        campaign = volcal.read_campaign(CAMPAIGN)
        session = volcal.Session(campaign, coarse(campaign))
        lines = ["add " + REVERSAL, "confirm", "undo", "redo", "go 0", "refit"]
        looks: list[int] = []

        def look(stage: str, done: float) -> None:
            looks.append(len(session.models))

        def work(line: str) -> None:
            try:
                session.do(line, progress=look)
            except volcal.InputError:
                pass  # added already, nothing to undo

        threads = [threading.Thread(target=work, args=(line,)) for line in lines]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertGreater(len(looks), 0)
        for model in session.models[1:]:
            self.assertEqual((model.parent, model.change), (0, "+ reversal EXX"))
        alone = volcal.Session(campaign, coarse(campaign))
        alone.add(REVERSAL)
        alone.confirm()
        session.do("go 1")
        session.confirm()
        # By whatever way the threads have led there; the last digits keep it.
        np.testing.assert_allclose(session.residual(), alone.residual(), rtol=0.0, atol=1e-13)

    def test_ctrl_c_ends_the_wait(self) -> None:
        campaign = volcal.read_campaign(CAMPAIGN)
        session = volcal.Session(campaign, coarse(campaign))
        begun, end = threading.Event(), threading.Event()

        def hold(stage: str, done: float) -> None:
            begun.set()
            end.wait(60.0)
            raise StopIteration(stage)

        def climb() -> None:
            with self.assertRaises(StopIteration):
                session.do("climb", progress=hold)

        worker = threading.Thread(target=climb)
        worker.start()
        begun.wait(60.0)
        timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            session.models
        timer.join()
        end.set()
        worker.join()

    def test_shares_that_judge(self) -> None:
        campaign = volcal.read_campaign(CAMPAIGN)
        for share in (-1.0, 0.0, 1.0, float("nan"), 0.6):
            self.refused(lambda: volcal.Session(campaign, heldout_share=share), f"heldout_share is {share:g}", "0.01 to 0.5")

    def test_what_is_no_command_is_refused(self) -> None:
        self.refused(lambda: self.session.do("jump"), "jump", "commands are")
        self.refused(lambda: self.session.do("add reversal:EQQ:dir_q:step"), "EQQ")
        with self.assertRaises(IndexError):
            self.session.residual(99)


if __name__ == "__main__":
    unittest.main()
