#!/usr/bin/python3
"""Writes the particle and bond tables of the hard cases, and the long lists of expected values.

usage: make_tables.py    (rewrites the tables beside it)

Expected values are computed with 50 digits (mpmath); reference tables come from tests/reference.
"""
import csv
import json
from itertools import product
from math import cos, pi, sin
from pathlib import Path

from mpmath import exp, lu_solve, matrix, mp, mpf

mp.dps = 50
HERE = Path(__file__).resolve().parent
REFERENCE = HERE.parents[1] / "tests/reference"
COLUMNS = ("ux_mm", "uy_mm", "uz_mm", "rotation_x_rad", "rotation_y_rad", "rotation_z_rad")
LOADS = ("fx_N", "fy_N", "fz_N", "mx_N_m", "my_N_m", "mz_N_m")


def table(name, header, rows):
    lines = [",".join(str(cell) for cell in row) for row in rows]
    (HERE / name).write_text("\n".join([header, *lines]) + "\n")


def include(name, section, settings, comment):
    lines = [f"# {comment} Written by make_tables.py.", f"subsection {section}"]
    for key, parts in settings.items():
        lines += [f"  set {key} = \\"] + [f"    {part}, \\" for part in parts[:-1]] + [f"    {parts[-1]}"]
    (HERE / name).write_text("\n".join(lines + ["end"]) + "\n")


def digits(x):
    return mp.nstr(mpf(x), 17)


def plain(x):
    """A length as it was typed, without the digits of its binary form."""
    return mp.nstr(mpf(x), 15)


def bonds_in_a_row(n):
    return [(i, i + 1) for i in range(n)]


# --- pairs and chains -------------------------------------------------------------------------

def pairs():
    turn = (10 * mp.pi + mpf("0.7")) / mpf("1.001e-3")  # J(100 s) of h14-law.inc
    header = "x_mm,y_mm,z_mm,r_mm,held,"
    table("pair-particles.csv", header + "fz_N", [(0, 0, 0, 2, "bottom", 0), (0, 0, 4, 2, "free", 1)])
    table("pair-bonds.csv", "a,b", [(0, 1)])
    table("hold-particles.csv", header[:-1], [(0, 0, 2, 2, "bottom"), (0, 0, 6, 2, "top")])
    table("h08-ratio-50-particles.csv", header + "fx_N",
          [(0, 0, 0, 1, "bottom", 0), (0, 0, 51, 50, "free", 0.001)])
    table("h08-ratio-100-particles.csv", header + "fx_N",
          [(0, 0, 0, 1, "bottom", 0), (0, 0, 101, 100, "free", 0.001)])
    table("h14-twist-particles.csv", header + "mz_N_m",
          [(0, 0, 0, 2, "bottom", 0), (0, 0, 4, 2, "free", digits(turn / mpf("5.5e6")))])
    table("h26-one-particles.csv", header + "fz_N", [(0, 0, 0, 2, "free", 0)])
    table("h26-no-bonds.csv", "a,b", [])
    table("h27-coincident-particles.csv", header + "fz_N",
          [(0, 0, 0, 2, "bottom", 0), (0, 0, 0, 2, "free", 1)])
    table("h27-overlapping-particles.csv", header + "fx_N",
          [(0, 0, 0, 2, "bottom", 0), (0, 0, 2.4, 1.5, "free", 1)])


def chains():
    header = "x_mm,y_mm,z_mm,r_mm,held,"
    def chain(load):
        return [(0, 0, 4 * i, 2, "free" if i else "bottom", load if i == 10 else 0) for i in range(11)]
    table("chain-particles.csv", header + "fx_N", chain(0.01))
    table("chain-bonds.csv", "a,b", bonds_in_a_row(10))
    table("h09-cut-bonds.csv", "a,b", [b for b in bonds_in_a_row(10) if b != (5, 6)])
    table("h09-pulled-particles.csv", header + "fz_N", chain(10))
    table("h09-weak-bonds.csv", "a,b,normal_strength_N",
          [(*b, 5 if b == (5, 6) else 50) for b in bonds_in_a_row(10)])
    table("h07-loose-particles.csv", header + "fx_N",
          chain(0.01) + [(50, 0, 0, 2, "free", 0), (60, 0, 0, 2, "free", 0), (64, 0, 0, 2, "free", 0)])
    table("h07-loose-bonds.csv", "a,b", bonds_in_a_row(10) + [(12, 13)])
    table("h07-squeezed-particles.csv", header[:-1],
          [(0, 0, 2, 2, "bottom"), (0.5, 0, 6, 2, "free"), (0, 0, 10, 2, "top"),
           (20, 0, 2, 2, "bottom"), (20, 0, 6, 2, "free"), (20, 0, 10, 2, "top")])
    table("h07-squeezed-bonds.csv", "a,b,normal_strength_N,shear_strength_N",
          [(0, 1, 100, 1e-6), (1, 2, 100, 1e-6), (3, 4, 100, 100), (4, 5, 100, 100)])
    turn = mpf("0.45") / mpf("1.001e-3")  # of each bond: 4.5 in all, before the ends meet
    table("h14-rolled-particles.csv", header + "my_N_m", chain(digits(turn / mpf("1e6"))))
    table("h15-bent-particles.csv", header + "fx_N", chain(1))
    table("h15-swapped-chain-bonds.csv", "a,b", [(b, a) for a, b in bonds_in_a_row(10)])


