#!/usr/bin/python3
"""Figures of a fitted law: curve with its errors, and complex modulus.

usage: fit.py FOLDER

Reads curve.csv and residuals.csv in the folder, writes fit.png and, for a dynamic modulus with phase
angles, complex_modulus.png beside them and prints their paths.
"""
import csv
import functools
import logging
import os
import sys
import textwrap
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import matplotlib
    import numpy as np
    from matplotlib.figure import Figure

    from sheet import DPI, STYLE, WIDTH, log_label
    from results import COLOURS
except ImportError as problem:
    sys.exit(f"fit.py: {problem}")

MARKERS = "osD^vP*X"


def read(file):
    """Comment lines `# key = value` and columns of a table; cells that are no numbers are NaN."""
    lines = file.read_text().splitlines()
    about = dict(line[2:].split(" = ", 1) for line in lines if line.startswith("# "))
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    if not rows:
        raise ValueError(f"{file}: there are no rows in it")
    columns = {}
    for key in rows[0]:
        values = [row[key] for row in rows]
        try:
            columns[key] = np.array([float(v) if v else np.nan for v in values])
        except ValueError:
            columns[key] = np.array(values)
    return about, columns


def groups(points):
    """Points of one temperature: mask, look and name."""
    temperatures = np.unique(points["temperature [degC]"])
    for k, temperature in enumerate(temperatures):
        look = {"color": COLOURS[k % len(COLOURS)], "marker": MARKERS[k % len(MARKERS)]}
        yield points["temperature [degC]"] == temperature, look, f"{temperature:g} °C"


def column(table, *parts):
    """Name of the first column that begins with one of some words."""
    return next(key for key in table if any(key.startswith(part) for part in parts))


def save(figure, path, about, note):
    reference = about["reference temperature [degC]"]
    lines = textwrap.wrap(f"{note} Form {about['form']}, shift {about['shift']}, reference "
                          f"temperature {reference} °C.", 180)
    width, height = figure.get_size_inches()
    figure.text(0.95 / width, 1 - 0.15 / height, about["title"], va="top", size=12, weight="bold",
                parse_math=False)
    figure.text(0.1 / width, 0.08 / height, "\n".join(lines), size=7.5, color="0.3",
                parse_math=False)
    part = path.with_name(path.name + ".part")
    try:
        figure.savefig(part, format="png")
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    print(path)


def draw_fit(about, curve, points, folder):
    """Measured and fitted curve over reduced time or frequency; errors below."""
    at = column(curve, "reduced")
    axis = at.removeprefix("reduced ") if about["shift"] == "none" else at
    quantity = column(curve, "creep", "relaxation", "dynamic")
    with_phase = not np.isnan(points["phase angle [deg]"]).all()
    figure = Figure(figsize=(WIDTH, 6.4), dpi=DPI)
    panels = figure.subplots(2, 1 + with_phase, sharex=True, squeeze=False,
                             gridspec_kw={"height_ratios": (2.4, 1), "left": 0.095, "right": 0.975,
                                          "bottom": 0.125, "top": 0.87, "wspace": 0.24,
                                          "hspace": 0.08})
    for k, (name, fitted) in enumerate([(quantity, "fitted " + quantity),
                                        ("phase angle [deg]", "fitted phase angle [deg]")]):
        if k > with_phase:
            break
        upper, lower = panels[:, k]
        upper.plot(curve[at], curve[name], color="0.2", label="fit" if k == 0 else None, zorder=1)
        if not np.allclose(curve[name], curve["series " + name], rtol=1e-6):
            upper.plot(curve[at], curve["series " + name], color="0.2", ls=":", zorder=1,
                       label="series in the law file" if k == 0 else None)
        for mask, look, label in groups(points):
            error = (points["error [%]"] if k == 0 else points[fitted] - points[name])[mask]
            upper.plot(points[at][mask], points[name][mask], ls="", ms=5, label=label, **look)
            lower.plot(points[at][mask], error, ls="", ms=4, **look)
        upper.set(ylabel=name[0].upper() + name[1:], xscale="log",
                  yscale="log" if k == 0 else "linear")
        low, high = upper.get_ylim()
        if k == 0 and high < 50 * low:  # few powers of ten to be labels
            label = functools.partial(log_label, form="{:g}", every=high < 5 * low)
            upper.yaxis.set_major_formatter(label)
            upper.yaxis.set_minor_formatter(label)
        lower.axhline(0, color="0.2", lw=1)
        lower.set(xlabel=axis[0].upper() + axis[1:],
                  ylabel="Error [%]" if k == 0 else "Error [deg]")
        limit = 1.15 * max(abs(v) for v in lower.get_ylim())
        lower.set_ylim(-limit, limit)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, ncol=8, loc="upper left", borderaxespad=0, borderpad=0,
                  bbox_to_anchor=(0.095, 1 - 0.5 / 6.4))
    save(figure, folder / "fit.png", about, "Points: measured. Errors: fit minus measured.")


def draw_complex_modulus(about, curve, points, folder):
    """Cole-Cole and Black diagrams."""
    name, fitted = column(curve, "dynamic"), "phase angle [deg]"
    figure = Figure(figsize=(WIDTH, 5), dpi=DPI)
    cole, black = figure.subplots(1, 2, gridspec_kw={"left": 0.095, "right": 0.975, "bottom": 0.16,
                                                     "top": 0.84, "wspace": 0.24})
    angle = np.radians(curve[fitted])
    cole.plot(curve[name] * np.cos(angle), curve[name] * np.sin(angle), color="0.2", label="fit",
              zorder=1)
    black.plot(curve[fitted], curve[name], color="0.2", zorder=1)
    for mask, look, label in groups(points):
        modulus, angle = points[name][mask], np.radians(points[fitted][mask])
        cole.plot(modulus * np.cos(angle), modulus * np.sin(angle), ls="", ms=5, label=label, **look)
        black.plot(points[fitted][mask], modulus, ls="", ms=5, **look)
    cole.set(xlabel="Storage modulus E′ [MPa]", ylabel="Loss modulus E″ [MPa]")
    cole.set_xlim(0)
    cole.set_ylim(0)
    black.set(xlabel="Phase angle [deg]", ylabel="Dynamic modulus |E*| [MPa]", yscale="log")
    figure.legend(*cole.get_legend_handles_labels(), ncol=8, loc="upper left", borderaxespad=0,
                  borderpad=0, bbox_to_anchor=(0.095, 1 - 0.5 / 5))
    save(figure, folder / "complex_modulus.png", about,
         "Left: Cole-Cole diagram; right: Black diagram. Points: measured.")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__.split("\n\n")[1])
    folder = Path(arguments[0])
    try:
        about, curve = read(folder / "curve.csv")
        _, points = read(folder / "residuals.csv")
        with matplotlib.rc_context(STYLE):
            draw_fit(about, curve, points, folder)
            if "dynamic modulus [MPa]" in curve and not np.isnan(points["phase angle [deg]"]).all():
                draw_complex_modulus(about, curve, points, folder)
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"fit.py: {problem}")


if __name__ == "__main__":
    main(sys.argv[1:])
