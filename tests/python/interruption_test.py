"""Progress, Ctrl-C, and what the interpreter does meanwhile."""

import os
import signal
import threading
import time
import unittest
from collections.abc import Callable

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
        shares = [done for _, done in told]
        self.assertEqual(shares, sorted(shares))
        self.assertEqual(told[-1], ("done", 1.0))
        self.assertEqual(sum(share == 1.0 for share in shares), 1)
        volcal.montecarlo(self.campaign, result, draws=200, refits=0, grid=0, path="linear",
                          progress=lambda stage, done: told.append((stage, done)))
        self.assertEqual(told[-1][1], 1.0)

    def test_progress_does_not_go_back(self) -> None:
        shares: list[float] = []
        model = coarse(self.campaign)
        result = volcal.fit(self.campaign, model, noise="white", screening=False)

        def tell(stage: str, done: float) -> None:
            shares.append(done)

        works: list[Callable[[], object]] = [
            lambda: volcal.diagnose(self.campaign, model, progress=tell),
            lambda: volcal.montecarlo(self.campaign, result, digits=1, refits=0, grid=0, path="linear", progress=tell)]
        for work in works:
            shares.clear()
            work()
            self.assertGreater(len(shares), 2)
            self.assertEqual(shares, sorted(shares))

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

    def test_ctrl_c_ends_every_long_work(self) -> None:
        """Each is interrupted when it tells progress for the second time; what raises is KeyboardInterrupt."""
        model = coarse(self.campaign)
        result = volcal.fit(self.campaign, model, noise="white", screening=False)
        session = volcal.Session(self.campaign, model)
        calls = [0]

        def press(stage: str, done: float) -> None:
            calls[0] += 1
            if calls[0] == 2:
                os.kill(os.getpid(), signal.SIGINT)

        works: dict[str, Callable[[], object]] = {
            "diagnose": lambda: volcal.diagnose(self.campaign, model, progress=press),
            "montecarlo": lambda: volcal.montecarlo(self.campaign, result, draws=100000, refits=0, grid=0, path="linear",
                                                    progress=press),
            "plan": lambda: volcal.plan(self.campaign.machine, model, readings=64, stations=2, progress=press),
            "compare": lambda: volcal.compare(self.campaign, [result], held_out=True, progress=press),
            "try_effect": lambda: volcal.try_effect(self.campaign, "EXX: dir_x / 2", model, progress=press),
            "Session": lambda: volcal.Session(self.campaign, model, progress=press),
            "Session.do": lambda: session.do("climb", progress=press),
        }
        for name, work in works.items():
            with self.subTest(name):
                calls[0] = 0
                with self.assertRaises(KeyboardInterrupt):
                    work()
                self.assertGreaterEqual(calls[0], 2)
        self.assertEqual(session.current.number, 0)

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
