#!/usr/bin/env python3
"""Axial stiffness, Poisson's ratio and bonds inside a cylindrical specimen.

    mastic run SCENE --set "Solver = linear" --set "Strength/Distribution = none"
    bench/specimen_local.py MASTIC RESULT...

From the tables of particles and bonds at 0 s: straight lines through the displacements of the spheres, and
M = sum of squared branch lengths over volume, which carries the bonds into the estimates of the stiffness.
"""

import argparse
import csv
import math
import subprocess

AXES = ("x_mm", "y_mm", "z_mm")


def table(mastic, result, name):
    command = [mastic, "export", result, name, "--time", "0 s"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(text.splitlines())]


def slope(x, y):
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def report(mastic, result, diameter, height, stress, share):
    with open(result + "/history.csv") as file:
        platens = float(next(csv.DictReader(file))["elastic_modulus_MPa"])
    particles = table(mastic, result, "particles")
    middle = [p for p in particles if abs(p["z_mm"] - height / 2) < height * share / 2]
    strain = {c: slope([p[c + "_mm"] for p in middle], [p[f"u{c}_mm"] for p in middle]) for c in "xyz"}
    print(f"{result}: E over the platens {platens:.1f} MPa; "
          f"in the middle {share:g} of the height {-stress / strain['z']:.1f} MPa, "
          f"Poisson's ratio {-(strain['x'] + strain['y']) / 2 / strain['z']:.3f}")

    branches = []
    for bond in table(mastic, result, "bonds"):
        a, b = (particles[int(bond[k])] for k in ("first_particle", "second_particle"))
        branches.append([(a[c] + b[c]) / 2 for c in AXES] + [b[c] - a[c] for c in AXES])
    radius = diameter / 2
    parts = (("all", 0, radius, height / 2),
             ("within 2/3 of the radius", 0, radius * 2 / 3, height / 3),
             ("outer sixth of the radius", radius * 5 / 6, radius, height / 3))
    for name, inner, outer, half in parts:
        taken = [b for b in branches
                 if inner <= math.hypot(b[0], b[1]) <= outer and abs(b[2] - height / 2) <= half]
        squares = sum(x * x + y * y + z * z for *_, x, y, z in taken)
        volume = math.pi * (outer**2 - inner**2) * 2 * half
        print(f"  bonds {name}: {len(taken)}, M = {1e3 * squares / volume:.0f} /m, "
              f"along the axis {sum(b[5] ** 2 for b in taken) / squares:.3f} of it")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mastic")
    parser.add_argument("results", nargs="+")
    parser.add_argument("--diameter", type=float, default=60.2, help="mm")
    parser.add_argument("--height", type=float, default=120.3, help="mm")
    parser.add_argument("--stress", type=float, default=0.4, help="MPa")
    parser.add_argument("--middle", type=float, default=0.5, help="share of the height that counts as the middle")
    arguments = parser.parse_args()
    for each in arguments.results:
        report(arguments.mastic, each, arguments.diameter, arguments.height, arguments.stress, arguments.middle)
