#!/usr/bin/env python3
"""Two scales: what volumes at the points of a body cost, as whole commands.

`--overhead`: the specimen on a fine mesh while nothing breaks, law only against adaptive.
`--tests`: creep at 400 and 600 kPa bond by bond (events), on two scales, and by the law only.
`--band`: a bar pulled apart on meshes of 20, 10 and 6.7 mm, three seeds: peak, and work after it.
Without options the first two. The parts of it, a breakage and a thousand live points, are those of
build/bin/bench_volumes.
"""
import argparse
import csv
import pathlib
import statistics
import subprocess
import sys
import time

from report import OtherPrograms, machine, print_table, spread, today

repository = pathlib.Path(__file__).resolve().parent.parent
scenes = repository / "scenes"
quiet = ["Output/Plots = false", "Output/ParaView = false"]


def run(options, scene, settings, folder):
    """Wall seconds and what was said."""
    words = [word for each in [*settings, *quiet, f"Output/Folder = {folder}"]
             for word in ("--set", each)]
    begin = time.perf_counter()
    done = subprocess.run([options.mastic, "run", str(scene), "--quiet", "--threads",
                           str(options.threads), *words], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode not in (0, 5):  # 5: ruptured
        sys.exit(f"exit {done.returncode}: {done.stdout}")
    return time.perf_counter() - begin, done.stdout


def rows_of(folder, file="history.csv"):
    with open(folder / file) as table:
        return list(csv.DictReader(table))


def overhead(options):
    """Law only and adaptive in turn; nothing breaks."""
    fine = ["Continuum/Order = 2", "Body/Cell size = 8 mm", "Strength/Distribution = Weibull",
            "Strength/Modulus = 50", "Strength/Scale = 1e6 N", "Strength/Rate exponent = 0"]
    kinds = ("law only", "adaptive")
    times = {kind: [] for kind in kinds}
    others = OtherPrograms()
    for _ in range(options.repeat):
        for kind in kinds:
            seconds, _ = run(options, scenes / "fe2" / "creep-400.scene",
                             [*fine, f"Body/Material = {kind}"],
                             options.kept / f"overhead-{kind.replace(' ', '-')}")
            times[kind].append(seconds)
    ratios = [b / a for a, b in zip(times["law only"], times["adaptive"])]
    last = [rows_of(options.kept / f"overhead-{kind.replace(' ', '-')}")[-1] for kind in kinds]
    strains = [float(row["axial_strain_percent"]) for row in last]
    print_table(["specimen, order 2, cells of 8 mm", "wall s", "strain at the end %"],
                [[kind, spread(times[kind]), f"{strain:.10g}"]
                 for kind, strain in zip(kinds, strains)])
    print(f"adaptive over law only: median ratio {statistics.median(ratios):.3f}; others "
          f"{others.processors():.2f}; strains differ by {abs(strains[1] / strains[0] - 1):.1e}\n")


def tests(options):
    """Creep three ways."""
    table = []
    for stress in (400, 600):
        for name, scene, settings in (
                ("bond by bond", scenes / "creep" / f"creep-{stress}.scene", []),
                ("two scales", scenes / "fe2" / f"creep-{stress}.scene", []),
                ("law only", scenes / "fe2" / f"creep-{stress}.scene",
                 ["Body/Material = law only"])):
            others = OtherPrograms()
            folder = options.kept / f"creep-{stress}-{name.replace(' ', '-')}"
            seconds, said = run(options, scene, settings, folder)
            history = rows_of(folder)
            at = {t: min(history, key=lambda row: abs(float(row["time_s"]) - t))
                  for t in (1, 100, 1000)}
            ended = [line.strip() for line in said.splitlines() if "ended" in line]
            table.append([stress, name, f"{seconds:.0f}", f"{others.processors():.1f}",
                          *(f"{float(row['axial_strain_percent']):.3f}" for row in at.values()),
                          f"{float(history[-1]['time_s']):.5g}", history[-1]["broken_bonds"],
                          "; ".join(ended)])
    print_table(["kPa", "how", "wall s", "others", "strain near 1 s %", "100 s", "1000 s",
                 "last time s", "broken", "end"], table)


def band(options):
    """Softening over meshes."""
    table = []
    for seed in (1, 2, 3):
        for cells in (20, 10, 6.7) if seed == 1 else (20, 10):
            folder = options.kept / f"band-{seed}-{cells}"
            run(options, scenes / "fe2" / "band.scene",
                [f"Body/Cell size = {cells} mm", f"Specimen/Seed = {seed}",
                 f"Strength/Seed = {seed}"], folder)
            history = rows_of(folder)
            strain = [-float(row["axial_strain_percent"]) / 100 for row in history]
            stress = [-float(row["axial_stress_kPa"]) * 1e3 for row in history]
            peak = stress.index(max(stress))
            work = [0.08 * (strain[k] - strain[k - 1]) * (stress[k] + stress[k - 1]) / 2
                    for k in range(1, len(strain))]  # [J/m^2], the bar is 80 mm long
            table.append([seed, cells, f"{stress[peak] / 1e3:.0f}", f"{100 * strain[peak]:.2f}",
                          f"{sum(work[:peak]):.0f}", f"{sum(work[peak:]):.0f}"])
    print_table(["seed", "cells mm", "peak kPa", "at %", "work before J/m^2", "after"], table)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mastic", default=str(repository / "build" / "bin" / "mastic"))
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--overhead", action="store_true")
    parser.add_argument("--tests", action="store_true")
    parser.add_argument("--band", action="store_true")
    parser.add_argument("--kept", type=pathlib.Path,
                        default=repository / "build" / "bench-kept" / "fe2")
    options = parser.parse_args()
    options.kept.mkdir(parents=True, exist_ok=True)
    print(f"{machine()}; {options.threads} threads; {today()}")
    all_of_it = not (options.overhead or options.tests or options.band)
    if options.overhead or all_of_it:
        overhead(options)
    if options.tests or all_of_it:
        tests(options)
    if options.band:
        band(options)


if __name__ == "__main__":
    main()
