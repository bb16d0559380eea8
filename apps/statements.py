#!/usr/bin/python3
"""Statements of the replicated paper that can be tested, beside what was measured.

usage: statements.py FOLDER    (one that holds the studies creep, strain-rate and scaling)

Prints a table in Markdown: statement, measured, met or not. Every run that has a result counts; what
is not there is left out; what a study is too short for is not tested.
"""
import sys
from collections import namedtuple
from pathlib import Path

import numpy as np
from curves import power_law
from run_summary import common_time, read_runs, strain_at

Statement = namedtuple("Statement", "statement measured met")  # True, False, None: not tested

STRESS, RATE = "Loading/Axial stress", "Loading/Strain rate"
NEGLIGIBLE = 0.1  # relative standard deviation
SECONDS = 2000    # of the tests of the paper


def studies(folder):
    """Runs with a result of the studies in a folder: creep by stress, constant rates, scaling.

    Only compression is looked at, and only the first study of each kind.
    """
    found = {}
    for file in sorted(Path(folder).glob("**/runs.csv")):
        runs = [run for run in read_runs(file.parent) if run.result and run.result.end > 0]
        if not runs:
            continue
        first, *_ = runs[0].levels
        tests = {run.result.test for run in runs}
        pressed = all(run.result.stress is not None and np.median(run.result.stress) > 0
                      for run in runs)
        if first == STRESS and tests == {"creep"} and pressed:
            found.setdefault(STRESS, runs)
        elif first == RATE and tests == {"constant rate"} and pressed:
            found.setdefault(RATE, runs)
        elif tests == {"particle loads"} and "Loading/End time" in runs[0].levels and len(runs) == 2:
            found.setdefault("scaling", runs)
    return found


def held_stress(run):
    """Stress of a creep test as the result holds it [kPa]."""
    return float(f"{np.median(run.result.stress[run.result.stress != 0]):.6g}")


def strain_rate(run):
    """Mean strain rate of a test at constant rate [1/s]."""
    return float(f"{run.result.strain[-1] / 100 / run.result.end:.3g}")


def by_number(runs, number):
    """Runs by a number of theirs, rising: {400.0: [...]}."""
    groups = {}
    for run in runs:
        groups.setdefault(number(run), []).append(run)
    return dict(sorted(groups.items()))


def values(numbers, form):
    return ", ".join(format(x, form) for x in numbers)


def relative_spread(numbers):
    """Standard deviation over mean of two numbers or more."""
    return float(np.std(numbers, ddof=1) / np.mean(numbers))


def of_runs(count, runs):
    return f"{count} of {len(runs)}"


def strain_ordering(creep):
    """Of the runs with the same seeds and laws, at half of the earliest rupture time."""
    time = common_time([run for runs in creep.values() for run in runs])
    series = {}
    for stress, runs in creep.items():
        for run in runs:
            series.setdefault(tuple(v for k, v in run.levels.items() if k != STRESS), []).append(
                (stress, strain_at(run, time)))
    whole = [np.array(s) for s in series.values() if len(s) == len(creep)]
    good = [bool(np.all(np.diff(s[:, 1]) > 0)) for s in whole]
    means = [np.median([strain_at(run, time) for run in runs]) for runs in creep.values()]
    return Statement("strain grows with stress",
                     f"in {sum(good)} of {len(good)} series of stresses; at {time:.3g} s median "
                     f"{values(means, '.3g')} % under {values(creep, '.0f')} kPa",
                     all(good) if good else None)


def rupture(stress, runs):
    times = np.array([run.numbers["rupture_time_s"] for run in runs
                      if run.ruptured and run.numbers["rupture_time_s"] <= SECONDS])
    cut_short = any(run.numbers["end_time_s"] < SECONDS and not run.ruptured for run in runs)
    told = f"rupture in {of_runs(len(times), runs)} runs" if len(times) else (
        f"none in {len(runs)} run{'s' * (len(runs) > 1)} to "
        f"{min(run.numbers['end_time_s'] for run in runs):.4g} s")
    if len(times) > 1:
        told += f", at {times.min():.3g} to {times.max():.3g} s"
    elif len(times):
        told += f", at {times[0]:.3g} s"
    if stress <= 400:
        return Statement(f"{stress:g} kPa: no rupture within {SECONDS} s", told,
                         False if len(times) else None if cut_short else True)
    return Statement(f"{stress:g} kPa: rupture", told,
                     True if len(times) == len(runs) else None if cut_short else False)


def few_breakages(stress, runs):
    """Few: the paper gives no number; here at most one bond in fifty after the load came on."""
    shares = [np.sum(run.result.breakages["time_s"] > 0) / run.numbers["bonds"] for run in runs]
    return Statement(f"{stress:g} kPa: few bonds break (here: at most 2 % after the load came on)",
                     f"{100 * min(shares):.3g} to {100 * max(shares):.3g} %"
                     if len(shares) > 1 else f"{100 * shares[0]:.3g} %", max(shares) <= 0.02)


def most_breakages_at_rupture(creep):
    runs = [run for group in creep.values() for run in group if run.ruptured]
    count = int(sum(run.numbers["most_breakages_at_end"] for run in runs))
    return Statement("rupture is where the rate of breakage is highest",
                     f"in {of_runs(count, runs)} runs with rupture (20 equal times, the first left out)",
                     bool(runs) and count == len(runs))


