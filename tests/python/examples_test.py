"""The campaigns of datasets/examples: result.json of the module and of the command line, byte by byte.

VOLCAL_LONG_TESTS=1: all five, else the two that differ most.
"""

import os
import unittest

import volcal
from support import SOURCE, Case, run_program, without_times

EXAMPLES = SOURCE / "datasets" / "examples"
CHOSEN = sorted(path.name for path in EXAMPLES.iterdir() if (path / "campaign.toml").exists())
if not os.environ.get("VOLCAL_LONG_TESTS"):
    CHOSEN = [name for name in CHOSEN if name in ("mixed-1", "structure-0")]


class Examples(Case):
    def test_result_json_has_the_same_bytes(self) -> None:
        self.assertGreaterEqual(len(CHOSEN), 2)
        for name in CHOSEN:
            with self.subTest(name):
                file = EXAMPLES / name / "campaign.toml"
                run_program("fit", file, "-o", self.folder / name)
                told = (self.folder / name / "result.json").read_text()
                own = volcal.fit(volcal.read_campaign(file))
                own.write(self.folder / (name + "-module"), report=False)
                self.assertEqual(without_times((self.folder / (name + "-module") / "result.json").read_text()),
                                 without_times(told))
                self.assertGreater(len(without_times(told)), 0.9 * len(told))
                for table in ("error_tables.csv", "volumetric_grid.csv", "residuals.csv"):
                    self.assertEqual((self.folder / (name + "-module") / table).read_bytes(),
                                     (self.folder / name / table).read_bytes(), table)


if __name__ == "__main__":
    unittest.main()
