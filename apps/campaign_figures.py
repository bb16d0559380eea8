"""Figures of a study: every run thin, the median of each group thick, bands between."""
import numpy as np
import statistics_of_runs as statistics
from curves import before_collapse, power_law
from sheet import Sheet

MARKERS = "osD^vP*X"
BAND = ("Thin: each run. Thick: median. Band: 10 % to 90 % of the runs. Medians and bands end where half "
        "of the runs, or those of the band, have ruptured.")


def results_of(groups):
    return [run.result for group in groups for run in group.done]


def varied(key):
    return key.split("/")[-1] if key else None


def strain_time(folder, key, groups, found):
    """Strain against time of all runs, over time and over its logarithm."""
    sheet, kind = Sheet(results_of(groups), (1, 1)), groups[0].done[0].result.kind
    for group in groups:
        times, (middle, low, high) = found[group.label]
        number = len(group.done)
        ruptured = sum(run.ruptured for run in group.done)
        text = f"{group.label}: {number} runs" + (
            f", {ruptured} ruptured" if group.can_rupture else "")
        for axes in sheet.panels:
            for run in group.done:
                axes.plot(run.result.curve()[0], np.abs(run.result.curve()[1]), color=group.colour,
                          lw=0.6, alpha=0.5)
            shown = np.isfinite(middle)
            axes.plot(times[shown], middle[shown], color=group.colour, lw=2.4, label=text)
            both = np.isfinite(low) & np.isfinite(high)
            axes.fill_between(times[both], low[both], high[both], color=group.colour, alpha=0.2, lw=0)
    ends = [r.end for r in results_of(groups)]
    sheet.panels[1].set_xlim(min(r.first_time for r in results_of(groups)), 1.3 * max(ends))
    tops = [np.max(np.abs(before_collapse(*r.curve())[1])) for r in results_of(groups)]
    axis = kind.axis if min(np.min(r.curve()[1]) for r in results_of(groups)) >= 0 else (
        f"Amount of the {kind.axis[0].lower()}{kind.axis[1:]}")
    for axes in sheet.panels:
        axes.set_ylim(0, 1.3 * max(tops))
    sheet.label(0, "Time [s]", axis)
    sheet.label(1, "Time [s]", axis, "x")
    sheet.save(folder / "strain_time_band.png", varied(key), BAND)


def breakages(folder, key, groups):
    """Number of broken bonds over time, and the rate of breakage over time up to rupture."""
    sheet, edges = Sheet(results_of(groups), (1, 1)), np.linspace(0, 1, 21)
    for group in groups:
        rates = []
        for run in group.done:
            times = np.sort(run.result.breakages["time_s"])
            later = times[times > 0]
            sheet.panels[0].step(np.r_[later, run.result.end],
                                 np.r_[len(times) - len(later) + 1 + np.arange(len(later)),
                                       len(times)], where="post", color=group.colour, lw=0.8,
                                 alpha=0.7)
            counts, _ = np.histogram(later / run.result.end, edges)
            rates.append(counts / (run.result.end / 20))
        rates = np.array(rates)
        middle = np.median(rates, axis=0)
        sheet.panels[0].plot([], [], color=group.colour, lw=2, label=group.label)
        sheet.panels[1].stairs(np.where(middle > 0, middle, np.nan), edges, baseline=None, lw=2,
                               color=group.colour)
        for low, high, left in zip(rates.min(axis=0), rates.max(axis=0), edges):
            if high > 0:
                sheet.panels[1].fill_between([left, left + 0.05], max(low, 1e-9), high, lw=0,
                                             color=group.colour, alpha=0.15)
    positive = [y for line in sheet.panels[1].patches for y in np.atleast_1d(line.get_data()[0])
                if np.isfinite(y)]
    first = min(r.first_time for r in results_of(groups))
    sheet.label(0, "Time [s]", "Number of broken bonds", "x")
    sheet.panels[0].set_xlim(left=first)
    sheet.panels[1].set_yscale("log")
    if positive:
        sheet.panels[1].set_ylim(bottom=0.3 * min(positive))
    sheet.label(1, "Time over time of the end [-]", "Breakage rate [1/s]", "y")
    sheet.save(folder / "breakage_band.png", varied(key),
               "Rate: in 20 equal times up to the end of each run (rupture, if it came). Steps: median "
               "of the runs. Band: all of them.")


def style_of(run, laws, packings):
    """Marker by strength law, filled by packing."""
    law = laws.index(run.levels.get("Strength/Distribution", ""))
    packing = packings.index(run.levels.get("Specimen/Seed", ""))
    return MARKERS[law % len(MARKERS)], packing


def spread(values, width=0.5):
    """Places beside each other for points that would lie on one another."""
    return (np.arange(len(values)) - (len(values) - 1) / 2) * width / max(1, len(values) - 1)


def points_by_group(sheet, panel, groups, column, all_runs):
    """Values of every run beside its group, with the median and its interval."""
    axes = sheet.panels[panel]
    laws = sorted({run.levels.get("Strength/Distribution", "") for run in all_runs})
    packings = sorted({run.levels.get("Specimen/Seed", "") for run in all_runs})
    for place, group in enumerate(groups):
        values, runs = group.values(column)
        for value, run, offset in zip(values, runs, spread(values)):
            marker, packing = style_of(run, laws, packings)
            axes.plot(place + offset, value, marker, color=group.colour, ms=7,
                      mec="black", mfc=(group.colour, "white", "0.6")[packing % 3])
        times = group.rupture_times() if column == "rupture_time_s" else values
        if len(times):
            middle, low, high = statistics.median(times), *statistics.median_interval(times)[:2]
            if np.isfinite(middle):
                axes.plot([place - 0.38, place + 0.38], [middle] * 2, color="black", lw=1.2)
            if np.isfinite(high) and len(times) > 5:
                axes.fill_between([place - 0.38, place + 0.38], low, high, color="0.5", alpha=0.15,
                                  lw=0)
    for k, law in enumerate(laws if len(laws) > 1 else []):
        axes.plot([], [], MARKERS[k % len(MARKERS)], color="0.4", mec="black", label=f"law {law}")
    for k, packing in enumerate(packings if len(packings) > 1 else []):
        axes.plot([], [], "o", mec="black", color=("0.2", "white", "0.6")[k % 3],
                  label=f"packing {packing}")


