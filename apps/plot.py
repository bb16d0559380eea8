#!/usr/bin/python3
"""Figures of results of mastic.

usage: plot.py FOLDER RESULT...

A RESULT is a folder that holds result.h5; several are drawn in common figures. The figures are
written into FOLDER and their paths printed, one a line. Compression is positive.
"""
import functools
import logging
import os
import re
import sys
import textwrap
import warnings
from collections import namedtuple
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import h5py
    import matplotlib
    import numpy as np
    from matplotlib.figure import Figure
except ImportError as problem:
    sys.exit(f"plot.py: {problem}")

WINDOW, PER_DECADE = 0.1, 100  # of smoothed rates [decades of time], and how many
BINS_PER_DECADE, BINS = 5, 50  # of breakages, over log time and over time
FALL = 0.05  # share of the stress that a maximum loses if it is a peak
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"]
STYLE = {"axes.grid": True, "grid.color": "0.88", "axes.axisbelow": True, "lines.linewidth": 1.6,
         "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False}
WIDTH, PANEL_HEIGHT, LEFT, GAP, DPI = 10.0, 4.6, 0.95, 1.0, 160  # [inches]

Kind = namedtuple("Kind", "name column axis rate_axis factor")
STRAIN = Kind("strain", "axial_strain_percent", "Axial strain [%], compression positive",
              "Strain rate [1/s]", 0.01)
DISPLACEMENT = Kind("displacement", "mean_displacement_mm", "Mean displacement [mm]",
                    "Displacement rate [mm/s]", 1)


def event_order(time, value, n_broken, break_time, break_value):
    """A curve with its values just before each breakage, in the order in which they happened."""
    n = np.concatenate([n_broken, np.arange(len(break_time))])
    time, value = np.concatenate([time, break_time]), np.concatenate([value, break_value])
    order = np.lexsort((n, time))
    return time[order], value[order]


def before_collapse(time, value):
    """The curve up to its last instant if it jumps there by a tenth or more; whether it does."""
    first = int(np.searchsorted(time, time[-1]))
    jumps = abs(value[-1] - value[first]) > 0.1 * abs(value[-1])
    return (time[:first + 1], value[:first + 1], True) if jumps else (time, value, False)


def smoothed_rate(time, value):
    """Slopes of chords over windows of WINDOW decades of time, centred in log time.

    Near the end the windows narrow, down to a fifth, so as to stay within the record.
    """
    half = 10 ** (WINDOW / 2)
    first, last = time[time > 0][0] * half, time[-1] / half**0.2
    if first >= last:
        return np.empty(0), np.empty(0)
    centre = np.geomspace(first, last, int(PER_DECADE * np.log10(last / first)) + 2)
    reach = np.minimum(half, time[-1] / centre)
    low, high = centre / reach, centre * reach
    return centre, (np.interp(high, time, value) - np.interp(low, time, value)) / (high - low)


def flow_time(rate):
    """Index of the least smoothed rate if a rise of more than noise follows it, else None.

    The rise, to the last rates, must exceed 10 % and three times the noise: the scatter of log
    rates about the mean of those a window before and after, in the decade before the minimum.
    """
    lag = round(WINDOW * PER_DECADE)
    if len(rate) <= 2 * lag or not np.all(rate > 0):
        return None
    k, y = int(np.argmin(rate)), np.log10(rate)
    if k == 0 or k >= len(rate) - lag:
        return None
    before = y[max(0, k - PER_DECADE):k + 1]
    bend = before[lag:-lag] - (before[:-2 * lag] + before[2 * lag:]) / 2
    noise = 1.4826 * np.median(np.abs(bend)) / np.sqrt(1.5) if len(bend) else 0
    return k if np.median(y[-lag:]) - y[k] > max(np.log10(1.1), 3 * noise) else None


def peak(stress):
    """Index of the largest stress by amount, and whether a fall by FALL follows it."""
    size = np.abs(stress)
    k = int(np.argmax(size))
    return k, bool(size[k:].min() <= (1 - FALL) * size[k])


def bin_edges(first, last, logarithmic):
    """Bins of equal width in time, or in log time."""
    last *= 1 + 1e-12
    if logarithmic:
        n = max(1, round(BINS_PER_DECADE * np.log10(last / first)))
        return np.geomspace(first, last, n + 1)
    return np.linspace(first, last, BINS + 1)


def binned_rate(times, edges):
    """Number per time in each bin."""
    return np.histogram(times, edges)[0] / np.diff(edges)


def power_law(x, y):
    """Exponent and factor of the power law nearest to points in log-log."""
    exponent, log_factor = np.polyfit(np.log(x), np.log(y), 1)
    return exponent, np.exp(log_factor)


def scene_values(text):
    """Values of a scene by 'Section/Key'."""
    values, sections = {}, []
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word == "subsection":
            sections.append(rest)
        elif word == "end":
            sections.pop()
        elif word == "set":
            key, _, value = rest.partition("=")
            values["/".join(sections + [key.strip()])] = value.strip()
    return values


class Result:
    """What the figures need of one result.h5."""

    def __init__(self, folder):
        self.folder = Path(folder).resolve()
        self.label, self.look, self.left_out = "", {"color": COLOURS[0], "ls": "-"}, []
        if not (self.folder / "result.h5").is_file():
            raise ValueError(f"{folder}: there is no result.h5 in it")
        try:
            with h5py.File(self.folder / "result.h5", "r") as file:
                self.read(file)
        except (OSError, KeyError) as error:
            reason = str(error).strip("'\"").splitlines()[0]
            raise ValueError(f"{folder}: no result can be read there: {reason}") from None

    def read(self, file):
        self.about = {name: value.decode() if isinstance(value, bytes) else value
                      for name, value in file.attrs.items()}
        if self.about.get("kind") != "result":
            raise KeyError("result.h5 is of another kind")
        self.scene = scene_values(bytes(file["scene/resolved"][()]).decode())
        self.history, self.breakages, self.modulus = (
            {name: column[()] for name, column in file.get(table, {}).items()}
            for table in ("history", "breakages", "complex_modulus"))
        self.n_particles, self.n_bonds = len(file["packing/radius"]), len(file["bonds/id"])
        self.time, self.end = self.history["time_s"], self.history["time_s"][-1]
        times = self.breakages["time_s"]
        times[times < 1e-12 * self.end] = 0  # by the first infinitesimal load
        self.strain, self.stress = (self.history.get(f"axial_{name}")
                                    for name in ("strain_percent", "stress_kPa"))
        self.test = self.scene["Loading/Test"]
        self.creeps = self.test in ("creep", "particle loads")
        self.kind = DISPLACEMENT if self.strain is None else STRAIN
        self.first_time = self.time[self.time > 0].min(initial=np.inf)

    def curve(self):
        """Times and strains or mean displacements; jumps are sharp where breakages tell them."""
        value, before = self.history[self.kind.column], self.breakages.get(self.kind.column)
        if before is None:
            return self.time, value
        return event_order(self.time, value, self.history["broken_bonds"],
                           self.breakages["time_s"], before)

    def loaded(self):
        """First and last time at which a creep test is under its load."""
        size = np.abs(self.history["load_factor"] if self.stress is None else self.stress)
        held = np.flatnonzero(size >= 0.95 * np.median(size[size >= 0.5 * size.max()]))
        released = self.scene["Loading/Release time"] != "never" and self.test == "creep"
        return self.time[held[0]], self.time[held[-1]] if released else self.end

    def legend(self, text=""):
        return ": ".join(part for part in (self.label, text) if part) or None


def natural_order(r):
    """Sorts 400-kPa before 1000-kPa."""
    number = re.match(r"[-+]?\d+(\.\d*)?([eE][-+]?\d+)?", r.folder.name)
    return float(number[0]) if number else np.inf, str(r.folder)


def name_results(results):
    """Gives several results their colours and labels; returns the key that a study varied."""
    varied = [key for key in results[0].scene if all(
        re.sub(r"[^0-9A-Za-z.]", "-", r.scene.get(key, "")) == r.folder.name for r in results)]
    alike = len({r.folder.name for r in results}) < len(results)
    for k, r in enumerate(results if len(results) > 1 else []):
        name = re.sub(r"^([\d.]+)-([A-Za-z]+)$", r"\1 \2", r.folder.name)
        r.label = r.scene[varied[0]] if varied else name
        r.label = f"{r.folder.parent.name}/{name}" if alike else r.label
        r.look = {"color": COLOURS[k % len(COLOURS)], "ls": ["-", "--", ":"][k // len(COLOURS) % 3]}
    return varied[0].split("/")[-1] if len(varied) == 1 and len(results) > 1 and not alike else None


def joined(texts, most=4):
    """The different ones among texts, in one line."""
    texts = list(dict.fromkeys(filter(None, texts)))
    return "; ".join(texts[:most]) + (f" and {len(texts) - most} more" if len(texts) > most else "")


def seeds(r):
    """Where particles and strengths come from."""
    parts = [f"packing seed {r.about['packing_seed']:g}" if r.scene["Specimen/Source"] == "generate"
             else f"particles from {r.scene['Specimen/File']}"]
    if r.scene["Strength/Distribution"] != "none":
        parts.append(f"strength seed {r.about['strength_seed']:g}")
    return ", ".join(parts)


def provenance(results):
    """Lines of small print: what was simulated, how, and on which estimates it rests."""
    estimates = dict.fromkeys(name for r in results if r.about["estimated_values"] != "none"
                              for name in r.about["estimated_values"].split(", "))
    loads = {"creep": "Loading/Axial stress", "constant rate": "Loading/Strain rate"}
    facts = [joined(f(r) for r in results) for f in (
        lambda r: r.folder.name, lambda r: r.test, lambda r: r.scene.get(loads.get(r.test), ""),
        lambda r: r.scene["Temperature/Temperature"].replace("degC", "\u00b0C"),
        lambda r: f"solver {r.about['solver']}",
        lambda r: f"{r.n_particles} particles, {r.n_bonds} bonds", seeds,
        lambda r: f"{r.about['program']} ({r.about['revision']})")]
    lines = [f"Result{'s' * (len(results) > 1)}: " + "  |  ".join(filter(None, facts))]
    if results[0].left_out:
        lines.append(f"Ended at t = 0 and left out: {joined(results[0].left_out)}.")
    if estimates:
        strengths = any(f"Strength/{name}" in results[0].scene for name in estimates)
        lines.append(f"Creep law{' and strengths' if strengths else ''}: partly estimated values "
                     f"({', '.join(estimates)}).")
    return lines


def log_label(x, _, form, every):
    """Label of a tick on a log axis: at every digit, or at 1, 2, 3, 5."""
    return form.format(x).replace("e-0", "e-") if every or f"{x:e}"[0] in "1235" else ""


class Sheet:
    """A figure of panels side by side, all places in inches."""

    def __init__(self, results, widths=(1,)):
        self.results, self.widths = results, widths
        self.figure = Figure(dpi=DPI)
        self.panels = [self.figure.add_axes([0, 0, 1, 1], label=str(k)) for k in range(len(widths))]

    def label(self, panel, x, y, log=""):
        """Names the axes of a panel that is drawn; `log` names those that are logarithmic."""
        axes = self.panels[panel]
        axes.set(xlabel=x, ylabel=y, xscale="log" if "x" in log else "linear",
                 yscale="log" if "y" in log else "linear")
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            if axis.get_scale() == "log" and high < 50 * low:  # few powers of ten to be labels
                form = "{:g}" if 1e-3 < low and high < 1e5 else "{:.0e}"
                label = functools.partial(log_label, form=form, every=high < 5 * low)
                axis.set_major_formatter(label)
                axis.set_minor_formatter(label)

    def mark(self, x, y, marker, r, filled=True, panel=0):
        """A point of a result that stands out from its curve."""
        self.panels[panel].plot(x, y, marker, color=r.look["color"] if filled else "white",
                                mec="black" if filled else r.look["color"], ms=8, zorder=3)

    def save(self, path, key, note=""):
        """Adds legend and texts, writes under a temporary name, renames, prints the name.

        The legend stands above the panels, where it hides nothing.
        """
        lines = [part for line in [note] * bool(note) + provenance(self.results)
                 for part in textwrap.wrap(line, 185)]
        handles, labels = self.panels[0].get_legend_handles_labels()
        columns = int((WIDTH - 1) / (0.6 + 0.085 * max(map(len, labels), default=0)))
        columns = max(1, min(columns, 4, len(labels)))
        rows = -(-len(labels) // columns) + bool(key and labels)
        below, top = 0.7 + 0.14 * len(lines), 0.5 + 0.22 * rows + 0.15 * (rows > 0)
        height = PANEL_HEIGHT + 1.4 + max(0, 0.22 * (rows - 3))
        self.figure.set_size_inches(WIDTH, height)
        title = textwrap.shorten(joined((r.about["title"] for r in self.results), 2), 95)
        self.figure.text(LEFT / WIDTH, 1 - 0.15 / height, title, va="top", size=12, weight="bold",
                         parse_math=False)
        self.figure.text(0.1 / WIDTH, 0.08 / height, "\n".join(lines), size=7.5, color="0.3",
                         parse_math=False)
        if labels:
            self.figure.legend(handles, labels, ncol=columns, title=key, alignment="left",
                               loc="upper left", borderaxespad=0, borderpad=0,
                               bbox_to_anchor=(LEFT / WIDTH, 1 - 0.5 / height))
        left, room = LEFT, WIDTH - LEFT - 0.25 - GAP * (len(self.panels) - 1)
        for axes, width in zip(self.panels, np.array(self.widths) / sum(self.widths)):
            axes.set_position([left / WIDTH, below / height, room * width / WIDTH,
                               1 - (below + top) / height])
            left += room * width + GAP
        part = path.with_name(path.name + ".part")
        try:
            self.figure.savefig(part, format="png")
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
        print(path)


def wide_times(results):
    """Whether times belong on a log axis: creep, or runs of very different durations."""
    return any(r.creeps for r in results) or max(r.end for r in results) > 5 * min(
        r.end for r in results)


def draw_response(results, key, folder):
    """Strain or displacement against time; beside it against log time, or the stress."""
    kind, log = results[0].kind, wide_times(results)
    history = not log and all(r.test.endswith("history") for r in results)
    sheet = Sheet(results, (1, 1) if log or history else (1,))
    for r in results:
        for axes in sheet.panels[:1 + log]:
            axes.plot(*r.curve(), **r.look, label=r.legend())
        if history:
            sheet.panels[1].plot(r.time, r.stress, **r.look)
    sheet.label(0, "Time [s]", kind.axis)
    if log:
        sheet.label(1, "Time [s]", kind.axis, "x")
        sheet.panels[1].set_xlim(min(r.first_time for r in results),
                                 1.5 * max(r.end for r in results))
    if history:
        sheet.label(1, "Time [s]", "Axial stress [kPa], compression positive")
    sheet.save(folder / f"{kind.name}_time.png", key)


def draw_rate(results, key, folder):
    """Rate of creep against time, with flow times."""
    sheet = Sheet(results)
    notes = [f"Rate: slope of chords over centred windows of {WINDOW:g} decades of time, narrower "
             "at the end of the record."]
    for r in results:
        (time, value), (full, release) = r.curve(), r.loaded()
        held = (time >= full) & (time <= release)
        time, value, collapsed = before_collapse(time[held], value[held])
        time, rate = smoothed_rate(time, r.kind.factor * value * np.sign(value[-1]))
        k = flow_time(rate)
        text = [f"flow time {time[k]:.3g} s" if k is not None else "no flow time"]
        text += [f"collapse at {r.end:.3g} s"] * collapsed
        text += [f"full load from {full:.3g} s"] if full > 0 else []
        text += [f"released at {release:.3g} s"] if release < r.end else []
        sheet.panels[0].plot(time, np.where(rate > 0, rate, np.nan), **r.look,
                             label=r.legend(", ".join(text)))
        if k is not None:
            sheet.mark(time[k], rate[k], "o", r)
            notes.append("Circle: flow time, the least rate; a rise of more than 10 % and of more "
                         "than noise follows.")
        if collapsed and len(time):
            sheet.mark(time[-1], rate[-1], "X", r)
            notes.append("Cross: the specimen collapses at one instant.")
    sheet.label(0, "Time [s]", results[0].kind.rate_axis, "xy")
    sheet.save(folder / f"{results[0].kind.name}_rate.png", key, " ".join(dict.fromkeys(notes)))


def draw_breakages(results, key, folder):
    """Number and rate of breakages against time."""
    log, sheet = wide_times(results), Sheet(results, (1, 1))
    for r in results:
        times = np.sort(r.breakages["time_s"])
        first, at_start = r.first_time if log else 0, int(np.sum(times == 0))
        later, edges = times[times > first], bin_edges(first, r.end, log)
        number = len(times) - len(later) + np.arange(len(later) + 1)
        rate = binned_rate(times[times > 0], edges)
        sheet.panels[0].step(np.r_[first, later, r.end], np.r_[number, len(times)], where="post",
                             **r.look, label=r.legend(f"{at_start} at t = 0, {len(times)} in all"))
        sheet.panels[1].stairs(np.where(rate > 0, rate, np.nan), edges, lw=1.6, baseline=None,
                               **r.look)
    sheet.label(0, "Time [s]", "Number of broken bonds", "x" if log else "")
    sheet.label(1, "Time [s]", "Breakage rate [1/s]", "xy" if log else "y")
    sheet.panels[1].set_xlim(sheet.panels[0].get_xlim())
    bins = f"{BINS_PER_DECADE} per decade of time" if log else f"{BINS} of equal width"
    sheet.save(folder / "breakage.png", key,
               f"Rate: breakages after t = 0 per time in bins, {bins}; empty bins are left out.")


def draw_stress_strain(results, key, folder):
    """Stress against strain; the largest stress against strain rate if there are several rates."""
    largest = max(np.abs(r.stress).max() for r in results)
    unit, factor = ("MPa", 1e-3) if largest > 1000 else ("kPa", 1)
    ramps = [r for r in results if r.test == "constant rate"]
    rates = np.array([abs(r.strain[-1]) / 100 / r.end for r in ramps])
    several = len(ramps) > 1 and rates.max() > 1.01 * rates.min()
    sheet, note = Sheet(results, (1.6, 1) if several else (1,)), ""
    for r in results:
        k, falls = peak(r.stress)
        x, y = r.strain[k], factor * r.stress[k]
        text = f"{'peak' if falls and r in ramps else 'largest'} {y:.3g} {unit} at {x:.3g} %"
        controlled = r.test == "stress history"
        sheet.panels[0].plot(r.strain, factor * r.stress, **r.look,
                             label=r.legend("" if controlled else text))
        if not controlled:
            sheet.mark(x, y, "o", r, falls)
        if r in ramps and not falls:
            note = f"Open circle: largest stress so far; no fall by {100 * FALL:g} % follows it."
        if several and r in ramps:
            sheet.mark(rates[ramps.index(r)], abs(y), "o", r, falls, 1)
    if several:
        draw_exponents(sheet, rates, [factor * np.abs(r.stress).max() for r in ramps],
                       ramps[0].scene["Strength/Rate exponent"], unit)
    sheet.label(0, "Axial strain [%], compression positive",
                f"Axial stress [{unit}], compression positive")
    sheet.save(folder / "stress_strain.png", key, note)


def draw_exponents(sheet, rates, stresses, law, unit):
    """The power law through the largest stresses, beside that of the strengths."""
    axes, ends = sheet.panels[1], np.array([rates.min(), rates.max()])
    slope, factor = power_law(rates, stresses)
    middle = np.exp(np.mean(np.log(rates))), np.exp(np.mean(np.log(stresses)))
    axes.plot(ends, factor * ends**slope, "k-", lw=1, label=f"fit, exponent {slope:.3f}", zorder=1)
    axes.plot(ends, middle[1] * (ends / middle[0]) ** float(law), "k--", lw=1, zorder=1,
              label=f"law of the strengths, {law}")
    axes.legend(loc="lower right")
    sheet.label(1, "Strain rate [1/s]", f"Largest stress [{unit}]", "xy")


def draw_compliance(results, key, folder):
    """Creep compliance of intact specimens."""
    sheet = Sheet(results)
    for r in results:
        loaded = r.time <= r.loaded()[1]
        d = r.history["creep_compliance_per_GPa"][loaded]
        sheet.panels[0].plot(r.time[loaded][1:], d[1:], **r.look, label=r.legend(
            f"D(0) = {d[0]:.3g}, D({r.time[loaded][-1]:.4g} s) = {d[-1]:.3g} 1/GPa"))
    sheet.label(0, "Time [s]", "Creep compliance D(t) [1/GPa]", "xy")
    sheet.save(folder / "compliance.png", key)


def draw_modulus(results, key, folder):
    """Complex modulus and phase angle."""
    sheet = Sheet(results, (1, 1))
    for r in results:
        for axes, column in zip(sheet.panels, ("complex_modulus_MPa", "phase_angle_degrees")):
            axes.plot(r.modulus["frequency_Hz"], r.modulus[column], marker="o", ms=5,
                      clip_on=False, label=r.legend(), **r.look)
    sheet.label(0, "Frequency [Hz]", "|E*| [MPa]", "xy")
    sheet.label(1, "Frequency [Hz]", "Phase angle [degrees]", "x")
    sheet.panels[1].set_ylim(bottom=0)
    sheet.save(folder / "complex_modulus.png", key)


def figures(results):
    """Drawing functions, each with the results that it can draw."""
    for kind in (STRAIN, DISPLACEMENT):
        alike = [r for r in results if r.kind is kind]
        yield draw_response, alike
        yield draw_rate, [r for r in alike if r.creeps]
    platen = [r for r in results if r.stress is not None]
    linear = [r for r in platen if r.about["solver"] == "linear"]
    yield draw_breakages, [r for r in results if len(r.breakages["time_s"])]
    yield draw_stress_strain, [r for r in platen if not r.creeps]
    yield draw_compliance, [r for r in linear if r.test == "creep"]
    yield draw_modulus, [r for r in linear if r.modulus]


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: plot.py FOLDER RESULT...")
    warnings.simplefilter("ignore")  # on standard error too
    matplotlib.rcParams.update(STYLE)
    folder = Path(sys.argv[1])
    try:
        folder.mkdir(parents=True, exist_ok=True)
        results = sorted((Result(each) for each in sys.argv[2:]), key=natural_order)
        for r in results:
            r.left_out = [other.folder.name for other in results if other.end == 0]
        results = [r for r in results if r.end > 0]
        if not results:
            raise ValueError("nothing to draw: the run ended at its first instant")
        key = name_results(results)
        for draw, drawable in figures(results):
            if drawable:
                draw(drawable, key, folder)
    except Exception as error:  # the caller shows one line
        kind = "" if isinstance(error, (OSError, ValueError)) else f"{type(error).__name__}: "
        sys.exit(f"plot.py: {kind}{' '.join(str(error).split())}")


if __name__ == "__main__":
    main()
