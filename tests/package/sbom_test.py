#!/usr/bin/env python3
"""The bill of materials has what SPDX 2.3 requires, and every library that the program is linked with.

  sbom_test.py BUILD
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
RELATIONS = {"DESCRIBES", "DYNAMIC_LINK", "STATIC_LINK", "CONTAINS"}
EXPRESSION = re.compile(r"NOASSERTION|[A-Za-z0-9.-]+( (AND|OR) [A-Za-z0-9.-]+)*")


class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        made = subprocess.run([str(ROOT / "scripts/sbom"), str(BUILD)], capture_output=True, text=True)
        if made.returncode != 0:
            raise AssertionError(made.stderr)
        cls.document = json.loads(made.stdout)
        cls.packages = {package["name"]: package for package in cls.document["packages"]}

    def related(self, kind):
        ids = {package["SPDXID"]: package["name"] for package in self.document["packages"]}
        return {ids[each["relatedSpdxElement"]] for each in self.document["relationships"] if each["relationshipType"] == kind}

    def test_document_has_its_required_fields(self):
        document = self.document
        self.assertEqual((document["spdxVersion"], document["dataLicense"], document["SPDXID"]),
                         ("SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT"))
        self.assertRegex(document["name"], r"^volcal-\d")
        self.assertRegex(document["documentNamespace"], r"^https://[^#\s]+$")
        self.assertRegex(document["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        for creator in document["creationInfo"]["creators"]:
            self.assertRegex(creator, r"^(Person|Organization|Tool): \S")

    def test_packages_have_their_required_fields(self):
        ids = [package["SPDXID"] for package in self.document["packages"]]
        self.assertEqual(len(ids), len(set(ids)))
        for package in self.document["packages"]:
            self.assertRegex(package["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertTrue(package["name"] and package["downloadLocation"] and package["versionInfo"])
            self.assertIs(package["filesAnalyzed"], False)
            for key in ("licenseConcluded", "licenseDeclared"):
                self.assertTrue(EXPRESSION.fullmatch(package[key]), package)
            for reference in package.get("externalRefs", []):
                self.assertEqual((reference["referenceCategory"], reference["referenceType"]), ("PACKAGE-MANAGER", "purl"))
                self.assertRegex(reference["referenceLocator"], r"^pkg:(deb/debian|npm)/[^@\s]+@\S+$")
            for checksum in package.get("checksums", []):
                self.assertEqual((checksum["algorithm"], len(checksum["checksumValue"])), ("SHA512", 128))

    def test_relations_are_between_what_is_there(self):
        ids = {package["SPDXID"] for package in self.document["packages"]} | {"SPDXRef-DOCUMENT"}
        for relation in self.document["relationships"]:
            self.assertIn(relation["relationshipType"], RELATIONS)
            self.assertLessEqual({relation["spdxElementId"], relation["relatedSpdxElement"]}, ids)
        self.assertEqual(self.related("DESCRIBES"), {"volcal"})

    def test_what_is_linked_compiled_in_and_bundled_is_there(self):
        for name in ("libc6", "libstdc++6", "libcholmod3", "libmuparser2v5", "libzip4"):
            self.assertIn(name, self.related("DYNAMIC_LINK"))
        for name in ("libceres-dev", "libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev", "librandom123-dev", "libfast-float-dev"):
            self.assertIn(name, self.related("STATIC_LINK"))
        if (BUILD / "report/report.html").exists():
            self.assertLessEqual({"plotly.js-gl3d-dist-min", "preact"}, self.related("CONTAINS"))
        self.assertNotIn("esbuild", self.packages)
        self.assertEqual(self.packages["preact"]["licenseDeclared"], "MIT")
        self.assertEqual(self.packages["volcal"]["licenseConcluded"], "GPL-3.0-or-later")


if __name__ == "__main__":
    if shutil.which("dpkg") is None:
        print("skipped: dpkg is not installed")
        sys.exit(77)
    unittest.main()
