#!/usr/bin/env python3
"""How sure is a rupture time, and what moves it? One constant at a time.

Each estimated or fitted constant of `scenes/rupture/creep-1000.scene` takes two values on either
side of that of the scene, everything else (packing, draws of the strengths) as it is. The
yardstick is the scatter over seeds of the strengths. Prints a Markdown table and writes
`rupture-sensitivity.csv`; runs that have finished are kept, so that it may be interrupted.
`--stress 600 --stress 1000` runs more than one stress.
"""
import argparse
import csv
import os
import pathlib
import re
import statistics
import subprocess
import sys
import time

from report import machine

repository = pathlib.Path(__file__).resolve().parent.parent
scene = repository / "scenes" / "rupture" / "creep-1000.scene"
constants = [  # name, key, value of the scene, two below, two above
    ("shear over tensile strength", "Strength/Shear to normal ratio", "0.3",
     ["0.2", "0.25", "0.35", "0.4"]),
    ("friction", "Bonds/Friction", "0.3", ["0.1", "0.2", "0.4", "0.5"]),
    ("rate window, share of the time", "Strength/Rate window fraction", "0.01",
     ["0.002", "0.005", "0.02", "0.05"]),
    ("rate window at least", "Strength/Rate window", "1 s", ["0.25 s", "0.5 s", "2 s", "4 s"]),
    ("rate exponent", "Strength/Rate exponent", "0.325", ["0.275", "0.3", "0.35", "0.375"]),
    ("radius multiplier λ", "Bonds/Radius multiplier", "1", ["0.5", "0.75", "1.25", "1.5"]),
    ("K_m", "Bonds/Maxwell stiffness", "3.2e6 N/m",
     ["1.6e6 N/m", "2.4e6 N/m", "4.8e6 N/m", "6.4e6 N/m"]),
    ("C_m", "Bonds/Maxwell viscosity", "8.2e8 N s/m",
     ["4.1e8 N s/m", "6.15e8 N s/m", "1.23e9 N s/m", "1.64e9 N s/m"]),
    ("K_k", "Bonds/Kelvin stiffness", "5e5 N/m",
     ["2.5e5 N/m", "3.75e5 N/m", "7.5e5 N/m", "1e6 N/m"]),
    ("C_k", "Bonds/Kelvin viscosity", "8.4e6 N s/m",
     ["4.2e6 N s/m", "6.3e6 N s/m", "1.26e7 N s/m", "1.68e7 N s/m"]),
]
weibull = ["Strength/Distribution = Weibull", "Strength/Modulus = 1.1", "Strength/Scale = 60 N"]


def runs(seeds):
    """Group, value and settings of each run; the scene as it is comes first."""
    yield "as it is", "", []
    for seed in range(2, seeds + 1):
        yield "seed of the strengths", str(seed), [f"Strength/Seed = {seed}"]
    yield "law of the strengths", "Weibull(1.1, 60 N)", weibull
    for name, key, _, values in constants:
        for value in values:
            yield name, value, [f"{key} = {value}"]


