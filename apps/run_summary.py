"""One row of numbers for each run of a study."""
import csv
from pathlib import Path

import damage
import numpy as np
from curves import peak
from results import Result

EQUAL_TIMES = 20  # into which the time up to rupture is cut, to find when most bonds break

NUMBERS = ("end_time_s", "strain_at_end_percent", "broken_bonds", "bonds", "flow_time_s",
           "minimum_creep_rate_per_s", "rupture_time_s", "most_breakages_at_end",
           "largest_stress_kPa", "strain_at_largest_stress_percent", "stress_falls", "wall_time_s")


class Run:
    """A run of a study: what was varied, how it ended, its result if it has one."""

    def __init__(self, folder, row):
        self.name, self.statement = row["run"], row["statement"]
        self.exit_code = int(row["exit_code"])
        self.levels = {key: value for key, value in row.items() if "/" in key}
        self.result = None
        if self.exit_code in (0, 5):
            self.result = Result(Path(folder) / self.name)
        self.numbers = numbers(self.result) if self.result else dict.fromkeys(NUMBERS, np.nan)

    @property
    def ruptured(self):
        return bool(np.isfinite(self.numbers["rupture_time_s"]))


def read_runs(folder):
    """The runs of a study from its runs.csv."""
    with open(Path(folder) / "runs.csv", newline="", encoding="utf-8") as file:
        return [Run(folder, row) for row in csv.DictReader(file)]


def rupture_time(r):
    """Time at which a creep test lost its equilibrium or came to its strain limit; else nan."""
    ended = str(r.about["end"])
    return r.end if r.creeps and ended in ("lost equilibrium", "strain limit") else np.nan


def most_breakages_at_end(r):
    """Whether the last of equal times up to the end has the most breakages after the loading."""
    times = np.sort(r.breakages["time_s"])
    counts, _ = np.histogram(times[times > 0], bins=EQUAL_TIMES, range=(0, r.end))
    counts[0] = 0  # the loading itself
    return float(counts.max() > 0 and np.argmax(counts) == EQUAL_TIMES - 1)


def numbers(r):
    """What a run shows in numbers; nan for what it does not show."""
    row = dict.fromkeys(NUMBERS, np.nan)
    value = r.history[r.kind.column]
    row.update(end_time_s=r.end, broken_bonds=len(r.breakages["time_s"]), bonds=r.n_bonds,
               wall_time_s=float(r.about["wall_time_s"]))
    if r.strain is not None:
        row["strain_at_end_percent"] = value[-1]
    if r.test == "creep" and r.stress is not None and r.end > 0:
        creep = damage.creep_row(r)
        rises = creep["rise_follows"]  # else the rate fell until the end, or until the collapse
        row.update(rupture_time_s=rupture_time(r),
                   flow_time_s=creep["time_of_minimum_s"] if rises else np.nan,
                   minimum_creep_rate_per_s=creep["minimum_creep_rate_per_s"])
        if np.isfinite(row["rupture_time_s"]):
            row["most_breakages_at_end"] = most_breakages_at_end(r)
    elif r.stress is not None and r.strain is not None and not r.follows_stress:
        k, falls = peak(r.stress)
        row.update(largest_stress_kPa=abs(r.stress[k]), stress_falls=float(falls),
                   strain_at_largest_stress_percent=r.strain[k])
    return row


def summary_text(runs):
    """The table of all runs as CSV."""
    keys = list(runs[0].levels) if runs else []
    quoted = [f'"{key}"' for key in keys]
    lines = [",".join(["run", *quoted, "exit_code", "end", *NUMBERS])]
    for run in runs:
        end = str(run.result.about["end"]) if run.result else "failed"
        cells = [run.name, *(f'"{run.levels[key]}"' for key in keys), str(run.exit_code), end]
        cells += ["" if np.isnan(run.numbers[c]) else f"{run.numbers[c]:.10g}" for c in NUMBERS]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"