# --- bundles ----------------------------------------------------------------------------------

def bundle(name, strengths, order=None):
    """Parallel bonds between platens, in the order of a list of numbers."""
    order = order or range(len(strengths))
    particles, bonds = [], []
    for k in order:
        particles += [(8 * k, 0, 2, 2, "bottom"), (8 * k, 0, 6, 2, "top")]
        bonds.append((len(particles) - 2, len(particles) - 1, strengths[k]))
    table(f"{name}-particles.csv", "x_mm,y_mm,z_mm,r_mm,held", particles)
    table(f"{name}-bonds.csv", "a,b,normal_strength_N", bonds)


def bundles():
    reference = json.loads((REFERENCE / "bundle_cascade.json").read_text())
    bundle("bundle", [digits(s) for s in reference["strengths"]])
    for case, values in reference["cases"].items():
        (HERE / f"bundle-{case}.inc").write_text(
            f"# {case} of the reference bundle: load on 1 mm^2 (tension), events. Written by "
            "make_tables.py.\nsubsection Loading\n"
            f"  set Axial stress = -{digits(1000 * mpf(values['F_total']))} kPa\nend\n"
            "subsection Expect\n"
            f"  set Break order = {', '.join(str(e['bond']) for e in values['events'])}\n"
            f"  set Break times = {', '.join(digits(e['t']) + ' s' for e in values['events'])}\nend\n")
    strengths = [8, 8, 8, 8, 30, 30, 30, 30]
    bundle("h11-ties", strengths)
    bundle("h11-renumbered", strengths, [4, 2, 7, 0, 5, 3, 1, 6])
    spokes = [(0, 0, 0, 6, "free", -8)]
    spokes += [(8 * cos(2 * pi * k / 8 + 0.3), 8 * sin(2 * pi * k / 8 + 0.3), 0, 2, "bottom", 0)
               for k in range(8)]
    table("h11-wheel-particles.csv", "x_mm,y_mm,z_mm,r_mm,held,fz_N", spokes)
    table("h11-wheel-bonds.csv", "a,b,normal_strength_N,shear_strength_N",
          [(0, k + 1, 100, 0.5) for k in range(8)])


# --- lattice ----------------------------------------------------------------------------------

def lattice():
    sites = [(x, y, z) for z, y, x in product(range(9), range(4), range(4))]
    number = {site: k for k, site in enumerate(sites)}
    held = {0: "bottom", 8: "top"}
    table("lattice-particles.csv", "x_mm,y_mm,z_mm,r_mm,held",
          [(4 * x, 4 * y, 4 * z, 2, held.get(z, "free")) for x, y, z in sites])
    bonds = [(k, number[n]) for k, (x, y, z) in enumerate(sites)
             for n in ((x + 1, y, z), (x, y + 1, z), (x, y, z + 1)) if n in number]
    table("lattice-bonds.csv", "a,b", [(a, b) for a, b in bonds
                                       if not held.get(sites[a][2]) == held.get(sites[b][2]) != None])


# --- one Burgers element ----------------------------------------------------------------------

def creep_compliance(law, t):
    km, cm, kk, ck = map(mpf, law)
    return 1 / km + t / cm + (1 - exp(-t * kk / ck)) / kk


def compliance_integral(law, t):
    km, cm, kk, ck = map(mpf, law)
    tau = ck / kk
    return t / km + t * t / (2 * cm) + (t - tau * (1 - exp(-t / tau))) / kk


def response(law, points, t):
    """Displacement under a continuous, piecewise linear force after a first jump."""
    u = points[0][1] * creep_compliance(law, t - points[0][0])
    for (t0, f0), (t1, f1) in zip(points, points[1:]):
        if t0 >= t:
            break
        u += (f1 - f0) / (t1 - t0) * (compliance_integral(law, t - t0)
                                      - (compliance_integral(law, t - t1) if t > t1 else 0))
    return u


ASPHALT = ("1e6", "1.6e8", "8e5", "2.4e7")


