#!/usr/bin/python3
"""Figure of a study of solvers: wall time against error, one line for each solver and knob.

usage: work_precision.py FOLDER

Reads study.csv in the folder, writes work_precision.png beside it and prints its path.
"""
import csv
import logging
import os
import sys
import textwrap
import warnings
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import matplotlib
    from matplotlib.figure import Figure

    from sheet import DPI, STYLE, WIDTH
    from results import COLOURS
except ImportError as problem:
    sys.exit(f"work_precision.py: {problem}")

ACCURACIES = (10, 1, 0.1)  # [%]
FLOOR, CEILING = 1e-4, 1e3  # errors beyond are drawn there [%]
LOOKS = {("linear", ""): (COLOURS[0], "s"), ("events", ""): (COLOURS[1], "D"),
         ("quasistatic", "strain per step"): (COLOURS[2], "o"),
         ("quasistatic", "breakage batch"): (COLOURS[3], "^"),
         ("quasistatic", "finest strain per step"): (COLOURS[2], "*"),
         ("dynamic", "viscosity scaling"): (COLOURS[4], "v")}
SYMBOLS = {"viscosity scaling": "x = ", "breakage batch": "batch ", "strain per step": "step ",
           "finest strain per step": "step "}


def read(file):
    """Rows of a study with their numbers; empty cells are None."""
    rows = []
    for row in csv.DictReader(file.read_text().splitlines()):
        for key in ("solver_wall_time_s", "largest_error_percent", "value",
                    "left_out_by_reference_percent"):
            row[key] = float(row[key]) if row[key] else None
        rows.append(row)
    if not rows:
        raise ValueError(f"{file}: there are no runs in it")
    return rows


def ladders(rows):
    """Rows that can be drawn, by solver and knob: those with a time and an error."""
    found = {}
    for row in rows:
        if row["solver_wall_time_s"] and row["largest_error_percent"] is not None:
            found.setdefault((row["solver"], row["knob"]), []).append(row)
    return found


def drawn_error(row):
    return min(max(row["largest_error_percent"], FLOOR), CEILING)


def same_rupture(row):
    """Whether specimen and reference both rupture, or neither does."""
    return row["which_rupture"] in ("both", "neither")


def draw_ladder(axes, key, rows):
    """One solver over its knob, each point with the knob's value."""
    solver, knob = key
    colour, marker = LOOKS.get(key, ("0.3", "x"))
    measured = [row for row in rows if row["is_reference"] == "0"]
    time = [row["solver_wall_time_s"] for row in measured]
    error = [drawn_error(row) for row in measured]
    axes.plot(time, error, "-", color=colour, lw=1.6, zorder=2)
    for row, t, e in zip(measured, time, error):
        axes.plot(t, e, marker, color=colour if same_rupture(row) else "white", mec=colour, ms=7,
                  zorder=3)
        if row["value"] is not None:
            axes.annotate(f"{SYMBOLS.get(knob, '')}{row['value']:g}", (t, e), xytext=(6, 4),
                          textcoords="offset points", size=7.5, color=colour)
    if measured:
        name = f"{solver}, {knob}" if knob else solver
        axes.plot([], [], marker + ("-" if knob else ""), color=colour, ms=7, label=name)


def draw_marks(axes, rows):
    """The accuracies, a ring around the cheapest setting for each, and the reference."""
    for accuracy in ACCURACIES:
        axes.axhline(accuracy, color="0.45", lw=1, ls="--", zorder=1)
        axes.annotate(f"{accuracy:g} %", (1, accuracy), xycoords=("axes fraction", "data"),
                      xytext=(4, -3), textcoords="offset points", size=9, color="0.3")
    for row in rows:
        if row["cheapest_for"] and row["is_reference"] == "0":
            axes.plot(row["solver_wall_time_s"], drawn_error(row), "o", ms=14, mfc="none",
                      mec="black", mew=1.2, zorder=4)
    for row in rows:
        if row["is_reference"] == "1" and row["solver_wall_time_s"]:
            axes.axvline(row["solver_wall_time_s"], color="black", lw=1.2, ls=":", zorder=1,
                         label=f"reference: {row['reference']}, {row['solver_wall_time_s']:.3g} s")
            break