def three_stages(creep):
    """A least rate before rupture, after which the rate rises: primary, secondary, tertiary."""
    runs = [run for group in creep.values() for run in group if run.ruptured]
    found = [np.isfinite(run.numbers["flow_time_s"])
             and run.numbers["flow_time_s"] < run.numbers["rupture_time_s"] for run in runs]
    shares = [run.numbers["flow_time_s"] / run.numbers["rupture_time_s"]
              for run, has in zip(runs, found) if has]
    return Statement("three stages before rupture: the rate falls, is nearly constant, rises",
                     f"least rate before rupture in {of_runs(sum(found), runs)} runs" +
                     (f", at {min(shares):.2f} to {max(shares):.2f} of the rupture time"
                      if shares else ""), bool(runs) and all(found))


def scatter(creep):
    """Of strain where nothing ruptures, of the rupture time where all does."""
    for stress, runs in creep.items():
        times = [run.numbers["rupture_time_s"] for run in runs if run.ruptured]
        if stress <= 400 and not times and len(runs) > 1:
            end = min(run.numbers["end_time_s"] for run in runs)
            found = relative_spread([strain_at(run, end) for run in runs])
            yield Statement(f"{stress:g} kPa: seeds, packing and strength law hardly matter "
                            f"(here: below {100 * NEGLIGIBLE:.0f} %)",
                            f"strain at {end:.4g} s scatters by {100 * found:.2g} % (standard "
                            f"deviation, {len(runs)} runs)", found < NEGLIGIBLE)
        elif stress > 400 and len(times) > 1:
            found = relative_spread(times)
            yield Statement(f"{stress:g} kPa: the rupture time depends on seed and packing "
                            f"(here: by more than {100 * NEGLIGIBLE:.0f} %)",
                            f"it scatters by {100 * found:.2g} % (standard deviation, {len(times)} "
                            "runs)", found >= NEGLIGIBLE)


def peak_stress_per_decade(rates):
    peaks = [np.median([run.numbers["largest_stress_kPa"] for run in runs])
             for runs in rates.values()]
    slope, _ = power_law(np.array(list(rates)), np.array(peaks))
    every = [run for runs in rates.values() for run in runs]
    falls = int(sum(run.numbers["stress_falls"] for run in every))
    return Statement("peak stress grows by about 10^0.325 = 2.11 per decade of strain rate",
                     f"median of the largest stress {values(np.array(peaks) / 1e3, '.3g')} MPa at "
                     f"{values(rates, 'g')} /s: {10**slope:.3g} per decade; a fall of 5 % follows in "
                     f"{of_runs(falls, every)} runs", abs(slope - 0.325) < 0.05)


def scatter_at_constant_rate(rates):
    found = [relative_spread([run.numbers["largest_stress_kPa"] for run in runs])
             for runs in rates.values() if len(runs) > 1]
    return Statement("constant rate: strength law, seed and packing hardly matter "
                     f"(here: below {100 * NEGLIGIBLE:.0f} %)",
                     f"largest stress scatters by {values(100 * np.array(found), '.2g')} % at "
                     f"{values([rate for rate, runs in rates.items() if len(runs) > 1], 'g')} /s",
                     max(found) < NEGLIGIBLE)


def scaling(runs):
    """Displacement with viscosities divided against the original, time axis stretched."""
    slow, fast = sorted(runs, key=lambda run: -run.numbers["end_time_s"])[:2]
    (time, u), (other, v) = ((r.time, r.history["mean_displacement_mm"])
                             for r in (slow.result, fast.result))
    factor = time[-1] / other[-1]
    worst = np.max(np.abs(u - np.interp(time, factor * other, v))) / u[-1]
    return Statement(f"Fig. 4: viscosities divided by {factor:g} give the same curve in 1/{factor:g} of "
                     "the time, 0.3 m", f"{u[-1] / 1e3:.4f} m at {time[-1]:.0f} s, "
                     f"{v[-1] / 1e3:.4f} m at {other[-1]:.0f} s, largest difference {worst:.0e} of "
                     "it", bool(worst < 1e-9))


def all_statements(folder):
    """Every statement for which there are runs in a folder."""
    found = studies(folder)
    creep = by_number(found.get(STRESS, []), held_stress)
    if len(creep) > 1:
        yield strain_ordering(creep)
        for stress, runs in creep.items():
            yield rupture(stress, runs)
        yield few_breakages(*next(iter(creep.items())))
        if any(run.ruptured for runs in creep.values() for run in runs):
            yield most_breakages_at_rupture(creep)
            yield three_stages(creep)
        yield from scatter(creep)
    rates = by_number(found.get(RATE, []), strain_rate)
    if len(rates) > 1:
        yield peak_stress_per_decade(rates)
        if any(len(runs) > 1 for runs in rates.values()):
            yield scatter_at_constant_rate(rates)
    if "scaling" in found:
        yield scaling(found["scaling"])


VERDICTS = {True: "met", False: "**not met**", None: "not tested"}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rows = list(all_statements(Path(sys.argv[1])))
    if not rows:
        sys.exit(f"{sys.argv[1]}: there are no studies of creep or strain rate in it")
    print("| statement | measured | |\n|---|---|---|")
    for row in rows:
        print(f"| {row.statement} | {row.measured} | {VERDICTS[row.met]} |")


if __name__ == "__main__":
    main()
