#!/usr/bin/python3
"""Figures of results of mastic.

usage: plot.py FOLDER RESULT...

A RESULT is a folder that holds result.h5; several are drawn in common figures. The figures are
written into FOLDER and their paths printed, one a line. Compression is positive.
"""
import logging
import os
import sys
import warnings
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import body_damage
    import damage
    import matplotlib
    import numpy as np
    import temperature_figures

    from curves import (BINS, BINS_PER_DECADE, FALL, WINDOW, before_collapse, bin_edges, binned_rate,
                        flow_time, peak, power_law, smoothed_rate)
    from results import DISPLACEMENT, STRAIN, Result, name_results, natural_order
    from sheet import STYLE, Sheet
except ImportError as problem:
    sys.exit(f"plot.py: {problem}")

def replaced(path, text):
    """Writes a text under a temporary name and renames it."""
    part = path.with_suffix(".part")
    part.write_text(text)
    os.replace(part, path)


def wide_times(results):
    """Whether times belong on a log axis: creep, or runs of very different durations."""
    return any(r.creeps for r in results) or max(r.end for r in results) > 5 * min(
        r.end for r in results)


def draw_response(results, key, folder):
    """Strain or displacement against time; beside it against log time, or the stress."""
    kind, log = results[0].kind, wide_times(results)
    history = not log and all(
        r.follows_stress or r.test == "strain history" for r in results)
    sheet = Sheet(results, (1, 1) if log or history else (1,))
    compared = any(r.measured for r in results)
    for r in results:
        text = f"rms {100 * r.difference:.3g} % off measured" if r.measured else ""
        for axes in sheet.panels[:1 + log]:
            axes.plot(*r.curve(), **r.look, label=r.legend(text))
            if r.measured:
                axes.plot(r.measured["time_s"], r.measured[kind.column], "o", ms=5, mfc="none",
                          color=r.look["color"])
        if history:
            sheet.panels[1].plot(r.time, r.stress, **r.look)
    sheet.label(0, "Time [s]", kind.axis)
    if log:
        sheet.label(1, "Time [s]", kind.axis, "x")
        sheet.panels[1].set_xlim(min(r.first_time for r in results),
                                 1.5 * max(r.end for r in results))
    if history:
        sheet.label(1, "Time [s]", "Axial stress [kPa], compression positive")
    sheet.save(folder / f"{kind.name}_time.png", key, "Circles: measured." if compared else "")


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
        sheet.panels[0].plot(r.strain, factor * r.stress, **r.look,
                             label=r.legend("" if r.follows_stress else text))
        if not r.follows_stress:
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


def draw_cycles(results, key, folder):
    """Permanent strain against the number of cycles, and its rate, with flow numbers."""
    sheet, note = Sheet(results, (1, 1)), ""
    for r in results:
        cycle, strain = r.cycles["cycle"], r.cycles["permanent_strain_percent"]
        number, rate = smoothed_rate(cycle, strain * np.sign(strain[-1]))
        k = flow_time(rate)
        text = f"flow number {number[k]:.0f}" if k is not None else "no flow number"
        sheet.panels[0].plot(cycle, strain, **r.look, label=r.legend(text))
        sheet.panels[1].plot(number, np.where(rate > 0, rate, np.nan), **r.look)
        if k is not None:
            sheet.mark(number[k], np.interp(number[k], cycle, strain), "o", r)
            sheet.mark(number[k], rate[k], "o", r, panel=1)
            note = (" Circle: flow number, the least rate; a rise of more than 10 % and of more "
                    "than noise follows.")
    sheet.label(0, "Cycle", "Permanent strain [%], compression positive")
    sheet.label(1, "Cycle", "Rate of permanent strain [% per cycle]", "xy")
    sheet.save(folder / "permanent_strain.png", key,
               "Permanent strain: at the end of the cycle. Rate: slope of chords over centred "
               f"windows of {WINDOW:g} decades of cycles, narrower at the end.{note}")


def draw_energy(results, key, folder):
    """Where the work of the loads went, one figure for a single run."""
    r, parts = results[0], ("stored", "dashpots", "friction", "breakage", "regularisation")
    sheet = Sheet(results[:1])
    time, work = r.energy["time_s"], r.energy["work_J"]
    sheet.panels[0].plot(time, work, color="black", lw=2, label="work of the loads")
    for part in parts:
        share = r.energy[f"{part}_J"][-1] / work[-1] if work[-1] else 0
        sheet.panels[0].plot(time, r.energy[f"{part}_J"], label=f"{part} ({100 * share:.2g} %)")
    gap = abs(r.energy["gap_J"][-1] / work[-1]) if work[-1] else 0
    sheet.label(0, "Time [s]", "Energy [J]")
    sheet.save(folder / "energy.png", key,
               f"Shares at the end, counted from where the quasi-static solver began. What does not add "
               f"up: {gap:.1e} of the work.")


