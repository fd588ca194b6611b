"""check-names must accept the real tree and find what two files of a target define twice."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def check(root):
    return subprocess.run([sys.executable, ROOT / "scripts" / "check-names", root], capture_output=True, text=True,
                          check=False)


def unnamed(line):
    return f"namespace volcal {{\nnamespace {{\n\n{line}\n\n}}  // namespace\n}}  // namespace volcal\n"


class CheckNames(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def twice(self, first, second, second_path="tests/model/b_test.cpp"):
        self.write("tests/model/a_test.cpp", unnamed(first))
        self.write(second_path, unnamed(second))
        return check(self.root)

    def test_real_tree_passes(self):
        done = check(ROOT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_types_constants_and_functions_twice(self):
        for line, name in (("struct Case {", "Case"), ("enum class Kind : int {", "Kind"),
                           ("constexpr double kStep = 0.1;", "kStep"), ("const int kSizes[3] = {1, 2, 3};", "kSizes"),
                           ("std::string name_of(const Case& one, int count = 2) {", "name_of(const Case&, int)")):
            done = self.twice(line, line)
            self.assertEqual(done.returncode, 1, line)
            self.assertIn(f"tests/model/b_test.cpp:4: {name} also stands in tests/model/a_test.cpp:4", done.stdout)

    def test_a_constant_inside_a_function_of_the_name_of_one_outside(self):
        inside = "void act() {\n  constexpr double kStep = 1e-4;\n}"
        for first, second, found in ((inside, "constexpr double kStep = 0.1;", "a_test.cpp:5"),
                                     ("constexpr double kStep = 0.1;", inside, "b_test.cpp:5")):
            done = self.twice(first, second)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(f"{found}: kStep also stands in", done.stdout)
        self.assertEqual(self.twice(inside, inside.replace("act", "rest")).returncode, 0)

    def test_other_parameters_targets_and_equal_aliases_pass(self):
        for first, second, path in (("int size_of(int x) {", "int size_of(double x) {", "tests/model/b_test.cpp"),
                                    ("struct Case {", "struct Case {", "tests/io/b_test.cpp"),
                                    ("using Json = nlohmann::json;", "using Json = nlohmann::json;",
                                     "tests/model/b_test.cpp")):
            done = self.twice(first, second, path)
            self.assertEqual(done.returncode, 0, done.stdout)
            (self.root / path).unlink()

    def test_another_alias_of_one_name(self):
        done = self.twice("using Json = nlohmann::json;", "using Json = nlohmann::ordered_json;")
        self.assertEqual(done.returncode, 1)


if __name__ == "__main__":
    unittest.main()
