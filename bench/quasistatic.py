#!/usr/bin/env python3
"""Speed against error of the quasi-static solver: 6000 spheres to rupture, on one thread.

Runs the scenes `scenes/rupture/full-size.scene` (creep at 1000 kPa) and the same specimen at a
constant strain rate of 0.005 /s to 5 %, and compares each with its own refined answer: steps and
error tolerance ten times smaller, one breakage after the other. The refined answers take half an
hour and more than an hour and are kept; `--refined` makes them. `--batch` and `--spheres 1500` try the same elsewhere.
"""
import argparse
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import time

from report import OtherPrograms, machine, print_table, spread, today

repository = pathlib.Path(__file__).resolve().parent.parent
scene = repository / "scenes" / "rupture" / "full-size.scene"
cases = {
    "creep": [],
    "rate": ["Loading/Test = constant rate", "Loading/Strain rate = 0.005 1/s",
             "Loading/End strain = 5 %"],
}
sizes = {
    6000: [],
    1500: ["Specimen/Diameter = 37.9 mm", "Specimen/Height = 75.8 mm", "Specimen/Particles = 1500"],
}
refined = ["Quasistatic/Strain per step = 1e-4", "Quasistatic/Error tolerance = 5e-4",
           "Quasistatic/Breakage batch = 1"]
quiet = ["Output/ParaView = false", "Output/Plots = false"]


def with_settings(settings):
    return [word for each in settings for word in ("--set", each)]


def run(mastic, settings, packing, folder):
    """Wall seconds, processor seconds and the line of statistics of one run."""
    command = [mastic, "run", str(scene), "--threads", "1", "--quiet", "--packing", str(packing),
               *with_settings([*settings, *quiet, f"Output/Folder = {folder}"])]
    begin = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               env={**os.environ, "OMP_NUM_THREADS": "1"})
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 5):  # 5: ruptured
        sys.exit(f"exit {process.returncode}: {text.strip().splitlines()[-1:]}")
    lines = [line.strip() for line in text.splitlines()
             if line.startswith("  ended") or " unknowns, " in line]
    return seconds, usage.ru_utime + usage.ru_stime, lines


def history(folder):
    """Columns of a history as lists of numbers."""
    with open(folder / "history.csv") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) if row[name] else None for row in rows] for name in rows[0]}


def value_at(times, values, time):
    """Linear between rows; nothing beyond the last."""
    for k in range(1, len(times)):
        if times[k - 1] <= time <= times[k]:
            share = (time - times[k - 1]) / (times[k] - times[k - 1] or 1)
            return values[k - 1] + share * (values[k] - values[k - 1])
    return None


def compare(kind, ours, best):
    """What differs from the refined answer, as one text."""
    column = "axial_strain_percent" if kind == "creep" else "axial_stress_kPa"
    ends = ours["time_s"][-2], best["time_s"][-2]  # the last row is that of the rupture itself
    rows = [(t, value, value_at(best["time_s"], best[column], t))
            for t, value in zip(ours["time_s"], ours[column]) if t <= min(ends)]
    rows = [row for row in rows if row[2]]
    scale = max(abs(b) for _, _, b in rows)
    errors = [(t, 100 * abs(a - b) / (abs(b) if kind == "creep" else scale)) for t, a, b in rows]

    def said(until):
        part = [error for t, error in errors if t <= until]
        return (f"{max(part):.2g} % at most, {statistics.median(part):.2g} % in the median up to "
                f"{until:.4g} s")

    peak_time = best["time_s"][best[column].index(max(best[column]))]
    early = min(ends) / 2 if kind == "creep" else peak_time
    text = f"{column.rsplit('_', 1)[0]} off by {said(early)}, by {said(min(ends))}"
    if kind == "rate":
        peaks = max(ours[column]), max(best[column])
        return text + f"; peak {peaks[0]:.5g} against {peaks[1]:.5g} kPa"
    return text + f"; ends at {ours['time_s'][-1]:.5g} s against {best['time_s'][-1]:.5g} s"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mastic", default=str(repository / "build" / "bin" / "mastic"))
    parser.add_argument("--case", choices=cases, action="append", help="default: both")
    parser.add_argument("--spheres", type=int, choices=sizes, default=6000)
    parser.add_argument("--batch", type=int, nargs="*", default=[128], help="values of the batch")
    parser.add_argument("--repeat", type=int, default=1, help="medians of so many runs")
    parser.add_argument("--refined", action="store_true", help="make the refined answers")
    parser.add_argument("--kept", type=pathlib.Path, default=repository / "build" / "bench-kept",
                        help="folder for packing and answers")
    options = parser.parse_args()
    options.kept.mkdir(parents=True, exist_ok=True)
    size = sizes[options.spheres]
    packing = options.kept / f"{options.spheres}.packing.h5"
    if not packing.exists():
        subprocess.run([options.mastic, "pack", str(scene), "-o", str(packing),
                        *with_settings(size)], check=True, stdout=subprocess.DEVNULL)
    print(f"{machine()}; one thread; {today()}")
    rows = []
    for kind in options.case or list(cases):
        reference = options.kept / f"{kind}-{options.spheres}-refined"
        if options.refined and not (reference / "history.csv").exists():
            seconds, _, lines = run(options.mastic, [*size, *cases[kind], *refined], packing,
                                    reference)
            print(f"refined {kind}: {seconds:.0f} s; " + "; ".join(lines))
        for batch in options.batch:
            folder = options.kept / f"{kind}-{options.spheres}-{batch}"
            others, times, used = OtherPrograms(), [], []
            for _ in range(options.repeat):
                seconds, processor, lines = run(
                    options.mastic,
                    [*size, *cases[kind], f"Quasistatic/Breakage batch = {batch}"], packing, folder)
                times.append(seconds)
                used.append(processor)
            error = "no refined answer is kept"
            if (reference / "history.csv").exists():
                error = compare(kind, history(folder), history(reference))
            print(f"{kind}, batch {batch}: " + "; ".join(lines))
            rows.append([kind, batch, spread(times), spread(used), f"{others.processors():.2f}",
                         error])
    print_table(["case", "batch", "wall s", "processor s", "others", "against the refined answer"],
                rows)


if __name__ == "__main__":
    main()
