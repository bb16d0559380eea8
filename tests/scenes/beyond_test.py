#!/usr/bin/python3
"""The scenes of scenes/beyond on few spheres and for short times: what must hold at any size.

usage: beyond_test.py PATH-OF-MASTIC
"""
import csv
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

MASTIC = sys.argv.pop(1)
SCENES = Path(__file__).resolve().parents[2] / "scenes/beyond"
FOLDER = Path(tempfile.mkdtemp())
SMALL = ("Specimen/Particles = 200", "Specimen/Diameter = 19.36 mm", "Specimen/Height = 38.73 mm",
         "Output/History times = 12", "Output/ParaView = false", "Output/Plots = false")
SINGLE = "Study/Vary = ", "Study/Values = "


def mastic(*words, code=0):
    done = subprocess.run([MASTIC, *map(str, words)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{words}: exit code {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


def run(scene, name, *settings):
    """Runs a scene at the small size; returns the folder of its results."""
    words = ["run", SCENES / f"{scene}.scene", "--quiet", "--threads", "1"]
    for setting in (*SMALL, *settings, f"Output/Folder = {FOLDER / name}"):
        words += ["--set", setting]
    mastic(*words)
    return FOLDER / name


def column(folder, name, table="history.csv"):
    return [float(row[name] or "nan")
            for row in csv.DictReader((folder / table).read_text().splitlines())]


def shift(celsius):
    """aT of scenes/beyond/wlf.inc."""
    return 10 ** (-21.5 * (celsius - 20) / (188 + celsius - 20))


class Beyond(unittest.TestCase):
    def equal(self, found, expected, relative):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), relative * abs(b))

    def rising(self, values):
        self.assertTrue(all(a < b for a, b in zip(values, values[1:])), values)

    def test_scenes_have_neither_errors_nor_warnings(self):
        scenes = sorted(SCENES.glob("*.scene"))
        self.assertGreater(len(scenes), 5)
        for scene in scenes:
            self.assertIn("no errors, 0 warning(s)", mastic("check", scene))

    def test_intact_creep_and_modulus_follow_the_shift(self):
        at = {}
        for celsius in 20, 5, 40:
            a = shift(celsius)
            frequencies = ", ".join(f"{f / a:.17g} Hz" for f in (0.01, 0.1, 1, 10))
            at[celsius] = run("modulus", f"m{celsius}", *SINGLE,
                              f"Temperature/Temperature = {celsius} degC",
                              f"Loading/End time = {1000 * a:.17g} s",
                              f"Output/First time = {0.01 * a:.17g} s",
                              f"Output/Frequencies = {frequencies}")
        for celsius in 5, 40:
            self.equal([t / shift(celsius) for t in column(at[celsius], "time_s")],
                       column(at[20], "time_s"), 1e-12)
            self.equal(column(at[celsius], "creep_compliance_per_GPa"),
                       column(at[20], "creep_compliance_per_GPa"), 1e-9)
            for name in "complex_modulus_MPa", "phase_angle_degrees":
                self.equal(column(at[celsius], name, "complex_modulus.csv"),
                           column(at[20], name, "complex_modulus.csv"), 1e-9)

    def test_shifted_strengths_give_the_run_at_the_reference_temperature(self):
        folder = run("strengths-shifted", "shifted")  # the scene's own section Repeat
        self.assertGreater(column(folder, "broken_bonds")[-1], column(folder, "broken_bonds")[0])

    def test_warmer_specimens_creep_more(self):
        folder = run("temperature", "temperature", "Loading/End time = 50 s")
        self.rising([column(folder / f"{t}-degC", "axial_strain_percent")[-1]
                     for t in (5, 10, 20, 30, 40)])

    def test_permanent_strain_grows_with_cycles_and_stress(self):
        folder = run("flow-number", "cycles", "Loading/Cycles = 4",
                     "Study/Values = 200 kPa, 400 kPa")
        low, high = (column(folder / f"{s}-kPa", "permanent_strain_percent", "cycles.csv")
                     for s in (200, 400))
        self.assertEqual(len(low), 4)
        self.rising(low)
        self.rising(high)
        self.assertTrue(all(a < b for a, b in zip(low, high)))

    def test_confinement_lowers_strain_and_breakage(self):
        folder = run("confined-creep", "confined", "Loading/End time = 5 s")
        runs = [folder / f"{c}-kPa" for c in (200, 100, 50, 0)]
        self.rising([column(r, "axial_strain_percent")[-1] for r in runs])
        broken = [column(r, "broken_bonds")[-1] for r in runs]  # whole numbers: two may be alike
        self.assertEqual(broken, sorted(broken))
        self.assertLess(broken[0], broken[-1])

    def test_strain_of_intact_specimens_is_linear_in_the_confining_stress(self):
        folder = run("confined-creep", "intact", "Loading/End time = 5 s",
                     "Strength/Distribution = none", "Quasistatic/Geometry = small",
                     "Quasistatic/Residual tolerance = 1e-9")
        curves = [column(folder / f"{c}-kPa", "axial_strain_percent") for c in (0, 100, 200)]
        none, half, full = ([c[0], c[-1]] for c in curves)  # the error of steps shows in between
        self.equal(half, [(a + b) / 2 for a, b in zip(none, full)], 1e-8)

    def test_gradings_have_as_many_bonds_and_the_table_is_the_named_one(self):
        short = "Loading/End time = 5 s", "Loading/Axial stress = 200 kPa"
        curves = []
        for name in "sma", "fine", "coarse", "gap":
            folder = run(f"grading-{name}", name, *short)
            self.assertRegex(mastic("info", folder), r"\n *particles +200\n *bonds +550\n")
            curves.append(column(folder, "axial_strain_percent"))
        self.assertEqual(len(set(map(tuple, curves))), 4)
        named = run("grading-sma", "named", *short, "Specimen/Grading = sma10",
                    "Specimen/Grading table = ")
        self.assertEqual(column(named, "axial_strain_percent"), curves[0])


if __name__ == "__main__":
    unittest.main()
