#!/usr/bin/python3
"""Statements of the replicated paper that can be tested, beside what was measured.

usage: statements.py RESULTS    (the folder that ./run fills)

Prints a table in Markdown: statement, measured, met or not. Reads history.csv and breakages.csv of
the creep study, the strain-rate study and the two scaling runs; leaves out what is not there.
"""
import sys
from pathlib import Path

import numpy as np


def table(file):
    """Columns of a CSV file with a header, by name."""
    data = np.genfromtxt(file, delimiter=",", names=True, dtype=float)
    return {name: np.atleast_1d(data[name]) for name in data.dtype.names}


def runs(folder, unit):
    """Runs of a study by the value in their folder's name: {400.0: folder}."""
    found = {}
    for result in folder.glob("*/history.csv"):
        value = result.parent.name.split("-")[0]
        if result.parent.name.endswith(unit):
            found[float(value)] = result.parent
    return dict(sorted(found.items()))


def verdict(met):
    return "met" if met else "**not met**"


def values(numbers, form):
    return ", ".join(format(x, form) for x in numbers)


def strain_ordering(creep):
    """Strains of all runs at the last time that all reached."""
    histories = {s: table(f / "history.csv") for s, f in creep.items()}
    time = min(h["time_s"][-1] for h in histories.values())
    strain = [np.interp(time, h["time_s"], h["axial_strain_percent"]) for h in histories.values()]
    return ("strain grows with stress, more than in proportion",
            f"at {time:.0f} s: {values(strain, '.2f')} % under {values(creep, '.0f')} kPa",
            verdict(np.all(np.diff(strain) > 0)
                    and np.all(np.diff(np.array(strain) / np.array(list(creep))) > 0)))


def ruptured(folder):
    """A run that ended before its time: strain limit or lost equilibrium."""
    log = folder / "run.log"
    text = log.read_text() if log.exists() else ""
    return "strain limit" in text or "lost equilibrium" in text


def late_breakages(folder):
    """Times of the breakages after the load was applied."""
    times = table(folder / "breakages.csv")["time_s"]
    return times[times > 0]


def no_rupture_at_400(creep):
    folder = creep[400.0]
    return ("400 kPa: no rupture within 2000 s",
            "ruptured" if ruptured(folder) else "no rupture", verdict(not ruptured(folder)))


def few_breakages_at_400(creep):
    """Few: the paper gives no number; here at most one in fifty."""
    broken = table(creep[400.0] / "history.csv")["broken_bonds"][-1]
    late = len(late_breakages(creep[400.0]))
    return ("400 kPa: few bonds break (here: at most 2 % of 16500)",
            f"{late} after the load came on, {100 * late / 16500:.1f} %, "
            f"beside {broken - late:.0f} of next to no strength when it came", verdict(late <= 330))


def rupture(creep, stress):
    folder = creep[stress]
    time = table(folder / "history.csv")["time_s"][-1]
    return (f"{stress:.0f} kPa: rupture", f"rupture at {time:.0f} s" if ruptured(folder)
            else f"no rupture within {time:.0f} s", verdict(ruptured(folder)))


def most_breakages_at_rupture(creep):
    """Whether the last of twenty equal times up to rupture has the most breakages."""
    shares = []
    for folder in creep.values():
        if ruptured(folder):
            times = late_breakages(folder)
            counts, _ = np.histogram(times, bins=20, range=(0, times[-1]))
            counts[0] = 0  # the loading itself
            shares.append(np.argmax(counts) == 19)
    return ("rupture is where the rate of breakage is highest",
            f"in {sum(shares)} of {len(shares)} runs with rupture (20 equal times, the first left out)",
            verdict(shares and all(shares)))


def peak_stress_per_decade(rates):
    peaks = [table(f / "history.csv")["axial_stress_kPa"].max() for f in rates.values()]
    slope = np.polyfit(np.log10(list(rates)), np.log10(peaks), 1)[0]
    return ("peak stress grows by about 10^0.325 = 2.11 per decade of strain rate",
            f"largest stress up to 5 % strain {values(np.array(peaks) / 1e3, '.2f')} MPa at "
            f"{values(rates, 'g')} /s: 10^{slope:.3f} = {10**slope:.2f} per decade",
            verdict(abs(slope - 0.325) < 0.05))


def scaling(results):
    """Displacement with viscosities divided by 10 against the original, time axis stretched."""
    full = table(results / "scaling-1/history.csv")
    fast = table(results / "scaling-10/history.csv")
    u, v = full["mean_displacement_mm"], fast["mean_displacement_mm"]
    worst = np.max(np.abs(u - v)) / u[-1]
    return ("Fig. 4: viscosities divided by 10 give the same curve in a tenth of the time, 0.3 m",
            f"{u[-1] / 1e3:.4f} m at {full['time_s'][-1]:.0f} s, {v[-1] / 1e3:.4f} m at "
            f"{fast['time_s'][-1]:.0f} s, largest difference {worst:.0e} of it", verdict(worst < 1e-12))


def all_statements(results):
    creep, rates = runs(results / "creep", "kPa"), runs(results / "strain-rate", "s")
    if len(creep) > 1:
        yield strain_ordering(creep)
        yield most_breakages_at_rupture(creep)
    if 400.0 in creep:
        yield no_rupture_at_400(creep)
        yield few_breakages_at_400(creep)
    for stress in creep:
        if stress > 400:
            yield rupture(creep, stress)
    if len(rates) > 1:
        yield peak_stress_per_decade(rates)
    if (results / "scaling-1").is_dir() and (results / "scaling-10").is_dir():
        yield scaling(results)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rows = list(all_statements(Path(sys.argv[1])))
    if not rows:
        sys.exit(f"{sys.argv[1]}: there are no results of ./run in it")
    print("| statement | measured | |\n|---|---|---|")
    for row in rows:
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