def draw_damage(results, key, folder):
    """Rate and damage data of creep tests at several stresses: damage.csv and its figure."""
    named = [(r.folder.name, damage.creep_row(r)) for r in results]
    rows = [row for _, row in named]
    stress, rate, end = "axial_stress_kPa", "minimum_creep_rate_per_s", "rupture_time_s"
    norton = damage.fitted(rows, stress, rate)
    rupture = damage.fitted(rows, stress, end)
    monkman_grant = damage.fitted(rows, rate, end)
    replaced(folder / "damage.csv", damage.text(named, [
        ("minimum creep rate over stress in kPa (Norton)", norton),
        ("rupture time over stress in kPa", rupture),
        ("rupture time over minimum creep rate (Monkman-Grant)", monkman_grant)]))
    sheet = Sheet(results, (1, 1, 1))
    for panel, (fit, x, y) in enumerate(((norton, stress, rate), (rupture, stress, end),
                                         (monkman_grant, rate, end))):
        shown = [row[x] for row in rows if np.isfinite(row[x] * row[y])]
        for r, row in zip(results, rows):
            sheet.mark(row[x], row[y], "o", r, panel=panel)
            sheet.panels[panel].plot([], [], **r.look, label=r.legend())
        if fit:
            ends = np.array([min(shown), max(shown)])
            sheet.panels[panel].plot(ends, fit[1] * ends**fit[0], "k-", lw=1, zorder=1)
            sheet.panels[panel].text(0.35, 0.94, f"exponent {fit[0]:.3g}",
                                     transform=sheet.panels[panel].transAxes)
    sheet.label(0, "Axial stress [kPa]", "Minimum creep rate [1/s]", "xy")
    sheet.label(1, "Axial stress [kPa]", "Rupture time [s]", "xy")
    sheet.label(2, "Minimum creep rate [1/s]", "Rupture time [s]", "xy")
    sheet.save(folder / "damage.png", key,
               "Minimum creep rate: of the smoothed curve before the collapse; runs whose rate only "
               "falls have no point. Numbers: damage.csv.")
    draw_growth(results, key, folder)


def draw_growth(results, key, folder):
    """Compliance against the share of broken bonds."""
    sheet, elastic = Sheet(results), True
    for r in results:
        share, growth, elastic = damage.compliance_growth(r)
        sheet.panels[0].plot(100 * share, growth, **r.look, label=r.legend())
    kind = "Elastic compliance" if elastic else "Creep compliance (creep and damage)"
    sheet.label(0, "Broken bonds [%]", f"{kind} over its first value [-]", "y")
    sheet.save(folder / "compliance_growth.png", key)


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


def draw_volumes(results, key, folder):
    """Broken bonds and live points of bodies whose points are volumes."""
    sheet = Sheet(results, (1, 1))
    body_damage.draw_histories(sheet, results, "x" if wide_times(results) else "")
    sheet.save(folder / "volumes.png", key)


def draw_body(results, key, folder):
    """Where a body has lost its stiffness, for a single run."""
    sheet = Sheet(results, (1, 1))
    sheet.save(folder / "body_damage.png", key, body_damage.draw_sections(sheet, results[0]))


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
    yield draw_cycles, [r for r in platen if len(r.cycles.get("cycle", ())) > 1]
    yield draw_energy, [r for r in results if len(r.energy.get("time_s", ())) > 1
                        and len(results) == 1]
    yield draw_volumes, [r for r in results if r.volumes]
    yield draw_body, [r for r in results if r.damage and len(results) == 1]
    creep = [r for r in platen if r.test == "creep" and len(r.breakages["time_s"])]
    yield draw_damage, creep if len({r.scene["Loading/Axial stress"] for r in creep}) > 1 else []
    yield draw_compliance, [r for r in linear if r.test == "creep"]
    yield draw_modulus, [r for r in linear if r.modulus]
    shifted = temperature_figures.comparable(results)
    yield temperature_figures.draw_reduced_time, [r for r in shifted if r.creeps]
    yield temperature_figures.draw_master_curve, [r for r in shifted if r in linear and r.modulus]


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
