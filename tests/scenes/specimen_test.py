#!/usr/bin/python3
"""The specimen of 6000 spheres as users run it: packing, solvers that must agree, seeds.

usage: specimen_test.py PATH-OF-MASTIC
"""
import csv
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

MASTIC = sys.argv.pop(1)
ROOT = Path(__file__).resolve().parents[2]
SCENE = str(ROOT / "scenes/creep/creep-400.scene")
FOLDER = Path(tempfile.mkdtemp())
PACKING = FOLDER / "packing.h5"


def mastic(*words):
    done = subprocess.run([MASTIC, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{words}: {done.stdout}{done.stderr}")
    return done.stdout


def history(name, *settings, scene=SCENE):
    words = ["run", scene, "--quiet", "--packing", PACKING]
    for setting in (*settings, f"Output/Folder = {FOLDER / name}", "Output/Plots = false",
                    "Output/ParaView = false"):
        words += ["--set", setting]
    mastic(*words)
    return [{key: float(cell or "nan") for key, cell in row.items()}
            for row in csv.DictReader((FOLDER / name / "history.csv").read_text().splitlines())]


class Specimen(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.report = mastic("pack", SCENE, "-o", PACKING)

    def number(self, pattern):
        return float(re.search(pattern, self.report)[1])

    def test_packing_meets_what_was_asked(self):
        self.assertAlmostEqual(self.number(r"solid fraction +([\d.]+)"), 0.7, delta=1e-4)
        self.assertIn("16500, 5.50 at each", self.report)
        self.assertEqual(self.number(r"particles under 4 contacts +(\d+)"), 0)
        self.assertLess(self.number(r"residual isotropic stress +([\d.]+)"), 30)

    def test_intact_specimen_is_the_same_to_linear_and_events(self):
        intact = "Strength/Distribution = none", "Output/History times = 20"
        linear = history("linear", "Solver = linear", *intact)
        events = history("events", "Solver = events", *intact)
        self.assertEqual(len(linear), len(events))
        for a, b in zip(linear, events):
            self.assertLessEqual(abs(a["axial_strain_percent"] - b["axial_strain_percent"]),
                                 1e-12 * a["axial_strain_percent"])

    def test_strain_and_breakages_grow_with_stress(self):
        ends = [history(f"s{s}", f"Loading/Axial stress = {s} kPa", "Loading/End time = 5 s")[-1]
                for s in (400, 500, 600)]
        for low, high in zip(ends, ends[1:]):
            self.assertLess(low["axial_strain_percent"], high["axial_strain_percent"])
            self.assertLess(low["broken_bonds"], high["broken_bonds"])

    def test_strength_seed_changes_little_and_only_what_it_must(self):
        a, b = (history(f"seed{s}", f"Strength/Seed = {s}", "Loading/End time = 5 s")[-1]
                for s in (1, 2))
        self.assertNotEqual(a["broken_bonds"], b["broken_bonds"])
        self.assertLess(abs(a["axial_strain_percent"] / b["axial_strain_percent"] - 1), 0.05)


if __name__ == "__main__":
    unittest.main()
