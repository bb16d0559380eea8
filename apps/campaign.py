#!/usr/bin/python3
"""Tables, statistics and figures of a study from the runs in its folder.

usage: campaign.py FOLDER [--tables]

FOLDER holds runs.csv and a folder for each run. Written there: summary.csv (a row for each run),
statistics.csv and variance.csv (groups of runs), study.h5 (all of these, and the bands of the
curves), and figures where several runs make a group. The paths of the figures are printed.
With --tables there are no figures.
"""
import os
import sys
import warnings
from pathlib import Path

from plot import replaced  # says what is missing, should it be

import h5py
import matplotlib
import numpy as np
import campaign_figures
import run_summary
import statistics_of_runs as statistics
from results import COLOURS
from sheet import STYLE

SEEDS = ("Specimen/Seed", "Strength/Seed")
NAMES = {"Specimen/Seed": "packing", "Strength/Seed": "strength seed",
         "Strength/Distribution": "strength law"}
RESPONSES = {  # column of the summary -> how it is called
    "strain_at_common_time_percent": "strain at the common time",
    "flow_time_s": "flow time", "rupture_time_s": "rupture time",
    "minimum_creep_rate_per_s": "minimum creep rate", "largest_stress_kPa": "largest stress",
    "strain_at_largest_stress_percent": "strain at the largest stress"}


class Group:
    """Runs of a study that differ in nothing but seeds and other factors than the first."""

    def __init__(self, label, runs, colour):
        self.label, self.runs, self.colour = label, runs, colour
        self.done = [run for run in runs if run.result]
        self.creeps = all(run.result.creeps for run in self.done)
        self.common_time = common_time(self.done)
        for run in self.done:
            run.numbers["strain_at_common_time_percent"] = at(run, self.common_time)

    def values(self, column):
        """Finite values of a column, and of which runs."""
        pairs = [(run.numbers.get(column, np.nan), run) for run in self.done]
        kept = [(value, run) for value, run in pairs if np.isfinite(value)]
        return np.array([value for value, _ in kept]), [run for _, run in kept]

    def rupture_times(self):
        """Of all runs that are done; infinite where none came before the end."""
        return np.array([run.numbers["rupture_time_s"] if run.ruptured else np.inf
                         for run in self.done])


def common_time(runs):
    """The last time before half of the earliest rupture, or the earliest end [s]."""
    ends = [run.numbers["rupture_time_s"] / 2 if run.ruptured else run.numbers["end_time_s"]
            for run in runs]
    return min(ends, default=np.nan)


def at(run, time):
    """Strain, or mean displacement, of a run at a time."""
    return float(np.interp(time, *run.result.curve()))


def grouped(runs):
    """Groups by the first factor that is not a seed; one group if all are."""
    keys = [key for key in runs[0].levels if key not in SEEDS]
    key = keys[0] if keys else None
    labels = list(dict.fromkeys(run.levels.get(key, "all runs") for run in runs))
    groups = [Group(label, [run for run in runs if run.levels.get(key, "all runs") == label],
                    COLOURS[k % len(COLOURS)]) for k, label in enumerate(labels)]
    return key, [group for group in groups if group.done]


def factors(runs, group_key):
    """Levels of what differs within groups, by name."""
    return {NAMES.get(key, key.split("/")[-1]): [run.levels[key] for run in runs]
            for key in runs[0].levels if key != group_key}


def group_statistics(group):
    """Rows (quantity, number of values, median, low, high, level, mean, relative spread)."""
    rows = []
    if group.creeps and any(run.ruptured for run in group.done):
        times = group.rupture_times()
        mean, spread = statistics.log_spread(times[np.isfinite(times)])
        rows.append(("rupture_time_s", len(times), statistics.median(times),
                     *statistics.median_interval(times), mean, spread))
    for column in RESPONSES:
        values, _ = group.values(column)
        if len(values) and column != "rupture_time_s" and np.all(values > 0):
            mean, spread = statistics.log_spread(values)
            rows.append((column, len(values), statistics.median(values),
                         *statistics.median_interval(values), mean, spread))
    return rows


def statistics_text(key, groups):
    """Statistics of the groups as CSV."""
    lines = [f'"{key or "group"}",quantity,runs,median,interval_low,interval_high,interval_level,'
             "geometric_mean,standard_deviation_of_ln"]
    for group in groups:
        done, n = len(group.done), len(group.runs)
        ruptures = sum(run.ruptured for run in group.done)
        if group.creeps:
            low, high = statistics.proportion_interval(ruptures, done)
            lines.append(f'"{group.label}",share_ruptured,{done},{ruptures / done:.6g},{low:.6g},'
                         f"{high:.6g},{statistics.LEVEL},,")
        lines += [f'"{group.label}",{row[0]},' + ",".join(
            "" if np.isnan(x) else f"{x:.8g}" for x in row[1:]) for row in group_statistics(group)]
        if done < n:
            lines.append(f'"{group.label}",failed,{n - done},,,,,,')
    return "\n".join(lines) + "\n"


