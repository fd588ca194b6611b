#!/usr/bin/env python3
"""The Debian package, from scripts/package to its removal.

  package_test.py BUILD     (BUILD: a build folder with the program and the module built)

It is unpacked into a folder and run from there. With VOLCAL_LONG_TESTS=1, as root, where what it depends on is installed
and no volcal is, it is installed into the system by dpkg and removed again.
"""
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = sys.argv.pop(1)
CAMPAIGN = ROOT / "datasets/demo/campaign/campaign.toml"
LINKED = """#include <volcal/identify/io/campaign/machine_reader.h>
#include <iostream>
int main(int, char** argv) { std::cout << volcal::read_machine(argv[1]).axes.size() << " axes\\n"; }
"""


def output_of(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}: {done.stderr}{done.stdout}")
    return done.stdout


def installed_packages():
    listed = output_of("dpkg-query", "-W", "-f", "${Package} ${db:Status-Status}\n")
    return {line.split()[0] for line in listed.splitlines() if line.endswith(" installed")}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        built = output_of(ROOT / "scripts/package", "--built", BUILD, "-o", cls.folder)
        cls.package = pathlib.Path(built.strip())
        cls.fields = dict(line.split(": ", 1) for line in output_of("dpkg-deb", "-f", cls.package).splitlines()
                          if re.match(r"\w[\w-]*: ", line))
        wanted = {re.split(r"[ :]", each)[0] for each in re.split(r", | \| ", cls.fields["Depends"])}
        cls.by_dpkg = (bool(os.environ.get("VOLCAL_LONG_TESTS")) and os.geteuid() == 0
                       and wanted <= installed_packages() and "volcal" not in installed_packages())
        if cls.by_dpkg:
            output_of("dpkg", "-i", cls.package)
            cls.root = pathlib.Path("/")
        else:
            cls.root = cls.folder / "root"
            output_of("dpkg-deb", "-x", cls.package, cls.root)
        print("installed by dpkg" if cls.by_dpkg else f"unpacked into {cls.root}")

    @classmethod
    def tearDownClass(cls):
        if cls.by_dpkg:
            output_of("dpkg", "-P", "volcal")
        cls.scratch.cleanup()
        left = [path for path in ("/usr/bin/volcal", "/usr/share/doc/volcal", "/usr/include/volcal") if os.path.exists(path)]
        if cls.by_dpkg and left:
            raise AssertionError(f"left behind: {left}")

    def at(self, path):
        return self.root / path

    def test_depends_on_what_it_is_linked_with(self):
        for name in ("libc6", "libcholmod3", "libmuparser2v5", "libzip4", "python3", "python3-numpy"):
            self.assertRegex(self.fields["Depends"], rf"(^|, ){re.escape(name)}( |,|$)")

    def test_has_copyright_changelog_and_bill_of_materials(self):
        documents = self.at("usr/share/doc/volcal")
        self.assertIn("Apache-2.0", (documents / "copyright").read_text(encoding="utf-8"))
        with gzip.open(documents / "changelog.Debian.gz", "rt") as file:
            self.assertIn(f"volcal ({self.fields['Version']})", file.readline())
        with gzip.open(documents / "changelog.gz", "rt") as file:
            self.assertIn("# Changelog", file.readline())
        self.assertEqual(json.loads((documents / "volcal.spdx.json").read_text(encoding="utf-8"))["spdxVersion"], "SPDX-2.3")

    def test_program_fits_the_demo(self):
        program = self.at("usr/bin/volcal")
        self.assertEqual(output_of(program, "--version").strip(), self.fields["Version"].split("-")[0])
        said = output_of(program, "fit", CAMPAIGN, "-o", self.folder / "result", env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        self.assertIn("written: ", said)
        self.assertTrue((self.folder / "result/error_tables.csv").exists())

    def test_pages_are_read_by_man(self):
        pages = sorted(self.at("usr/share/man/man1").glob("volcal*.1.gz"))
        self.assertGreater(len(pages), 20)
        if shutil.which("man"):
            said = output_of("man", "-l", self.at("usr/share/man/man1/volcal-fit.1.gz"), env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "80"})
            self.assertIn("--keep-stated-sigma", re.sub(".\b", "", said).replace("\u2010", "-"))

    def test_completions_are_where_shells_look(self):
        for path in ("bash-completion/completions/volcal", "zsh/vendor-completions/_volcal", "fish/vendor_completions.d/volcal.fish"):
            self.assertTrue(self.at("usr/share") .joinpath(path).exists(), path)

    def test_module_is_imported(self):
        code = "import volcal; print(volcal.__file__, volcal.__version__)"
        environment = dict(os.environ)
        environment.pop("PYTHONPATH", None)
        if not self.by_dpkg:
            environment["PYTHONPATH"] = str(next(self.at("usr/lib").glob("python3*/dist-packages")))
        said = output_of("/usr/bin/python3", "-B", "-c", code, env=environment, cwd=self.folder)
        self.assertTrue(said.startswith(str(self.at("usr/lib/python3"))), said)

    def test_a_program_is_linked_by_pkg_config(self):
        (self.folder / "linked.cpp").write_text(LINKED, encoding="utf-8")
        environment = {**os.environ, "PKG_CONFIG_PATH": str(self.at("usr/lib/pkgconfig")), "PKG_CONFIG_ALLOW_SYSTEM_LIBS": "1"}
        flags = output_of("pkg-config", "--cflags", "--libs", "volcal", env=environment).split()
        output_of("g++", "-std=c++20", self.folder / "linked.cpp", *flags, "-o", self.folder / "linked")
        self.assertEqual(output_of(self.folder / "linked", ROOT / "datasets/demo/machine.toml"), "3 axes\n")


if __name__ == "__main__":
    missing = [name for name in ("dpkg-deb", "dpkg-shlibdeps", "cpack", "pkg-config") if not shutil.which(name)]
    if missing:
        print(f"skipped: {', '.join(missing)}: not installed (scripts/install-dependencies package)")
        sys.exit(77)
    unittest.main()