def stress_history(name, points, law, comment, only=None):
    """Points (time text, force in mN) on a pair with an area of 1 mm^2: 1 kPa is 1 mN."""
    exact = [(mpf(t), mpf(f)) for t, f in points]
    values = []
    for t, _ in points:
        if only is None or t in only:
            u = response(law, [(a, f / 1000) for a, f in exact], mpf(t))
            values.append(f"axial_strain_percent at {t} s: {digits(100 * u / mpf('0.004'))}")
    include(name, "Loading", {"Test = stress history\n  set Stress history": [f"{t} s: {f} kPa" for t, f in points]},
            comment)
    with open(HERE / name, "a") as file:
        file.write("subsection Expect\n  set Values = \\\n    " + ", \\\n    ".join(values) + "\nend\n")


def histories():
    points = [("0", 1)] + [(f"3e{k}", 1 + (k % 2)) for k in range(-11, 14)]
    stress_history("h02-history.inc", points, ASPHALT, "Steps from 1e-12 to 1e12 retardation times.")
    with open(REFERENCE / "burgers_energy_history.csv") as file:
        rows = list(csv.DictReader(file))
    points = [(str(mpf(r["t"])), str(mpf(r["f"]))) for r in rows]
    include("h16-history.inc", "Loading",
            {"Test = stress history\n  set Stress history": ["0 s: 0 kPa"] + [f"{t} s: {f} kPa" for t, f in points]},
            "burgers_energy_history.csv as stresses on 1 mm^2.")
    with open(HERE / "h16-history.inc", "a") as file:  # 1 mN on 1 N/m is 1 mm: 25 % of 4 mm
        file.write("subsection Expect\n  set Values = \\\n    " + ", \\\n    ".join(
            f"axial_strain_percent at {digits(r['t'])} s: {digits(25 * mpf(r['u']))}" for r in rows) + "\nend\n")
    points = [("0", 1)] + [(str(mpf(3) * k / 10), 1) for k in range(1, 10001)]
    include("h17-history.inc", "Loading",
            {"Test = stress history\n  set Stress history": [f"{t} s:{f} kPa" for t, f in points]},
            "A constant stress said ten thousand times.")


# --- networks ---------------------------------------------------------------------------------

