"""What the tests of the Python module share."""

import functools
import os
import pathlib
import subprocess
import tempfile
import unittest
from typing import Any

import numpy as np
from numpy.typing import NDArray

import volcal

SOURCE = pathlib.Path(__file__).resolve().parents[2]
HIDDEN = SOURCE / "datasets" / "hidden"
COARSE = """format = "volcal-model-1"
[functions.default]
basis = "bspline"
degree = 3
knots = 3
"""
PROGRAM = os.environ.get("VOLCAL_PROGRAM", str(SOURCE / "build" / "release" / "volcal"))


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    folder: pathlib.Path

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refused(self, what: object, *words: str) -> volcal.InputError:
        """The InputError that calling `what` raises; its text holds the words."""
        assert callable(what)
        with self.assertRaises(volcal.InputError) as caught:
            what()
        for word in words:
            self.assertIn(word, str(caught.exception))
        return caught.exception


def run_program(*arguments: object) -> str:
    """Standard output of the command line."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode > 1:
        raise AssertionError(done.stderr)
    return done.stdout


def setups_as_arrays(campaign: volcal.Campaign, folder: pathlib.Path) -> list[dict[str, object]]:
    """The setups of a campaign file with their readings by numpy, as a user has them who does without CSV files."""
    import tomllib

    with open(folder / "campaign.toml", "rb") as file:
        declared = tomllib.load(file)["setups"]
    setups = []
    for setup in declared:
        table = csv_table(folder / setup.pop("data"))
        assert table.dtype.names is not None
        setup["readings"] = {name: table[name] for name in table.dtype.names}
        setups.append(setup)
    return setups


def coarse(campaign: volcal.Campaign) -> volcal.Model:
    """A model of few parameters: a fit takes a tenth of a second."""
    return volcal.Model.parse(COARSE, campaign.machine)


@functools.cache
def white_fit(file: pathlib.Path) -> tuple[volcal.Campaign, volcal.Result]:
    """A campaign and a fit of few parameters, once for all tests of a program."""
    campaign = volcal.read_campaign(file)
    return campaign, volcal.fit(campaign, coarse(campaign), noise="white", screening=False)


class FittedCase(Case):
    """One campaign, datasets/hidden/21, with its fit, for all tests."""

    campaign: volcal.Campaign
    result: volcal.Result

    @classmethod
    def setUpClass(cls) -> None:
        cls.campaign, cls.result = white_fit(HIDDEN / "21" / "campaign.toml")


def csv_table(path: pathlib.Path) -> NDArray[np.void]:
    table: Any = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    return np.asarray(table)


def without_times(text: str) -> str:
    """result.json without what differs between two runs of one program: seconds, and how it was called."""
    lines, skipping = [], False
    for line in text.splitlines():
        if line.startswith((' "timings":', ' "provenance":')):
            skipping = True
        if not skipping:
            lines.append(line)
        if skipping and line.startswith((" ]", " }")):
            skipping = False
    return "\n".join(lines)
