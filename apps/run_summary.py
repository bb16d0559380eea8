"""One row of numbers for each run of a study."""
import csv
import io
from pathlib import Path

import damage
import numpy as np
from curves import peak
from results import DISPLACEMENT, Result

EQUAL_TIMES = 20  # into which the time up to rupture is cut, to find when most bonds break
NOT_KEYS = ("run", "exit_code", "statement")

NUMBERS = ("end_time_s", "strain_at_end_percent", "displacement_at_end_mm", "broken_bonds", "bonds",
           "flow_time_s", "minimum_creep_rate_per_s", "rupture_time_s", "most_breakages_at_end",
           "largest_stress_kPa", "strain_at_largest_stress_percent", "stress_falls", "wall_time_s")


class Run:
    """A run of a study: what was varied, how it ended, its result if it has one."""

    def __init__(self, folder, row):
        self.name, self.statement = row["run"], row["statement"]
        self.exit_code = int(row["exit_code"])
        self.levels = {key: value for key, value in row.items() if key not in NOT_KEYS}
        self.result = None
        if self.exit_code in (0, 1, 5):  # 1: not as the scene expects
            try:
                self.result = Result(Path(folder) / self.name)
            except ValueError as problem:
                self.statement = str(problem)
        self.numbers = numbers(self.result) if self.result else dict.fromkeys(NUMBERS, np.nan)

    @property
    def ruptured(self):
        return bool(np.isfinite(self.numbers["rupture_time_s"]))

    @property
    def can_rupture(self):
        """Whether it is a creep test of a specimen that may break."""
        return self.result is not None and self.result.test == "creep" and self.result.of_particles


def read_runs(folder):
    """The runs of a study from its runs.csv."""
    with open(Path(folder) / "runs.csv", newline="", encoding="utf-8") as file:
        return [Run(folder, row) for row in csv.DictReader(file)]


def strain_at(run, time):
    """Strain, or mean displacement, of a run at a time."""
    return float(np.interp(time, *run.result.curve()))


def broken_at(run, time):
    """Bonds that are broken in all volumes of a body at a time."""
    volumes = run.result.volumes
    return float(np.interp(time, volumes["time_s"], volumes["broken_bonds"]))


def common_time(runs):
    """Half of the earliest rupture time, or the earliest end [s]."""
    return min((run.numbers["rupture_time_s"] / 2 if run.ruptured else run.numbers["end_time_s"]
                for run in runs), default=np.nan)


def csv_text(rows):
    """Rows of cells as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def cell(number, form=".10g"):
    """A number as a cell; empty if it is not known."""
    return "" if np.isnan(number) else format(number, form)


def most_breakages_at_end(r):
    """Whether the last of equal times up to the end has the most breakages after the loading."""
    times = np.sort(r.breakages["time_s"])
    counts, _ = np.histogram(times[times > 0], bins=EQUAL_TIMES, range=(0, r.end))
    counts[0] = 0  # the loading itself
    return float(counts.max() > 0 and np.argmax(counts) == EQUAL_TIMES - 1)


def creep_numbers(r):
    """Flow time, least rate and rupture of a creep test.

    Rupture: the specimen lost its equilibrium or came to its strain limit.
    """
    row = {}
    if r.of_particles and str(r.about["end"]) in ("lost equilibrium", "strain limit"):
        row["rupture_time_s"] = r.end
    if r.end > 0 and r.stress is not None:
        creep = damage.creep_row(r)
        row["minimum_creep_rate_per_s"] = creep["minimum_creep_rate_per_s"]
        if creep["rise_follows"]:  # else the rate fell until the end, or until the collapse
            row["flow_time_s"] = creep["time_of_minimum_s"]
        if "rupture_time_s" in row:
            row["most_breakages_at_end"] = most_breakages_at_end(r)
    return row


def numbers(r):
    """What a run shows in numbers; nan for what it does not show."""
    row = dict.fromkeys(NUMBERS, np.nan)
    n_broken = r.volumes["broken_bonds"][-1] if r.volumes else len(r.breakages["time_s"])
    row.update(end_time_s=r.end, broken_bonds=n_broken, wall_time_s=float(r.about["wall_time_s"]),
               bonds=float(r.about["bonds"]) if r.volumes else r.n_bonds)
    end = "displacement_at_end_mm" if r.kind is DISPLACEMENT else "strain_at_end_percent"
    row[end] = r.history[r.kind.column][-1]
    if r.test == "creep":
        row.update(creep_numbers(r))
    elif r.stress is not None and r.strain is not None and not r.follows_stress:
        k, falls = peak(r.stress)
        row.update(largest_stress_kPa=abs(r.stress[k]), stress_falls=float(falls),
                   strain_at_largest_stress_percent=r.strain[k])
    return row


def summary_text(runs):
    """The table of all runs as CSV."""
    keys = list(runs[0].levels) if runs else []
    rows = [["run", *keys, "exit_code", "end", *NUMBERS]]
    for run in runs:
        end = str(run.result.about["end"]) if run.result else "failed"
        rows.append([run.name, *(run.levels[key] for key in keys), run.exit_code, end,
                     *(cell(run.numbers[c]) for c in NUMBERS)])
    return csv_text(rows)
