#!/usr/bin/python3
"""The scenes of scenes/small against their closed forms, through the program as users run it.

usage: small_scenes_test.py PATH-OF-MASTIC
"""
import csv
import json
import subprocess
import sys
import tempfile
import unittest
from math import exp, pi
from pathlib import Path

MASTIC = sys.argv.pop(1)
ROOT = Path(__file__).resolve().parents[2]


def numbers(file):
    """Rows of a CSV file; empty cells are not-a-number."""
    return [{key: float(cell or "nan") for key, cell in row.items()}
            for row in csv.DictReader(file.read_text().splitlines())]


def run(scene, *settings, code=0):
    """Runs a scene; returns the tables history and breakages as lists of {column: number}."""
    folder = folder_of(scene, *settings, code=code)
    return [numbers(folder / table) for table in ("history.csv", "breakages.csv")]


def folder_of(scene, *settings, code=0):
    """Runs a scene or a study; returns the folder of its results."""
    folder = Path(tempfile.mkdtemp())
    command = [MASTIC, "run", str(ROOT / "scenes/small" / scene), "--quiet"]
    for setting in (*settings, f"Output/Folder = {folder}", "Output/Plots = false"):
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"exit code {done.returncode}: {done.stdout}{done.stderr}")
    return folder


def compliance(t):
    """J(t) of scenes/small/bonds.inc [m/N]."""
    return 1e-6 + t / 1.6e8 + (1 - exp(-t * 8e5 / 2.4e7)) / 8e5


class SmallScenes(unittest.TestCase):
    def close(self, found, expected, relative):
        self.assertLessEqual(abs(found - expected), relative * abs(expected), (found, expected))

    def test_tip_of_the_chain_follows_the_closed_form(self):
        for solver in "linear", "events":
            history, _ = run("chain.scene", f"Solver = {solver}")
            self.assertEqual(history[-1]["time_s"], 2000)
            for row in history:
                self.close(row["mean_displacement_mm"], 1e3 * 5430 * 0.01 * compliance(row["time_s"]),
                           1e-10)

    def test_lattice_creeps_and_recovers_by_superposition(self):
        history, _ = run("lattice.scene")  # gauge length: nine layers of 4 mm
        area = pi * (18.05e-3 / 2) ** 2
        for row in history:
            t = row["time_s"]
            j = compliance(t) - (compliance(t - 500) if t >= 500 else 0)
            strain = 100e3 * area * 8 / 16 * j / 36e-3
            self.assertLessEqual(abs(row["axial_strain_percent"] / 100 - strain), 1e-12)
        self.assertTrue(any(row["axial_stress_kPa"] == 0 for row in history))

    def test_block_pulses_superpose(self):
        for solver in "linear", "events":
            history, _ = run("../cyclic/block-pulses.scene", f"Solver = {solver}")
            force = 100e3 * pi * (18.05e-3 / 2) ** 2
            for row in history:
                t, load = row["time_s"], row["axial_stress_kPa"]
                terms = [(2.0 * k, 2.0 * k + 1) for k in range(100)]
                on = lambda start: t > start or (t == start and load > 50)
                off = lambda end: t > end or (t == end and load < 50)
                j = 0.02 * compliance(t)
                j += 0.98 * sum(compliance(t - a) for a, _ in terms if on(a))
                j -= 0.98 * sum(compliance(t - b) for _, b in terms if off(b))
                strain = force * 8 / 16 * j / 36e-3
                self.assertLessEqual(abs(row["axial_strain_percent"] / 100 - strain),
                                     1e-12 + 1e-10 * strain, t)
            self.assertEqual(history[-1]["time_s"], 200)

    def test_bundle_breaks_at_the_times_of_the_table(self):
        _, breakages = run("bundle.scene", code=5)
        cases = json.loads((ROOT / "tests/reference/bundle_cascade.json").read_text())["cases"]
        expected = cases["rupture_1.05"]["events"]
        self.assertEqual([b["bond"] for b in breakages], [e["bond"] for e in expected])
        for found, event in zip(breakages, expected):
            # the scene states the stress with ten digits
            self.assertLessEqual(abs(found["time_s"] - float(event["t"])), 1e-5)

    def test_dividing_the_viscosities_by_ten_compresses_time_by_ten(self):
        folder = folder_of("../paper/scaling.scene")
        full, fast = (numbers(folder / f"{v}-N-s-m_{v}-N-s-m_{t}-s" / "history.csv")
                      for v, t in (("1e7", 2000), ("1e6", 200)))
        self.assertEqual(len(full), len(fast))
        for a, b in zip(full, fast):
            self.close(b["time_s"], a["time_s"] / 10, 1e-15) if a["time_s"] else None
            self.close(b["mean_displacement_mm"], a["mean_displacement_mm"], 1e-14)
        self.assertLess(abs(full[-1]["mean_displacement_mm"] - 299.1), 0.05)

    def test_auto_goes_over_to_finite_motion_without_a_jump(self):
        folder = Path(tempfile.mkdtemp())
        (folder / "creep.scene").write_text("""
subsection Specimen
  set Diameter = 24.4 mm
  set Height = 48.8 mm
  set Particles = 400
  set Solid fraction = 0.66
end
subsection Output
  set ParaView = false
end
""")
        ends = {}
        for solver in "events", "auto", "quasistatic":
            result = folder_of(folder / "creep.scene", f"Solver = {solver}")
            ends[solver] = numbers(result / "history.csv")[-1]["axial_strain_percent"]
            if solver == "auto":
                energy = numbers(result / "energy.csv")
                self.assertGreater(energy[0]["time_s"], 100)  # from the change on
                self.assertLess(abs(energy[-1]["gap_J"]), 1e-3 * energy[-1]["work_J"])
                times = [row["time_s"] for row in numbers(result / "breakages.csv")]
                change = min(t for t in times if t >= energy[0]["time_s"] * (1 - 1e-3))
                self.assertLess(sum(abs(t - change) < 1e-6 for t in times), 5)
        self.assertTrue(ends["quasistatic"] < ends["auto"] < ends["events"], ends)


if __name__ == "__main__":
    unittest.main()