def name_groups(axes, groups):
    """Labels of the places of groups on an axis."""
    axes.set_xticks(range(len(groups)), [group.label for group in groups])
    axes.set_xlim(-0.6, len(groups) - 0.4)


def rupture_times(folder, key, groups):
    """Rupture times of all runs by group, and their distributions."""
    sheet = Sheet(results_of(groups), (1.2, 1))
    every = [run for group in groups for run in group.done]
    ending = [group for group in groups if any(run.ruptured for run in group.done)]
    points_by_group(sheet, 0, ending, "rupture_time_s", every)
    for group in groups:
        times = np.sort(group.rupture_times())
        finite = times[np.isfinite(times)]
        n = len(times)
        if not len(finite):
            continue
        last = max(run.result.end for run in group.done)
        sheet.panels[1].step(np.r_[finite, last if len(finite) < n else finite[-1]],
                             np.r_[np.arange(1, len(finite) + 1), len(finite)] / n, where="post",
                             color=group.colour, lw=2,
                             label=f"{group.label}: {len(finite)} of {n} ruptured")
    sheet.panels[1].legend(loc="lower right", fontsize=8.5, frameon=True, framealpha=0.9,
                           edgecolor="none")
    sheet.label(0, varied(key) or "", "Rupture time [s]", "y")
    name_groups(sheet.panels[0], ending)
    sheet.label(1, "Time [s]", "Share of runs that have ruptured", "x")
    sheet.panels[1].set_ylim(0, 1.02)
    sheet.save(folder / "rupture_times.png", None,
               "Line: median. Grey, for six runs or more: its interval of at least 95 %, free of assumptions "
               "about the distribution.")


def stress_strain(folder, key, groups):
    """Stress against strain of all runs; the largest stress by group."""
    sheet = Sheet(results_of(groups), (1.4, 1))
    for group in groups:
        grid = np.linspace(0, min(np.abs(run.result.strain).max() for run in group.done), 300)
        rows = np.array([np.interp(grid, np.abs(run.result.strain), np.abs(run.result.stress) / 1e3)
                         for run in group.done])
        for run in group.done:
            sheet.panels[0].plot(np.abs(run.result.strain), np.abs(run.result.stress) / 1e3,
                                 color=group.colour, lw=0.6, alpha=0.5)
        middle, low, high = statistics.band(rows)
        sheet.panels[0].plot(grid, middle, color=group.colour, lw=2.4,
                             label=f"{group.label}: {len(group.done)} runs")
        sheet.panels[0].fill_between(grid, low, high, color=group.colour, alpha=0.2, lw=0)
    rates = [abs(group.done[0].result.strain[-1]) / 100 / group.done[0].result.end
             for group in groups]
    note = "Thin: each run. Thick: median. Band: 10 % to 90 % of the runs."
    if len(groups) > 1 and key == "Loading/Strain rate":
        draw_rates(sheet, groups, rates)
        note += " Bars: smallest and largest of the runs."
    else:
        points_by_group(sheet, 1, groups, "largest_stress_kPa",
                        [run for group in groups for run in group.done])
        sheet.label(1, varied(key) or "", "Largest stress [kPa]")
        name_groups(sheet.panels[1], groups)
    sheet.label(0, "Axial strain [%], compression positive", "Axial stress [MPa]")
    sheet.save(folder / "stress_strain_band.png", varied(key), note)


def draw_rates(sheet, groups, rates):
    """Largest stress against strain rate, with the power law through the medians."""
    axes = sheet.panels[1]
    middles = []
    for group, rate in zip(groups, rates):
        values = group.values("largest_stress_kPa")[0] / 1e3
        middles.append(statistics.median(values))
        axes.plot([rate, rate], [values.min(), values.max()], color=group.colour, lw=1.5)
        axes.plot(rate, middles[-1], "o", color=group.colour, mec="black", ms=8)
    slope, factor = power_law(np.array(rates), np.array(middles))
    ends = np.array([min(rates), max(rates)])
    law = float(groups[0].done[0].result.scene["Strength/Rate exponent"])
    centre = np.exp(np.mean(np.log(rates))), np.exp(np.mean(np.log(middles)))
    axes.plot(ends, factor * ends**slope, "k-", lw=1, label=f"fit, exponent {slope:.3f}")
    axes.plot(ends, centre[1] * (ends / centre[0]) ** law, "k--", lw=1,
              label=f"law of the strengths, {law:g}")
    axes.legend(loc="lower right")
    sheet.label(1, "Strain rate [1/s]", "Largest stress [MPa]", "xy")


def draw(folder, key, groups, found):
    """All figures that the runs can give."""
    strain_time(folder, key, groups, found)
    if any(len(run.result.breakages["time_s"]) for group in groups for run in group.done):
        breakages(folder, key, groups)
    if any(run.ruptured for group in groups for run in group.done):
        rupture_times(folder, key, groups)
    stressed = [g for g in groups if all(run.result.stress is not None and not run.result.creeps
                                         and not run.result.follows_stress for run in g.done)]
    if stressed:
        stress_strain(folder, key, stressed)