def variance_rows(key, groups):
    """Analyses of variance of the logarithms: of each group, and of all with the group as a factor."""
    rows = []
    for column in RESPONSES:
        every = []
        for group in groups:
            values, runs = group.values(column)
            if len(values) and np.all(values > 0):
                every += list(zip(values, runs, [group.label] * len(values)))
            if len(values) > 2 and np.all(values > 0) and np.ptp(values) > 0:
                rows += [(group.label, column, len(values), *row) for row in
                         statistics.variance_table(np.log(values), factors(runs, key))]
        if len(groups) > 1 and len(every) > len(groups) + 1:
            values, runs, labels = zip(*every)
            both = {NAMES.get(key, key.split("/")[-1]): labels, **factors(runs, key)}
            if np.ptp(values) > 0:
                rows += [("all", column, len(values), *row)
                         for row in statistics.variance_table(np.log(values), both)]
    return rows


def variance_text(key, rows):
    lines = [f'"{key or "group"}",quantity,runs,source,sum_of_squares_of_ln,degrees_of_freedom,F,p']
    for label, column, n, source, squares, degrees, f, p in rows:
        tests = ",".join("" if np.isnan(x) else f"{x:.6g}" for x in (f, p))
        lines.append(f'"{label}",{column},{n},"{source}",{squares:.6g},{degrees},{tests}')
    return "\n".join(lines) + "\n"


def bands(groups):
    """Common times and the strain of each run, median and band, for each group."""
    found = {}
    for group in groups:
        curves = [(*run.result.curve(), run.ruptured) for run in group.done]
        first = min(run.result.first_time for run in group.done)
        times = np.r_[0, np.geomspace(first, max(run.result.end for run in group.done), 300)]
        found[group.label] = times, statistics.band(statistics.curves_at(times, curves))
    return found


def write_results(folder, key, groups, found, tables):
    """study.h5: tables as text, bands of the curves, where they come from."""
    part = folder / "study.h5.part"
    with h5py.File(part, "w") as file:
        about = groups[0].done[0].result.about
        file.attrs.update(kind="study", varied_first=key or "", program=about["program"],
                          revision=about["revision"], sign="compression positive")
        for name, text in tables.items():
            file[f"tables/{name}"] = text
        file["scene"] = (folder / "study.scene").read_text(encoding="utf-8")
        for label, (times, (middle, low, high)) in found.items():
            kind = groups[0].done[0].result.kind
            place = file.create_group("bands/" + label.replace("/", "-"))
            place["time_s"] = times
            for name, values in (("median", middle), ("low", low), ("high", high)):
                place[f"{kind.column}_{name}"] = values
            place.attrs["band"] = "10 % to 90 % of the runs; infinite after rupture"
    os.replace(part, folder / "study.h5")


def summarise(folder, with_figures):
    """All tables of a study, and its figures."""
    runs = run_summary.read_runs(folder)
    if not any(run.result for run in runs):
        raise ValueError(f"{folder}: no run of the study has a result")
    key, groups = grouped(runs)
    found = bands(groups)
    tables = {"summary.csv": run_summary.summary_text(runs),
              "statistics.csv": statistics_text(key, groups),
              "variance.csv": variance_text(key, variance_rows(key, groups))}
    for name, text in tables.items():
        replaced(folder / name, text)
    write_results(folder, key, groups, found, tables)
    if with_figures and any(len(group.done) > 1 for group in groups):
        matplotlib.rcParams.update(STYLE)
        campaign_figures.draw(folder, key, groups, found)


def main():
    if len(sys.argv) < 2 or sys.argv[2:] not in ([], ["--tables"]):
        sys.exit("usage: campaign.py FOLDER [--tables]")
    warnings.simplefilter("ignore")  # on standard error too
    try:
        summarise(Path(sys.argv[1]), not sys.argv[2:])
    except Exception as error:  # the caller shows one line
        kind = "" if isinstance(error, (OSError, ValueError)) else f"{type(error).__name__}: "
        sys.exit(f"campaign.py: {kind}{' '.join(str(error).split())}")


if __name__ == "__main__":
    main()
