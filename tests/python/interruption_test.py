"""Progress, Ctrl-C, and what the interpreter does meanwhile."""

import os
import signal
import threading
import time
import unittest

import volcal
from support import HIDDEN, Case, coarse


class LongWork(Case):
    def setUp(self) -> None:
        super().setUp()
        self.campaign = volcal.read_campaign(HIDDEN / "21" / "campaign.toml")

    def test_progress_is_told(self) -> None:
        told: list[tuple[str, float]] = []
        result = volcal.fit(self.campaign, coarse(self.campaign), progress=lambda stage, done: told.append((stage, done)))
        self.assertEqual(told[0], ("nuisance parameters on the nominal machine", 0.0))
        self.assertIn("scans of the residuals", [stage for stage, _ in told])
        self.assertTrue(all(0.0 <= done <= 1.0 for _, done in told))
        volcal.montecarlo(self.campaign, result, draws=200, refits=0, grid=0, path="linear",
                          progress=lambda stage, done: told.append((stage, done)))
        self.assertEqual(told[-1][1], 1.0)

    def test_what_progress_raises_ends_the_work(self) -> None:
        def stop(stage: str, done: float) -> None:
            if done > 0.0:
                raise StopIteration(stage)

        with self.assertRaises(StopIteration):
            volcal.fit(self.campaign, progress=stop)
        with self.assertRaises(StopIteration):
            volcal.diagnose(self.campaign, progress=stop)

    def test_ctrl_c_ends_the_work(self) -> None:
        def press(stage: str, done: float) -> None:
            if stage == "rank analysis":
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            volcal.fit(self.campaign, progress=press)

    def test_ctrl_c_from_outside(self) -> None:
        timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            volcal.fit(self.campaign)
        timer.join()

    def test_other_threads_run_meanwhile(self) -> None:
        counted, running = [0], [True]

        def count() -> None:
            while running[0]:
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        volcal.fit(self.campaign, screening=False, noise="white")
        running[0] = False
        thread.join()
        self.assertGreater(counted[0], 20)


if __name__ == "__main__":
    unittest.main()