def draw_reach(axes, rows):
    """Errors that may be what the reference leaves out."""
    left_out = rows[0]["left_out_by_reference_percent"]
    if left_out and left_out > FLOOR:
        axes.axhspan(FLOOR / 10, left_out, color="0.93", zorder=0,
                     label=f"below the largest strain, {left_out:.2g} %: geometry that the "
                           "reference leaves out matters")


def notes(rows):
    """Small print: what is not in the figure, and what was measured how."""
    quantity = next((row["quantity"] for row in rows if row["quantity"]), "strain")
    text = [f"Error: largest difference of the {quantity} over the history times that both reached, "
            f"over the largest {quantity}. Time: of the solver, without packing, bonding and output. "
            "Ring: cheapest setting for a mark."]
    if any(not same_rupture(row) for row in rows if row["which_rupture"]):
        text.append("Open symbol: ruptures where the reference does not, or the other way round.")
    if any(row["largest_error_percent"] is not None and row["is_reference"] == "0"
           and row["largest_error_percent"] < FLOOR for row in rows):
        text.append(f"Errors below {FLOOR:g} % are drawn there.")
    text += [f"Cheapest for {row['cheapest_for'].replace(';', ',')}: the reference itself."
             for row in rows if row["is_reference"] == "1" and row["cheapest_for"]]
    missing = {}
    for row in rows:
        if row["state"] != "finished":
            name = row["solver"] if row["state"] == "does not apply" else (
                f"{row['solver']}, {row['knob']} {row['value'] or 0:g}")
            missing.setdefault(row["state"], []).append(name)
    text += [f"{state.capitalize()}: {'; '.join(names)}." for state, names in missing.items()]
    row = rows[0]
    text.append(f"{row['machine']}, {row['threads']} thread(s), {row['program']} "
                f"({row['revision']}), {next((r['bonds'] for r in rows if r['bonds']), '?')} bonds.")
    return [part for line in text for part in textwrap.wrap(line, 165)]


def draw(rows):
    """The figure of a study."""
    lines = notes(rows)
    height = 6.2 + 0.14 * len(lines)
    figure = Figure(figsize=(WIDTH, height), dpi=DPI)
    below = 0.75 + 0.14 * len(lines)
    axes = figure.add_axes([0.085, below / height, 0.855, (height - below - 1.25) / height])
    axes.set(xscale="log", yscale="log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_major_formatter("{x:g}")
    for key, ladder in ladders(rows).items():
        draw_ladder(axes, key, ladder)
    draw_marks(axes, rows)
    errors = [drawn_error(row) for ladder in ladders(rows).values() for row in ladder
              if row["is_reference"] == "0"]
    axes.set_ylim(min(errors + [ACCURACIES[-1]]) / 3, 3 * max(errors + [ACCURACIES[0]]))
    draw_reach(axes, rows)
    axes.margins(x=0.12)
    quantity = next((row["quantity"] for row in rows if row["quantity"]), "strain")
    axes.set(xlabel="Wall time of the solver [s]", ylabel=f"Error in {quantity} [%]")
    figure.text(0.085, 1 - 0.15 / height, f"Speed against error: {rows[0]['scene']}", va="top",
                size=12, weight="bold", parse_math=False)
    figure.text(0.01, 0.08 / height, "\n".join(lines), size=7.5, color="0.3", parse_math=False)
    figure.legend(*axes.get_legend_handles_labels(), ncol=2, alignment="left", loc="upper left",
                  borderaxespad=0, borderpad=0, bbox_to_anchor=(0.085, 1 - 0.45 / height), fontsize=9)
    return figure


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: work_precision.py FOLDER")
    warnings.simplefilter("ignore")  # on standard error too
    matplotlib.rcParams.update(STYLE)
    folder = Path(sys.argv[1])
    path, part = folder / "work_precision.png", folder / "work_precision.png.part"
    try:
        rows = read(folder / "study.csv")
        draw(rows).savefig(part, format="png")
        os.replace(part, path)
        print(path)
    except Exception as error:  # the caller shows one line
        kind = "" if isinstance(error, (OSError, ValueError)) else f"{type(error).__name__}: "
        sys.exit(f"work_precision.py: {kind}{' '.join(str(error).split())}")
    finally:
        part.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
