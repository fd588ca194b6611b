"""`volcal export`: what NumPy and the GUM Tree Calculator read is the covariance of the fit."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
from typing import Any

import numpy as np
from numpy.typing import NDArray

import volcal
from support import COARSE, HIDDEN, PROGRAM, Case, csv_table, run_program

FOLDER = HIDDEN / "21"
GTC_VERSION = "https://measurement.govt.nz/gtc/json_1.5.0"
LEAF = re.compile(r"\(\d+, \d+\)")


class Export(Case):
    """One result, exported."""

    result: volcal.Result
    arrays: dict[str, NDArray[Any]]
    archive: dict[str, Any]

    fitted: tempfile.TemporaryDirectory[str]

    @classmethod
    def setUpClass(cls) -> None:
        cls.fitted = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.fitted.name)
        (folder / "coarse.toml").write_text(COARSE)
        run_program("fit", FOLDER / "campaign.toml", "--model", folder / "coarse.toml", "-o", folder / "result")

    @classmethod
    def tearDownClass(cls) -> None:
        cls.fitted.cleanup()

    def setUp(self) -> None:
        super().setUp()
        shutil.copytree(pathlib.Path(self.fitted.name) / "result", self.folder / "result")
        self.said = json.loads(self.exported("--json"))
        self.result = volcal.read_result(self.folder / "result")
        with np.load(self.folder / "result.npz", allow_pickle=False) as file:
            self.arrays = {name: file[name] for name in file.files}
        self.archive = json.loads((self.folder / "gtc.json").read_text(encoding="utf-8"))

    def exported(self, *more: object) -> str:
        return run_program("export", self.folder / "result", "--npz", self.folder / "result.npz", "--gtc",
                           self.folder / "gtc.json", *more)

    def si_per_unit(self) -> NDArray[np.float64]:
        layout = json.loads((self.folder / "result/result.json").read_text(encoding="utf-8"))["layout"]
        scale = np.full(layout["size"], 1e-6)
        for block in layout["blocks"]:
            scale[block["offset"]:block["offset"] + len(block["units"])] = block["si_per_unit"]
        return scale

    def test_numpy_reads_the_parameters(self) -> None:
        scale = self.si_per_unit()
        count = len(scale)
        self.assertEqual(self.arrays["covariance"].shape, (count, count))
        self.assertEqual(len(set(self.arrays["names"])), count)
        np.testing.assert_allclose(self.arrays["values"] * scale, self.result.parameters, rtol=1e-15)
        np.testing.assert_allclose(self.arrays["covariance"] * np.outer(scale, scale), self.result.covariance, rtol=1e-14)
        np.testing.assert_array_equal(self.arrays["covariance"], self.arrays["covariance"].T)
        named = dict(zip(self.arrays["names"], self.arrays["units"]))
        self.assertEqual((named["EXX 0"], named["EAX 0"], named["EC0Y"]), ("um", "urad", "urad"))
        self.assertEqual(self.said["parameters"], count)

    def test_numpy_reads_the_tables(self) -> None:
        table = csv_table(self.folder / "result/error_tables.csv")
        self.assertEqual(list(self.arrays["table_names"]), list(table["symbol"]))
        self.assertEqual(self.said["table_rows"], len(table))
        np.testing.assert_allclose(self.arrays["table_values"], table["value"], atol=1e-5)
        np.testing.assert_allclose(np.sqrt(np.diag(self.arrays["table_covariance"])), table["u"], atol=1e-5)
        at = np.isfinite(self.arrays["table_positions"])
        self.assertEqual(set(self.arrays["table_names"][~at]), {"EB0Z", "EC0Y", "EA0Z"} & set(self.arrays["table_names"]))
        self.assertEqual(set(self.arrays["table_position_units"][at]), {"mm"})
        np.testing.assert_allclose(self.arrays["table_positions"][at], table["position"][at])
        np.testing.assert_array_equal(self.arrays["table_directions"], table["direction"])
        np.testing.assert_array_equal(self.arrays["table_extrapolated"], table["extrapolated"].astype(bool))
        # Correlations of neighbours: what the diagonal alone does not say.
        covariance = self.arrays["table_covariance"]
        np.testing.assert_array_equal(covariance, covariance.T)
        self.assertGreater(np.linalg.eigvalsh(covariance).min(), -1e-9 * covariance.max())
        u = np.sqrt(np.diag(covariance))
        rows = np.flatnonzero((self.arrays["table_names"] == "EXX") & (u > 0))
        self.assertGreater(covariance[rows[-1], rows[-2]] / (u[rows[-1]] * u[rows[-2]]), 0.5)

    def elementary(self) -> dict[str, Any]:
        return {tag: number for tag, number in self.archive["tagged_real"].items() if number["CLASS"] == "ElementaryReal"}

    def gtc_covariance(self, one: dict[str, Any], other: dict[str, Any]) -> float:
        """As GTC computes it of what it reads (GTC/lib.py, std_covariance_real)."""
        leaves = self.archive["leaf_nodes"]
        alone = dict(zip(other["u_components"]["index"], other["u_components"]["value"]))
        total = sum(u * alone.get(uid, 0.0) for uid, u in zip(one["u_components"]["index"], one["u_components"]["value"]))
        for uid, u in zip(one["d_components"]["index"], one["d_components"]["value"]):
            correlation = leaves[uid]["correlation"]
            total += sum(u * correlation.get(to, 0.0) * v
                         for to, v in zip(other["d_components"]["index"], other["d_components"]["value"]))
        return float(total)

    def test_gtc_has_the_rows_of_the_tables_as_functions(self) -> None:
        rows = [number for number in self.archive["tagged_real"].values() if number["CLASS"] == "IntermediateReal"]
        covariance = self.arrays["table_covariance"]
        self.assertEqual(len(rows), len(covariance))
        self.assertEqual(len(self.archive["intermediate_uids"]), len(rows))
        np.testing.assert_array_equal([row["value"] for row in rows], self.arrays["table_values"])
        u = np.sqrt(np.maximum(0.0, np.diag(covariance)))
        for row, expected in zip(rows, u, strict=True):
            label, stated, df = self.archive["intermediate_uids"][row["uid"]]
            self.assertEqual((label, df), (row["label"], None))
            self.assertAlmostEqual(stated, expected, places=12)
        for i in range(0, len(rows), 97):
            for j in range(0, len(rows), 101):
                self.assertAlmostEqual(self.gtc_covariance(rows[i], rows[j]), covariance[i, j],
                                       delta=1e-9 * (u.max() ** 2))
        self.assertTrue(any(tag.startswith("EXX_at_minus_") for tag in self.archive["tagged_real"]))

    def test_gtc_has_every_value_with_its_correlations(self) -> None:
        leaves, numbers = self.archive["leaf_nodes"], self.elementary()
        self.assertEqual((self.archive["CLASS"], self.archive["version"]), ("Archive", GTC_VERSION))
        for key in ("tagged_complex", "untagged_real"):
            self.assertEqual(self.archive[key], {})
        self.assertEqual(len(numbers), len(self.arrays["names"]))
        order = {number["uid"]: i for i, number in enumerate(numbers.values())}
        self.assertEqual(set(order), set(leaves))
        np.testing.assert_array_equal([number["x"] for number in numbers.values()], self.arrays["values"])
        covariance = np.zeros((len(order), len(order)))
        for uid, leaf in leaves.items():
            self.assertRegex(uid, LEAF)
            self.assertEqual((leaf["CLASS"], leaf["uid"], leaf["df"]), ("LeafNode", uid, None))
            self.assertEqual("correlation" in leaf, not leaf["independent"])
            self.assertEqual("ensemble" in leaf, not leaf["independent"])
            i = order[uid]
            covariance[i, i] = leaf["u"] ** 2
            for other, r in leaf.get("correlation", {}).items():
                self.assertLessEqual(abs(r), 1.0)
                self.assertIn(other, leaf["ensemble"])
                self.assertEqual(leaves[other]["correlation"][uid], r)
                covariance[i, order[other]] = r * leaf["u"] * leaves[other]["u"]
        u = np.sqrt(np.diag(self.arrays["covariance"]))
        np.testing.assert_allclose(covariance, self.arrays["covariance"], rtol=1e-12, atol=1e-12 * u.max() ** 2)
        for tag, name, unit in zip(numbers, self.arrays["names"], self.arrays["units"]):
            self.assertRegex(tag, r"^[a-zA-Z_][a-zA-Z0-9_]*$")
            self.assertEqual(leaves[numbers[tag]["uid"]]["label"], f"{name} [{unit}]")
        self.assertIn("EXX_0", numbers)

    def test_gtc_follows_its_schema(self) -> None:
        """VOLCAL_REFERENCE_DATA: a folder that holds gtc/gtc_v_1_5_0.json of the public repository MSLNZ/GTC."""
        schema = pathlib.Path(os.environ.get("VOLCAL_REFERENCE_DATA", "")) / "gtc/gtc_v_1_5_0.json"
        if not schema.exists():
            self.skipTest("VOLCAL_REFERENCE_DATA names no folder with the schema of GTC (gtc/gtc_v_1_5_0.json)")
        try:
            import jsonschema  # type: ignore[import]
        except ImportError:
            self.skipTest("python3-jsonschema is not installed")
        jsonschema.Draft202012Validator(json.loads(schema.read_text(encoding="utf-8"))).validate(self.archive)

    def test_same_result_same_bytes(self) -> None:
        before = [(self.folder / name).read_bytes() for name in ("result.npz", "gtc.json")]
        self.exported()
        self.assertEqual(before, [(self.folder / name).read_bytes() for name in ("result.npz", "gtc.json")])

    def test_what_cannot_be_exported_is_refused(self) -> None:
        model = FOLDER.parent.parent / "demo/campaign/model.toml"
        stated = self.folder / "stated"
        run_program("align", self.folder / "result/identified.toml", "--origin", "X=0", "-o", stated)
        refusals: list[tuple[list[object], str]] = [
            ([self.folder / "result"], "--gtc FILE, --npz FILE"),
            ([stated, "--npz", self.folder / "x.npz"], "states no uncertainty"),
            ([model, "--npz", self.folder / "x.npz"], "model.toml"),
            ([self.folder / "result", "--npz", self.folder / "none/x.npz"], "cannot be written"),
            ([self.folder / "result", "--npz", self.folder / "result/result.json"], "is a file that is read"),
            ([self.folder / "result", "--npz", "same", "--gtc", "same"], "name one file"),
            ([self.folder / "result", "--npz", self.folder / "x.npz", "--tool", "none"], "none"),
        ]
        for arguments, words in refusals:
            done = subprocess.run([PROGRAM, "export", *map(str, arguments)], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""), arguments)
            self.assertIn(words, done.stderr)
        self.assertFalse((self.folder / "x.npz").exists())


if __name__ == "__main__":
    unittest.main()
