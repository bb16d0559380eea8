#!/usr/bin/python3
"""The tutorials of docs/, done as a reader would: scenes are written, commands typed, and what they say is compared.

usage: tutorial_test.py PATH-OF-MASTIC

Of a page count: blocks ```scene NAME (a file to write), indented lines that begin with 'mastic' (commands; a line
'(exit code N)' before them says how they end), ```output (lines that these say, numbers within 2 %) and ```sample
(the same, any number, for what differs between machines); '...' stands for any text.
"""
import csv
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

MASTIC = Path(sys.argv.pop(1)).resolve()
ROOT = Path(__file__).resolve().parents[2]
NUMBER = r"\d+(?:\.\d+)?(?:e[+-]?\d+)?"

# Smaller than on the page, so that all of it takes a minute: beginning of a command, settings.
LESS = {
    'mastic run creep.scene --set "Solver = quasistatic"': ["Loading/End time = 20 s"],
    "mastic run study.scene": ["Study/Values = 1000 kPa; 1..3; 1..3"],
    "mastic run breaking.scene": ["Loading/End time = 5 s"],
    "mastic run split.scene": ["Loading/End strain = 0.1 %"],
}
WITH_FIGURES = ("mastic run rupture.scene", "mastic run study.scene")

# What a page says in its text: page, words, file of the results, column, row (None: the largest), factor, tolerance.
STATED = [
    ("specimen", "says 1.171 %", "intact/history.csv", "axial_strain_percent", -1, 1, 1e-3),
    ("specimen", "at once 0.087 %", "creep/history.csv", "axial_strain_percent", 0, 1, 1e-2),
    ("specimen", "0.193 %", "recovery/history.csv", "axial_strain_percent", -1, 1, 1e-2),
    ("specimen", "400 kPa / 388 MPa", "creep/history.csv", "elastic_modulus_MPa", -1, 1, 1e-2),
    ("specimen", "peak of 3.28 MPa", "rate/history.csv", "axial_stress_kPa", None, 1e-3, 0.1),
    ("specimen", "6.70 MPa at", "rate-fast/history.csv", "axial_stress_kPa", None, 1e-3, 0.1),
    ("law", "| 50 kPa | 0.0661 % | 0.0760 %", "predict/50-kPa/history.csv", "axial_strain_percent", -1, 1, 0.02),
    ("law", "| 200 kPa | 0.2643 % | 0.356 %", "predict/200-kPa/history.csv", "axial_strain_percent", -1, 1, 0.02),
    ("continuum", "275.6 MPa", "smooth/history.csv", "elastic_modulus_MPa", -1, 1, 1e-4),
    ("continuum", "2.152 %", "coarse/history.csv", "axial_strain_percent", -1, 1, 1e-3),
]


def parts(page):
    """('file', name, text), ('run', command, exit codes) and (output or sample, lines) in the order of the page."""
    lines, code, number = page.splitlines(), None, 0
    while number < len(lines):
        line = lines[number]
        number += 1
        if line.startswith("```"):
            end = lines.index("```", number)
            kind, *name = line[3:].split()
            text, number, code = lines[number:end], end + 1, None
            yield ("file", name[0], "\n".join(text) + "\n") if kind == "scene" else (kind, text)
        elif line.startswith("    mastic "):
            yield "run", line.strip(), (0, 5) if code is None else (code,)
        elif line.strip():
            said = re.fullmatch(r"\(exit code (\d+)\)", line)
            code = int(said[1]) if said else None


def agrees(expected, line, tolerance):
    """If a line says what is expected; numbers within a tolerance, any number if there is none."""
    words = re.split(f"({NUMBER})", " ".join(expected.split()))
    pattern = "".join(f"({NUMBER})" if i % 2 else re.escape(word).replace(r"\.\.\.", ".*")
                      for i, word in enumerate(words))
    for found in re.finditer(pattern, " ".join(line.split())):
        pairs = zip(map(float, words[1::2]), map(float, found.groups()))
        if tolerance is None or all(abs(a - b) <= tolerance * abs(a) for a, b in pairs):
            return True
    return False


class Reader:
    """Somebody with an empty folder and the scenes of the program."""

    def __init__(self):
        self.folder = Path(tempfile.mkdtemp())
        (self.folder / "scenes").symlink_to(ROOT / "scenes")
        (self.folder / "bin").mkdir()
        (self.folder / "bin/mastic").symlink_to(MASTIC)
        self.environment = {**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"}

    def command(self, typed):
        command, *rest = typed.split(" | ")
        if command.startswith("mastic run"):
            command += " --threads 1 --quiet"
        if command.startswith("mastic extract"):
            command += " --threads 1"
        if command.startswith("mastic run") and "--resume" not in command:
            less = [] if typed in WITH_FIGURES else ["Output/Plots = false", "Output/ParaView = false"]
            less += sum((settings for begin, settings in LESS.items() if typed.startswith(begin)), [])
            command += "".join(f' --set "{setting}"' for setting in less)
        return " | ".join([command, *rest])

    def types(self, typed, codes):
        """Output of a command, which is interrupted if it is to end with exit code 4."""
        interrupt = codes == (4,)
        begun = subprocess.Popen(("exec " if interrupt else "") + self.command(typed), shell=True, cwd=self.folder,
                                 env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        said = []
        while interrupt and "preset" not in "".join(said[-1:]):
            said.append(begun.stdout.readline())
            if not said[-1]:
                break
        if interrupt:
            time.sleep(0.5)
            begun.send_signal(signal.SIGINT)
        rest, _ = begun.communicate()
        if begun.returncode not in codes:
            raise AssertionError(f"{typed}: exit code {begun.returncode}: {''.join(said)}{rest}")
        return "".join(said) + rest

    def value(self, file, column, row):
        with open(self.folder / "results" / file, newline="", encoding="utf-8") as opened:
            column = [float(line[column]) for line in csv.DictReader(opened)]
        return max(column) if row is None else column[row]


class Tutorials(unittest.TestCase):
    def follow(self, name):
        page = (ROOT / f"docs/tutorial-{name}.md").read_text(encoding="utf-8")
        reader, said, commands, before = Reader(), "", 0, None
        for kind, *what in parts(page):
            if kind == "file":
                (reader.folder / what[0]).write_text(what[1], encoding="utf-8")
            elif kind == "run":
                if what[0].startswith("mastic picture") and not shutil.which("povray"):
                    continue
                said = (said if before == "run" else "") + reader.types(*what)
                commands += 1
            elif kind in ("output", "sample"):
                for expected in what[0]:
                    self.assertTrue(any(agrees(expected, line, 0.02 if kind == "output" else None)
                                        for line in said.splitlines()),
                                    f"the page says\n{expected}\nand the program\n{said}")
            before = kind
        self.assertGreater(commands, 8)
        for where, words, file, column, row, factor, tolerance in STATED:
            if where == name:
                self.assertIn(words, " ".join(page.split()))
                stated = float(re.findall(NUMBER, words)[-1])
                found = factor * reader.value(file, column, row)
                self.assertLessEqual(abs(found - stated), tolerance * stated, (words, found))
        shutil.rmtree(reader.folder)
        return page

    def test_specimen(self):
        self.follow("specimen")

    def test_law(self):
        self.follow("law")

    def test_continuum(self):
        self.follow("continuum")

    def test_pictures_and_pages_that_are_named_are_there(self):
        for file in sorted((ROOT / "docs").glob("*.md")):
            for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", file.read_text(encoding="utf-8")):
                self.assertTrue((file.parent / target).exists(), f"{file.name} names {target}")


if __name__ == "__main__":
    unittest.main()
