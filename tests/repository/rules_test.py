#!/usr/bin/python3
"""Rules of the house that a compiler does not check: who includes whom, size and format of files."""
import re
import shutil
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KNOWS = {"dem": {"dem"}, "fem": {"fem"}, "coupling": {"coupling", "dem", "fem"},
         "apps": {"apps", "coupling", "dem", "fem"}}


def sources(*folders, ends=(".h", ".cc")):
    return [file for folder in folders for file in sorted((ROOT / folder).rglob("*"))
            if file.suffix in ends]


class Rules(unittest.TestCase):
    def test_folders_include_only_those_they_know(self):
        wrong = []
        for folder, known in KNOWS.items():
            for file in sources(folder):
                for include in re.findall(r'#include "([^"]+)"', file.read_text()):
                    if include.split("/")[0] not in known:
                        wrong.append(f"{file.relative_to(ROOT)} includes {include}")
        self.assertEqual(wrong, [])

    def test_libraries_do_not_print(self):
        wrong = [str(file.relative_to(ROOT)) for file in sources("dem", "fem", "coupling")
                 if re.search(r"std::c(out|err)|\bprintf\(|fmt::print", file.read_text())]
        self.assertEqual(wrong, [])

    def test_files_hold_one_idea(self):
        files = sources("dem", "fem", "coupling", "apps", "tests", "bench", ends=(".h", ".cc", ".py"))
        long = {str(f.relative_to(ROOT)): n for f in files
                if (n := f.read_text().count("\n")) > 450}
        self.assertEqual(long, {})

    @unittest.skipUnless(shutil.which("clang-format"), "clang-format is not installed")
    def test_sources_are_formatted(self):
        files = sources("dem", "fem", "coupling", "apps", "tests", "bench")
        done = subprocess.run(["clang-format", "--dry-run", "-Werror", *map(str, files)],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr[:2000])


if __name__ == "__main__":
    unittest.main()
