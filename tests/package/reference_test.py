#!/usr/bin/env python3
"""Manual pages and completions, as the program writes them, against its table of commands and the help of every command.

  reference_test.py PROGRAM

Pages are checked by `man --warnings` and `mandoc -Tlint`, completions by `bash -n`, `zsh -n`, `fish -n`, where these are
installed; that every command, option and word to choose is in each of them, always.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)


def output_of(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}: {done.stderr}{done.stdout}")
    return done.stdout


def all_commands(command):
    yield command
    for sub in command["commands"]:
        yield from all_commands(sub)


def names_of(option):
    return [name for name in option["names"] if name.startswith("-")]


def shown(page):
    """Text of a page without its markup."""
    for escape, character in ((r"\-", "-"), (r"\(aq", "'"), (r"\(dq", '"'), (r"\(ga", "`"), (r"\(ha", "^"), (r"\(ti", "~"),
                              (r"\|", ""), (r"\&", ""), (r"\e", "\\")):
        page = page.replace(escape, character)
    return re.sub(r"\\f[BIR]", "", page)


class Reference(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name) / "reference"
        output_of(PROGRAM, "help", "-o", str(cls.folder))
        cls.table = json.loads(output_of(PROGRAM, "help", "--json"))
        cls.commands = list(all_commands(cls.table))

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def page_of(self, command):
        return (self.folder / (command["name"].replace(" ", "-") + ".1")).read_text(encoding="utf-8")

    def test_table_has_what_every_help_shows(self):
        self.assertGreater(len(self.commands), 20)
        for command in self.commands:
            words = command["name"].split()[1:]
            text = output_of(PROGRAM, *words, "--help")
            self.assertEqual(text, output_of(PROGRAM, "help", *words), command["name"])
            before_examples = text.split("\nExamples:\n")[0]
            named = re.findall(r"^  (-[-\w,]+)(?= |$)", before_examples, re.M)
            self.assertEqual(sorted(name for names in named for name in names.split(",")),
                             sorted(name for option in command["options"] for name in names_of(option)), command["name"])
            listed = before_examples.split("\nSubcommands:\n")[1] if "\nSubcommands:\n" in before_examples else ""
            self.assertEqual(re.findall(r"^  ([a-z-]+) ", listed, re.M),
                             [sub["name"].split()[-1] for sub in command["commands"]])
            operands = re.findall(r"^  ([A-Z]+) ", before_examples, re.M)
            self.assertEqual(operands, [operand["names"][0] for operand in command["operands"]])

    def test_table_knows_choices_and_kinds_of_values(self):
        options = {name: option for command in self.commands if command["name"] == "volcal fit"
                   for option in command["options"] for name in names_of(option)}
        self.assertEqual(options["--noise"]["choices"], ["auto", "white"])
        self.assertEqual((options["-o"]["value"], options["-o"]["required"]), ("TEXT", True))
        self.assertEqual(options["--threads"]["limits"], "NONNEGATIVE")
        self.assertNotIn("value", options["--json"])
        self.assertFalse(options["--noise"]["repeated"])

    def test_a_page_for_every_command_with_every_option(self):
        self.assertEqual(sorted(path.name for path in self.folder.glob("*.1")),
                         sorted(command["name"].replace(" ", "-") + ".1" for command in self.commands))
        for command in self.commands:
            page = shown(self.page_of(command))
            for word in [name for option in command["options"] for name in names_of(option)] + [
                    choice for option in command["options"] for choice in option.get("choices", [])] + [
                    line.strip() for line in command["examples"]] + [
                    sub["name"].replace(" ", "-") for sub in command["commands"]]:
                self.assertIn(word, page, command["name"])
            for option in command["options"] + command["operands"]:
                self.assertIn(option["help"].split(". ")[-1], page, command["name"])

    def test_pages_are_clean_for_man(self):
        if shutil.which("man") is None:
            self.skipTest("man is not installed")
        for path in sorted(self.folder.glob("*.1")):
            done = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(path)],
                                  capture_output=True, text=True, env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})
            self.assertEqual((done.returncode, done.stderr), (0, ""), path.name)

    def test_pages_are_clean_for_mandoc(self):
        if shutil.which("mandoc") is None:
            self.skipTest("mandoc is not installed")
        pages = map(str, sorted(self.folder.glob("*.1")))
        done = subprocess.run(["mandoc", "-Tlint", "-Wwarning", *pages], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, ""))

    def test_completions_are_of_their_shell(self):
        for shell, name in (("bash", "volcal.bash"), ("zsh", "_volcal"), ("fish", "volcal.fish")):
            self.assertEqual((self.folder / name).read_text(encoding="utf-8"), output_of(PROGRAM, "help", "--completion", shell))
            if shutil.which(shell) is not None:
                self.assertEqual(output_of(shell, "-n", str(self.folder / name)), "")

    def test_every_option_is_in_every_completion(self):
        texts = {name: (self.folder / name).read_text(encoding="utf-8") for name in ("volcal.bash", "_volcal", "volcal.fish")}
        bash = dict(re.findall(r'^        "([a-z -]*)"\)\n            options="([^"]*)"', texts["volcal.bash"], re.M))
        zsh = dict(re.findall(r"^_(volcal\w*)\(\) \{\n(.*?)^\}$", texts["_volcal"], re.M | re.S))
        for command in self.commands:
            path = " ".join(command["name"].split()[1:])
            names = [name for option in command["options"] for name in names_of(option)]
            self.assertEqual(bash[path].split(), names)
            function = zsh[re.sub(r"\W", "_", command["name"])]
            fish = [line for line in texts["volcal.fish"].splitlines() if f'= "{path}"\'' in line]
            for option in command["options"]:
                for name in names_of(option):
                    self.assertRegex(function, re.escape(name) + r"\[", path)
                    flag = f" -l {name[2:]} " if name.startswith("--") else f" -s {name[1:]} "
                    self.assertTrue(any(flag in line for line in fish), (path, name))
                for choice in option.get("choices", []):
                    self.assertIn(choice, function)
                    self.assertTrue(any(re.search(rf"[' ]{re.escape(choice)}[' ]", line) for line in fish), choice)
            for sub in command["commands"]:
                word = sub["name"].split()[-1]
                self.assertIn(f"'{word}:", function)
                self.assertTrue(any(f" -a {word} " in line for line in fish))

    def completed_by_bash(self, *words):
        """What Tab offers behind the words, the last of which is being written."""
        script = f"source {self.folder}/volcal.bash; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _volcal; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        return output_of("bash", "--norc", "-c", script, "bash", "volcal", *words, cwd=self.folder).split()

    def test_bash_completes(self):
        self.assertEqual(self.completed_by_bash("mon"), ["montecarlo"])
        self.assertEqual(self.completed_by_bash("fit", "--noise", ""), ["auto", "white"])
        self.assertEqual(self.completed_by_bash("fit", "--noise", "=", "w"), ["white"])
        self.assertEqual(self.completed_by_bash("fit", "--thr"), ["--threads"])
        self.assertEqual(self.completed_by_bash("fit", "--threads", ""), [])
        self.assertEqual(self.completed_by_bash("study", "pl"), ["planning"])
        self.assertEqual(self.completed_by_bash("study", "planning", "--rea"), ["--readings"])
        self.assertEqual(self.completed_by_bash("fit", "volcal.b"), ["volcal.bash"])
        self.assertEqual(self.completed_by_bash("fit", "-o", "volcal.f"), ["volcal.fish"])
        self.assertIn("sinumerik", self.completed_by_bash("tables", "--format", "s"))

    def test_fish_completes(self):
        if shutil.which("fish") is None:
            self.skipTest("fish is not installed")

        def completed(line):
            script = f"source {self.folder}/volcal.fish; complete -C '{line}'"
            environment = {**os.environ, "HOME": str(self.folder), "XDG_CONFIG_HOME": str(self.folder)}
            return [each.split("\t")[0] for each in output_of("fish", "-N", "-c", script, env=environment, cwd=self.folder).splitlines()]

        self.assertEqual(completed("volcal mon"), ["montecarlo"])
        self.assertEqual(completed("volcal fit --noise "), ["auto", "white"])
        self.assertEqual(completed("volcal study planning --rea"), ["--readings"])
        self.assertEqual(completed("volcal study pl"), ["planning"])

    def test_unknown_commands_are_refused(self):
        for words, problem in ((["fitt"], 'no command "fitt"'), (["study", "plan"], 'no command "study plan"'),
                               (["fit", "x"], 'no command "fit x"')):
            done = subprocess.run([PROGRAM, "help", *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(problem, done.stderr)


if __name__ == "__main__":
    unittest.main()