def outcome(mastic, packing, folder, settings):
    """How a run ended: what it printed, kept in its folder."""
    kept = folder / "outcome.txt"
    if kept.exists():
        return kept.read_text()
    words = [word for each in [*settings, "Output/ParaView = false", "Output/Plots = false",
                               f"Output/Folder = {folder}"] for word in ("--set", each)]
    command = [mastic, "run", str(scene), "--threads", "1", "--quiet", "--packing", str(packing)]
    begin = time.perf_counter()
    done = subprocess.run([*command, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode not in (0, 5):  # 5: ruptured
        sys.exit(f"exit {done.returncode}: {done.stdout.strip().splitlines()[-1:]}")
    text = done.stdout + f"wall {time.perf_counter() - begin:.1f} s\n"
    kept.write_text(text)
    return text


def read(text, folder):
    """Rupture time or none, strain at its begin or at the end, bonds broken then, wall seconds."""
    ruptured = re.search(r"rupture at t = ([\d.e+-]+) s", text)
    with open(folder / "history.csv") as file:
        rows = list(csv.DictReader(file))
    last = rows[-2 if ruptured else -1]  # the last row is that of the rupture itself
    return {"rupture_s": float(ruptured[1]) if ruptured else None,
            "end_s": float(rows[-1]["time_s"]),
            "strain_percent": float(last["axial_strain_percent"]),
            "broken": int(last["broken_bonds"]),
            "wall_s": float(re.search(r"^wall ([\d.]+) s", text, re.M)[1])}


def shown(result, base):
    """Rupture time and its change, or where the run stood at its end."""
    if result["rupture_s"] is None:
        return f"none ({result['strain_percent']:.3g} % at {result['end_s']:.4g} s)"
    ratio = f" (x {result['rupture_s'] / base:.2f})" if base else ""
    return f"{result['rupture_s']:.3g} s{ratio}"


def yardstick(results):
    """Mean and standard deviation of rupture times over the seeds, as one line."""
    times = [r["rupture_s"] for group, _, r in results
             if group in ("as it is", "seed of the strengths") and r["rupture_s"] is not None]
    n = sum(group in ("as it is", "seed of the strengths") for group, _, _ in results)
    if len(times) < 2:
        return f"{len(times)} of {n} seeds rupture"
    return (f"{len(times)} of {n} seeds rupture, at {min(times):.3g} to {max(times):.3g} s, "
            f"mean {statistics.mean(times):.3g} s, "
            f"standard deviation {statistics.stdev(times):.2g} s")


def print_markdown(stress, results):
    base = results[0][2]["rupture_s"]
    print(f"\n{stress} kPa: {shown(results[0][2], None)}; {yardstick(results)}\n")
    print("| constant | of the scene | much less | less | more | much more |")
    print("|---|---|---|---|---|---|")
    for name, _, own, values in constants:
        found = {value: r for group, value, r in results if group == name}
        cells = [f"{value}: {shown(found[value], base)}" for value in values]
        print(f"| {name} | {own} | " + " | ".join(cells) + " |")
    for group, value, r in results:
        if group == "law of the strengths":
            print(f"\n{value} instead of normal(54, 44) N: {shown(r, base)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mastic", default=str(repository / "build" / "bin" / "mastic"))
    parser.add_argument("--stress", type=int, action="append", help="kPa; default: 1000")
    parser.add_argument("--seeds", type=int, default=5, help="of the strengths")
    parser.add_argument("--kept", type=pathlib.Path,
                        default=repository / "build" / "bench-kept" / "sensitivity")
    options = parser.parse_args()
    options.kept.mkdir(parents=True, exist_ok=True)
    packing = options.kept / "1500.packing.h5"
    if not packing.exists():
        subprocess.run([options.mastic, "pack", str(scene), "-o", str(packing)], check=True,
                       stdout=subprocess.DEVNULL)
    print(f"{machine()}; one thread; 1500 spheres, {scene.name}")
    rows, seconds = [], 0
    for stress in options.stress or [1000]:
        results = []
        for k, (group, value, settings) in enumerate(runs(options.seeds)):
            folder = options.kept / f"{stress}-{k:02}"
            text = outcome(options.mastic, packing, folder,
                           [f"Loading/Axial stress = {stress} kPa", *settings])
            results.append((group, value, read(text, folder)))
            print(f"{stress} kPa, {group} {value}: {shown(results[-1][2], None)}", file=sys.stderr)
            rows.append({"stress_kPa": stress, "changed": group, "value": value, **results[-1][2]})
            seconds += results[-1][2]["wall_s"]
        print_markdown(stress, results)
    with open(options.kept / "rupture-sensitivity.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    print(f"\n{len(rows)} runs, {seconds:.0f} s in all; {options.kept}/rupture-sensitivity.csv")


if __name__ == "__main__":
    main()
