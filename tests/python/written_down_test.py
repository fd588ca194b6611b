"""What is written of the module: stubs, docstrings, guide and notebook."""

import ast
import inspect
import json
import os
import pathlib
import re
import subprocess
import sys
import unittest
from typing import Any

import volcal
from support import SOURCE, Case

GUIDE = SOURCE / "docs" / "guides" / "python.md"
NOTEBOOK = SOURCE / "docs" / "guides" / "find-the-missing-effect.ipynb"
PACKAGE = pathlib.Path(volcal.__file__).parent


def run_python(*arguments: str) -> None:
    """Below the folder of the package, so that mypy finds it."""
    environment = {**os.environ, "MYPYPATH": f"{PACKAGE.parent}:{SOURCE / 'tests' / 'python'}"}
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)


class Stubs(Case):
    def test_the_tests_are_typed_by_them(self) -> None:
        tests = sorted(str(path) for path in (SOURCE / "tests" / "python").glob("*.py"))
        run_python("-m", "mypy", "--strict", "--cache-dir", str(self.folder), *tests)

    def test_they_are_those_of_the_module(self) -> None:
        allowed = self.folder / "allowed.txt"
        classes = [name for name in volcal.__all__ if inspect.isclass(getattr(volcal, name)) and name != "InputError"]
        # Their metaclass is pybind11's, and so is the constructor of those that only volcal makes.
        allowed.write_text("".join(rf"volcal\.{name}(\.__init__)?" + "\n" for name in classes))
        run_python("-m", "mypy.stubtest", "volcal", "--allowlist", str(allowed), "--ignore-unused-allowlist")


class Defaults(Case):
    """What mypy cannot see: functions of C++ have no signature but the first line of their docstring."""

    def stated(self) -> list[tuple[str, str, str]]:
        """Function, argument and literal default of the stubs."""
        tree = ast.parse((PACKAGE / "__init__.pyi").read_text())
        functions = [(node.name, node) for node in tree.body if isinstance(node, ast.FunctionDef)]
        for of in tree.body:
            if isinstance(of, ast.ClassDef):
                functions += [(f"{of.name}.{node.name}", node) for node in of.body if isinstance(node, ast.FunctionDef)]
        defaults = []
        for name, node in functions:
            plain = node.args.args[len(node.args.args) - len(node.args.defaults):]
            pairs = [*zip(plain, node.args.defaults), *zip(node.args.kwonlyargs, node.args.kw_defaults)]
            defaults += [(name, argument.arg, repr(ast.literal_eval(default))) for argument, default in pairs
                         if default is not None and ast.unparse(default) != "..."]
        return defaults

    def test_they_are_those_of_the_module(self) -> None:
        stated = [each for each in self.stated() if not each[0].startswith("InputError")]
        self.assertGreater(len(stated), 60)
        for name, argument, default in stated:
            member: Any = volcal
            for part in name.split("."):
                member = getattr(member, part)
            signature = (member.__doc__ or "").splitlines()[0]
            self.assertRegex(signature, rf"\b{argument}: [^=]*= {re.escape(default)}[,)]", name)


class Docstrings(Case):
    def members(self) -> list[tuple[str, Any]]:
        members = []
        for name in volcal.__all__:
            member = getattr(volcal, name)
            if name == "__version__":
                continue
            members.append((name, member))
            if inspect.isclass(member) and not issubclass(member, Exception):
                members += [(f"{name}.{key}", value) for key, value in vars(member).items()
                            if not key.startswith("__") or key == "__getitem__"]
        return members

    def test_none_is_missing(self) -> None:
        without = [name for name, member in self.members() if not (inspect.getdoc(member) or "").strip()]
        self.assertEqual(without, [])
        self.assertGreater(len(self.members()), 100)

    def test_arrays_have_shape_and_unit(self) -> None:
        for name in ("Result.parameters", "Result.covariance", "Result.residuals", "Result.u", "MonteCarlo.u",
                     "Setup.__getitem__", "Readings.points_mm", "Result.errors_at"):
            text = inspect.getdoc(dict(self.members())[name]) or ""
            self.assertRegex(text, r"shape \((n|p|m|q|r)", name)
            self.assertRegex(text, r"SI|mm|unit", name)


class Pages(Case):
    def run_code(self, code: str, name: str) -> dict[str, Any]:
        """Runs it in a folder where the datasets are."""
        (self.folder / "datasets").symlink_to(SOURCE / "datasets")
        before = os.getcwd()
        os.chdir(self.folder)
        names: dict[str, Any] = {}
        try:
            exec(compile(code, name, "exec"), names)
        finally:
            os.chdir(before)
            for kind in list(names.get("registered", [])):
                volcal.unregister_effect(kind)
        return names

    def test_the_guide_runs(self) -> None:
        blocks = re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 4)
        names = self.run_code("\n".join(blocks), GUIDE.name)
        self.assertTrue((self.folder / "result" / "result.json").exists())
        self.assertEqual(names["result"].status, "lack_of_fit")

    def test_the_notebook_runs_and_finds_the_effect(self) -> None:
        cells = json.loads(NOTEBOOK.read_text())["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        names = self.run_code("\n".join(code), NOTEBOOK.name)
        diagnosis = names["diagnosis"]
        self.assertEqual(diagnosis.verdict, "NAMED")
        self.assertEqual([effect.name for effect in diagnosis.effects],
                         ["worn-screw:EXX:dir_x x:worn_screw"])
        self.assertLess(names["better"].sigma0, 1.05)
        for cell in cells:
            if cell["cell_type"] == "code":
                self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))


if __name__ == "__main__":
    unittest.main()
