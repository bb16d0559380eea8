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
from results import COLOURS, DISPLACEMENT
from sheet import STYLE

SEEDS = ("Specimen/Seed", "Strength/Seed")
NAMES = {"Specimen/Seed": "packing", "Strength/Seed": "strength seed",
         "Strength/Distribution": "strength law"}
RESPONSES = ("strain_at_common_time_percent", "displacement_at_common_time_mm",
             "broken_bonds_at_common_time", "flow_time_s", "rupture_time_s",
             "minimum_creep_rate_per_s", "largest_stress_kPa",
             "strain_at_largest_stress_percent")  # what statistics are made of


class Group:
    """Runs of a study that differ in nothing but seeds and other factors than the first."""

    def __init__(self, label, runs, colour):
        self.label, self.runs, self.colour = label, runs, colour
        self.done = [run for run in runs if run.result]
        self.can_rupture = bool(self.done) and all(run.can_rupture for run in self.done)
        self.creeps = bool(self.done) and all(run.result.creeps for run in self.done)
        self.common_time = run_summary.common_time(self.done)
        for run in self.done if self.creeps and self.common_time > 0 else ():
            column = ("displacement_at_common_time_mm" if run.result.kind is DISPLACEMENT
                      else "strain_at_common_time_percent")
            run.numbers[column] = run_summary.strain_at(run, self.common_time)
            if run.result.volumes:
                run.numbers["broken_bonds_at_common_time"] = run_summary.broken_at(
                    run, self.common_time)

    def values(self, column):
        """Amounts of a column, without zeros and what is not known, and of which runs."""
        pairs = [(abs(run.numbers.get(column, np.nan)), run) for run in self.done]
        kept = [(value, run) for value, run in pairs if np.isfinite(value) and value > 0]
        return np.array([value for value, _ in kept]), [run for _, run in kept]

    def rupture_times(self):
        """Of all runs that are done; infinite where none came before the end."""
        return np.array([run.numbers["rupture_time_s"] if run.ruptured else np.inf
                         for run in self.done])


def grouped(runs):
    """Groups by the first factor that is not a seed; one group if all are."""
    keys = [key for key in runs[0].levels if key not in SEEDS]
    key = keys[0] if keys else None
    labels = list(dict.fromkeys(run.levels.get(key, "all runs") for run in runs))
    groups = [Group(label, [run for run in runs if run.levels.get(key, "all runs") == label],
                    COLOURS[k % len(COLOURS)]) for k, label in enumerate(labels)]
    return key, groups


def factors(runs, group_key):
    """Levels of what differs within groups, by name."""
    return {NAMES.get(key, key.split("/")[-1]): [run.levels[key] for run in runs]
            for key in runs[0].levels if key != group_key}


def statistics_row(label, column, values):
    """Label, quantity, number of runs, median, its interval and level, mean and scatter, of how many.

    Infinite values are runs that did not show it; they count in the median, not in the mean. One run
    has no interval.
    """
    finite = values[np.isfinite(values) & (values > 0)]
    mean, spread = statistics.log_spread(finite)
    low, high, level = statistics.median_interval(values) if len(values) > 1 else (np.nan,) * 3
    return [label, column, len(values), *(run_summary.cell(x, ".8g") for x in (
        statistics.median(values), low, high, level, mean, spread)), len(finite)]


def statistics_text(key, groups):
    """Statistics of the groups as CSV."""
    rows = [[key or "group", "quantity", "runs", "median", "interval_low", "interval_high",
             "interval_level", "geometric_mean", "standard_deviation_of_ln", "runs_of_mean"]]
    for group in groups:
        done = len(group.done)
        if done < len(group.runs):
            rows.append([group.label, "failed", len(group.runs) - done] + [""] * 7)
        if group.can_rupture:
            times = group.rupture_times()
            ruptures = int(np.sum(np.isfinite(times)))
            low, high = statistics.proportion_interval(ruptures, done)
            rows.append([group.label, "share_ruptured", done, *(run_summary.cell(x, ".6g") for x in (
                ruptures / done, low, high, statistics.LEVEL)), "", "", done])
            if ruptures:
                rows.append(statistics_row(group.label, "rupture_time_s", times))
        for column in RESPONSES:
            values, _ = group.values(column)
            if len(values) and column != "rupture_time_s":
                rows.append(statistics_row(group.label, column, values))
    return run_summary.csv_text(rows)


def variance_rows(key, groups):
    """Analyses of variance of the logarithms: of each group, and of all with the group as a factor."""
    rows = []
    for column in RESPONSES:
        every = []
        for group in groups:
            values, runs = group.values(column)
            every += list(zip(values, runs, [group.label] * len(values)))
            if len(values) > 2:
                rows += [(group.label, column, len(values), *row) for row in
                         statistics.variance_table(np.log(values), factors(runs, key))]
        if len({label for _, _, label in every}) > 1 and len(every) > 3:
            values, runs, labels = zip(*every)
            both = {NAMES.get(key, key.split("/")[-1]): labels, **factors(runs, key)}
            rows += [("all", column, len(values), *row)
                     for row in statistics.variance_table(np.log(values), both)]
    return rows


def variance_text(key, rows):
    """The analyses of variance as CSV."""
    return run_summary.csv_text(
        [[key or "group", "quantity", "runs", "source", "sum_of_squares_of_ln",
          "degrees_of_freedom", "F", "p"]]
        + [[label, column, n, source, format(squares, ".6g"), degrees,
            *(run_summary.cell(x, ".6g") for x in (f, p))]
           for label, column, n, source, squares, degrees, f, p in rows])


def bands(groups):
    """Common times and the strain of each run, median and band, for each group; in amounts."""
    found = {}
    for group in groups:
        runs = [run for run in group.done if run.result.end > 0]
        if not runs:
            continue
        curves = [(run.result.curve()[0], np.abs(run.result.curve()[1]), run.ruptured)
                  for run in runs]
        first = min(run.result.first_time for run in runs)
        times = np.r_[0, np.geomspace(first, max(run.result.end for run in runs), 300)]
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
        for k, (label, (times, (middle, low, high))) in enumerate(found.items()):
            kind = groups[0].done[0].result.kind
            place = file.create_group(f"bands/{k + 1}")
            place.attrs["group"] = label
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
    done = [group for group in groups if any(run.result.end > 0 for run in group.done)]
    tables = {"summary.csv": run_summary.summary_text(runs),
              "statistics.csv": statistics_text(key, groups),
              "variance.csv": variance_text(key, variance_rows(key, groups))}
    for name, text in tables.items():
        replaced(folder / name, text)
    write_results(folder, key, [group for group in groups if group.done], found, tables)
    if with_figures and any(len(group.done) > 1 for group in done):
        for group in done:
            group.done = [run for run in group.done if run.result.end > 0]
        matplotlib.rcParams.update(STYLE)
        campaign_figures.draw(folder, key, done, found)


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
