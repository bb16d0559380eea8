#!/usr/bin/python3
"""What the manual generates from the program is what the program says now; its links lead somewhere.

usage: manual_test.py PATH-OF-MASTIC MAN-PAGE
"""
import re
import subprocess
import sys
import unittest
from pathlib import Path

MAN_PAGE, MASTIC = Path(sys.argv.pop()), sys.argv.pop()
ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def said(*words):
    return subprocess.run([MASTIC, *words], capture_output=True, text=True, check=True).stdout


class Manual(unittest.TestCase):
    maxDiff = 2000

    def test_reference_of_keys_is_up_to_date(self):
        self.assertEqual((DOCS / "keys.md").read_text(), said("keys"),
                         "make it anew: build/bin/mastic keys > docs/keys.md")

    def test_every_key_of_a_new_scene_is_in_the_reference(self):
        reference = (DOCS / "keys.md").read_text()
        for key in re.findall(r"^ *set ([^=]+?) *=", said("new", "creep"), re.M):
            self.assertIn(f"| `{key}` |", reference)

    def test_man_page_names_every_verb(self):
        if not MAN_PAGE.exists():
            self.skipTest("help2man was not there when the program was built")
        page, verbs = MAN_PAGE.read_text(), said("--help").split("Subcommands:")[1]
        names = re.findall(r"^  ([a-z]+) ", verbs, re.M)
        self.assertGreater(len(names), 12)
        for name in names:
            self.assertRegex(page, rf"(?m)^{name}$")
        for section in ("EXAMPLES", "FILES", '"EXIT STATUS"'):
            self.assertIn(f".SH {section}", page)

    def test_links_lead_to_files(self):
        for page in [ROOT / "README.md", *DOCS.glob("*.md"), ROOT / "bench/README.md"]:
            for link in re.findall(r"\]\(([^)#\s]+)", page.read_text()):
                if "://" not in link:
                    self.assertTrue((page.parent / link).exists(), f"{page.name}: {link}")

    def test_scenes_that_are_named_exist(self):
        for page in [ROOT / "README.md", *DOCS.glob("*.md")]:
            for name in re.findall(r"(?<![\w/.-])scenes/[\w./-]+?\.(?:scene|inc|csv|law)", page.read_text()):
                self.assertTrue((ROOT / name).exists(), f"{page.name}: {name}")


if __name__ == "__main__":
    unittest.main()