def solution(positions, radii, bonds, held, loads, law=1):
    """Elastic displacements and rotations of the free particles, with 50 digits."""
    free = [i for i in range(len(radii)) if i not in held]
    at = {p: 6 * k for k, p in enumerate(free)}
    stiffness, load = matrix(6 * len(free), 6 * len(free)), matrix(6 * len(free), 1)
    for a, b in bonds:
        branch = [mpf(q) - mpf(p) for p, q in zip(positions[a], positions[b])]
        length = sum(x * x for x in branch) ** mpf("0.5")
        n = [x / length for x in branch]
        arm_a = (length + mpf(radii[a]) - mpf(radii[b])) / 2
        arm_b = length - arm_a
        r = min(mpf(radii[a]), mpf(radii[b]))
        rows = []  # one row of 12 for each component of the motions at the contact
        for k in range(3):
            row = [mpf(0)] * 12
            row[k], row[6 + k] = mpf(-1), mpf(1)
            for j in range(3):
                # component k of (rotation x arm), arm_a along n and arm_b against it
                s, m = {(0, 1): (1, 2), (0, 2): (-1, 1), (1, 0): (-1, 2), (1, 2): (1, 0),
                        (2, 0): (1, 1), (2, 1): (-1, 0)}.get((k, j), (0, 0))
                row[3 + j] -= s * n[m] * arm_a
                row[9 + j] -= s * n[m] * arm_b
            rows.append(row)
        turn = [[mpf(-1) if c == 3 + k else mpf(1) if c == 9 + k else mpf(0) for c in range(12)]
                for k in range(3)]
        kn, ks, kb, kt = mpf(law), mpf(law) / 11, mpf(law) * r * r / 4, mpf(law) / 11 * r * r / 2
        for i in range(12):
            for j in range(12):
                value = mpf(0)
                for motions, along, across in ((rows, kn, ks), (turn, kt, kb)):
                    dot = sum(motions[k][i] * motions[k][j] for k in range(3))
                    axial = (sum(n[k] * motions[k][i] for k in range(3))
                             * sum(n[k] * motions[k][j] for k in range(3)))
                    value += across * dot + (along - across) * axial
                p, q = (a, b)[i // 6], (a, b)[j // 6]
                if p in at and q in at:
                    stiffness[at[p] + i % 6, at[q] + j % 6] += value
    for p, forces in loads.items():
        for k, f in enumerate(forces):
            load[at[p] + k] = mpf(f)
    u = lu_solve(stiffness, load)
    return {p: [u[at[p] + k] for k in range(6)] for p in free}


def particle_values(particle, motion, time, factor):
    return [f"particle {particle} {c} at {time} s: {digits(factor * u * (1000 if k < 3 else 1))}"
            for k, (c, u) in enumerate(zip(COLUMNS, motion))]


def network(name, positions, radii, bonds, held, loads, classes=False):
    rows = [(*(plain(1000 * mpf(x)) for x in p), plain(1000 * mpf(r)), *([i] if classes else []),
             "bottom" if i in held else "free", *loads.get(i, [0] * 6))
            for i, (p, r) in enumerate(zip(positions, radii))]
    table(f"{name}-particles.csv", "x_mm,y_mm,z_mm,r_mm," + ("class," if classes else "") + "held,"
          + ",".join(LOADS), rows)
    table(f"{name}-bonds.csv", "a,b", bonds)


def networks():
    # two large spheres with six small ones between them
    ring = [(mpf(12) / 1000, mpf(60 * k + 17 * (k % 2) + 5 * (k % 3))) for k in range(6)]
    big, small = mpf("0.1"), mpf("0.001")
    positions, radii = [(0, 0, 0)], [big]
    for distance, angle in ring:
        x, y = distance * mp.cos(angle * mp.pi / 180), distance * mp.sin(angle * mp.pi / 180)
        z = ((big + small) ** 2 - distance ** 2) ** mpf("0.5")
        positions.append((x, y, z))
        radii.append(small)
    positions.append((0, 0, 2 * positions[-1][2]))
    radii.append(big)
    positions = [tuple(mpf(plain(1000 * mpf(x))) / 1000 for x in p) for p in positions]
    bonds = [(0, k) for k in range(1, 7)] + [(k, 7) for k in range(1, 7)]
    loads = {7: [1, 0.5, -2, 0.001, 0.002, 0.003]}
    network("h08-cluster", positions, radii, bonds, {0}, loads)
    u = solution(positions, radii, bonds, {0}, loads)
    values = particle_values(7, u[7], 0, creep_compliance(ASPHALT, 0))
    values += particle_values(1, u[1], 1000, creep_compliance(ASPHALT, 1000))
    values += particle_values(7, u[7], 1000, creep_compliance(ASPHALT, 1000))
    include("h08-cluster.inc", "Expect", {"Values": values}, "Solved with 50 digits.")

    golden = json.loads((REFERENCE / "golden_network_27.json").read_text())
    ends = [(b["a"], b["b"]) for b in golden["bonds"]]
    loads = {int(k): v for k, v in golden["loads"].items()}
    network("golden", golden["positions"], golden["radii"], ends, set(golden["clamped"]), loads)
    table("h15-swapped-bonds.csv", "a,b", [(b, a) for a, b in ends])
    table("h15-renumbered-bonds.csv", "a,b", ends[::-1])
    values = []
    for p in (18, 22, 26):
        values += particle_values(p, golden["U_unit"][p], 0, creep_compliance(ASPHALT, 0))
        values += particle_values(p, golden["U_unit"][p], 300, creep_compliance(ASPHALT, 300))
    include("golden.inc", "Expect", {"Values": values}, "golden_network_27.json.")

    mixed = json.loads((REFERENCE / "golden_network_mixed.json").read_text())
    ends = [(b["a"], b["b"]) for b in mixed["bonds"]]
    loads = {int(k): v for k, v in mixed["loads"].items()}
    network("h30-mixed", mixed["positions"], mixed["radii"], ends, set(mixed["clamped"]), loads, True)
    with open(REFERENCE / "golden_network_mixed.csv") as file:
        rows = list(csv.DictReader(file))
    values = []
    for row in rows[1:-1]:
        motion = [mpf(row[f"p7_{c}"]) for c in ("ux", "uy", "uz", "rx", "ry", "rz")]
        values += particle_values(7, motion, digits(row["t"]), 1)
    include("h30-values.inc", "Expect", {"Values": values}, "golden_network_mixed.csv.")
    include("h30-laws.inc", "Bond law B", {"Classes": [f"{a}: {b}" for a, b in ends[1::2]]},
            "Every other bond has the second law.")


# --- scaling by powers of two -----------------------------------------------------------------

def scaled(k):
    """The golden network with all lengths times 2^k."""
    for name in ("golden",):
        with open(HERE / f"{name}-particles.csv") as file:
            rows = list(csv.reader(file))
        out = [[repr(float(x) * 2 ** k) for x in row[:4]] + row[4:8]
               + [repr(float(x) * 2 ** k) for x in row[8:]] for row in rows[1:]]
        table(f"h25-{name}-particles.csv", ",".join(rows[0]), out)


def main():
    pairs()
    chains()
    bundles()
    lattice()
    histories()
    networks()
    scaled(3)


if __name__ == "__main__":
    main()
