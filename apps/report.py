#!/usr/bin/python3
"""One self-contained HTML page of results: figures, tables, statements, provenance.

usage: report.py FILE.html FOLDER...

A FOLDER holds a result, a study, or folders with such. Figures are those that are there. The path of
the page is printed. The page asks nothing of any other computer.
"""
import base64
import csv
import datetime
import html
import sys
import warnings
from pathlib import Path

from plot import replaced  # says what is missing, should it be

import numpy as np
import statements
from results import Result, bodies, joined, seeds
from run_summary import NOT_KEYS, read_runs

STYLE = (Path(__file__).resolve().parent / "report.css").read_text(encoding="utf-8")
CAPTIONS = {
    "strain_time_band": "Strain over time of all runs, median and band of each group.",
    "breakage_band": "Broken bonds over time, and how fast they break up to rupture.",
    "rupture_times": "Rupture times of all runs, and their distributions.",
    "stress_strain_band": "Stress over strain of all runs; largest stress over strain rate.",
    "strain_time": "Strain over time.", "strain_rate": "Rate of strain, with flow times.",
    "displacement_time": "Displacement over time.", "displacement_rate": "Rate of displacement.",
    "breakage": "Broken bonds and their rate.", "stress_strain": "Stress over strain.",
    "strain_reduced_time": "Strain over reduced time.", "master_curve": "Master curve of the modulus.",
    "complex_modulus": "Complex modulus and phase angle.", "permanent_strain": "Permanent strain over cycles.",
    "compliance": "Creep compliance.", "compliance_growth": "Compliance over broken bonds.",
    "energy": "Where the work of the loads went.", "damage": "Minimum creep rate and rupture time.",
    "specimen_packing": "The particles.", "specimen_forces": "Forces in the bonds.",
    "specimen_broken": "Bonds that broke, by time."}
QUANTITIES = {
    "share_ruptured": ("share of runs that ruptured", 1, ""),
    "rupture_time_s": ("rupture time", 1, "s"), "flow_time_s": ("flow time", 1, "s"),
    "strain_at_common_time_percent": ("strain at the common time", 1, "%"),
    "displacement_at_common_time_mm": ("displacement at the common time", 1, "mm"),
    "broken_bonds_at_common_time": ("broken bonds at the common time", 1, ""),
    "minimum_creep_rate_per_s": ("minimum creep rate", 1, "1/s"),
    "largest_stress_kPa": ("largest stress", 1e-3, "MPa"),
    "strain_at_largest_stress_percent": ("strain at the largest stress", 1, "%")}


def text(value):
    """A text within HTML, in attributes too."""
    return html.escape(str(value))


def number(value, digits=3):
    """A number to read; 'none' for what is infinite, a dash for what is not known."""
    if value == "" or np.isnan(float(value)):
        return "\u2013"
    return "none" if np.isinf(float(value)) else f"{float(value):.{digits}g}"


def table(head, rows, kind=""):
    """A table of texts that are HTML already."""
    lines = ["<tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    return f'<div class="wide"><table class="{kind}">' + "\n".join(lines) + "</table></div>"


def figure(file):
    """A picture within the page."""
    data = base64.b64encode(file.read_bytes()).decode()
    caption = CAPTIONS.get(file.stem, file.stem.replace("_", " "))
    return (f'<figure><img src="data:image/png;base64,{data}" alt="{text(caption)}">'
            f"<figcaption>{text(caption)}</figcaption></figure>")


def figures(folder):
    """All figures of a folder, the known ones first."""
    order = list(CAPTIONS)
    shown = [file for file in Path(folder).glob("*.png") if file.stem != "specimen"]  # its parts are there
    files = sorted(shown, key=lambda f: (
        order.index(f.stem) if f.stem in order else len(order), f.stem))
    return "\n".join(figure(file) for file in files)


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as opened:
        return list(csv.DictReader(opened))


def statistics_table(folder):
    """Median, interval and spread of each quantity in each group."""
    rows = []
    for row in rows_of(folder / "statistics.csv"):
        if row["quantity"] not in QUANTITIES:
            continue  # such as how many failed: told elsewhere
        name, factor, unit = QUANTITIES[row["quantity"]]
        value, low, high = (number(float(row[c]) * factor) if row[c] else "\u2013"
                            for c in ("median", "interval_low", "interval_high"))
        spread = row["standard_deviation_of_ln"]
        level = f"{100 * float(row['interval_level']):.3g} %" if row["interval_level"] else ""
        label = next(iter(row.values()))
        rows.append((text(label), f"{name} [{unit}]" if unit else name, row["runs"], value,
                     f"{low} to {high}" if level else "\u2013", level or "\u2013",
                     f"{100 * float(spread):.2g} %" if spread else "\u2013"))
    return table(("group", "quantity", "runs", "median", "interval", "level", "scatter"), rows,
                 "numbers") + (
        "<p class='note'>Median over the runs with an interval that holds for any distribution "
        "(shares: Clopper and Pearson). Scatter: standard deviation of the logarithm. Rupture: loss of "
        "equilibrium, or the strain limit; one that did not come counts as later than all others "
        "(\u2018none\u2019), and is not in the scatter. Flow times and least rates are those of the runs "
        "that show one.</p>")


def variance_table(folder):
    """Which factor explains the scatter."""
    rows = []
    for row in rows_of(folder / "variance.csv"):
        if row["source"] == "residual" or not row["p"]:
            continue
        name = QUANTITIES.get(row["quantity"], (row["quantity"],))[0]
        p = float(row["p"])
        rows.append((text(next(iter(row.values()))), name, text(row["source"]),
                     row["degrees_of_freedom"], number(row["F"]),
                     f"<b>{p:.2g}</b>" if p < 0.05 else f"{p:.2g}"))
    if not rows:
        return ""
    return "<h3>What the scatter comes from</h3>" + table(
        ("group", "quantity", "source", "degrees of freedom", "F", "p"), rows, "numbers") + (
        "<p class='note'>Analysis of variance of the logarithms, main effects, each beyond all the "
        "others. Bold: p below 0.05. With so many tests one in twenty is below 0.05 by chance.</p>")


def varied_keys(folder):
    """What the runs of a study differ in."""
    return [key for key in rows_of(folder / "runs.csv")[0] if key not in NOT_KEYS]


def runs_table(folder):
    """All runs, folded."""
    rows = rows_of(folder / "summary.csv")
    keys = varied_keys(folder)
    columns = [c for c in ("rupture_time_s", "flow_time_s", "strain_at_end_percent",
                           "largest_stress_kPa", "broken_bonds", "wall_time_s")
               if any(row[c] for row in rows)]
    body = [[*(text(row[key]) for key in keys), text(row["end"]),
             *(number(row[c], 4) for c in columns)] for row in rows]
    head = [*(text(key.split("/")[-1] if key != "Specimen/Seed" else "Packing seed")
              for key in keys), "end", *(text(c.replace("_", " ")) for c in columns)]
    return f"<details><summary>All {len(rows)} runs</summary>{table(head, body, 'numbers')}</details>"


def failures(folder):
    """Runs that have no result, with the reason."""
    rows = [(int(row["exit_code"]), (text(row["run"]), row["exit_code"], text(row["statement"])))
            for row in rows_of(folder / "runs.csv")]
    head = ("run", "exit code", "why")
    failed = [row for code, row in rows if code not in (-1, 0, 1, 4, 5)]
    open_ones = [row for code, row in rows if code in (-1, 4)]
    return ("<h3>Runs that failed</h3>" + table(head, failed) if failed else "") + (
        "<h3>Runs that have not finished</h3>" + table(head, open_ones) if open_ones else "")


def scene_of(file):
    return (f"<details><summary>The scene, all keys</summary><pre>"
            f"{text(file.read_text(encoding='utf-8'))}</pre></details>") if file.is_file() else ""


def origin(results):
    """Where numbers come from."""
    if not results:
        return ""
    about = [r.about for r in results]
    estimates = dict.fromkeys(n for a in about if a["estimated_values"] != "none"
                              for n in a["estimated_values"].split(", "))
    rows = [("program", joined(f"{a['program']} ({a['revision']})" for a in about)),
            ("solver", joined(f"{a['solver']}: {a['solver_reason']}" for a in about)),
            ("written", joined([max(str(a["written_utc"]) for a in about)])),
            ("specimen", joined(bodies(r) for r in results)),
            ("seeds", joined(seeds(r) for r in results)),
            ("estimated values", ", ".join(estimates) or "none"),
            ("time of the solver", f"{sum(float(a['wall_time_s']) for a in about):.4g} s in all, "
             f"{len(results)} run{'s' * (len(results) > 1)}")]
    return table(("", ""), [(text(a), text(b)) for a, b in rows], "origin")


def study_section(folder):
    """A study: what was varied, statistics, figures, runs."""
    runs = read_runs(folder)
    results = [run.result for run in runs if run.result]
    title = joined(r.about["title"] for r in results) or folder.name
    parts = [f"<h2>{text(title)}</h2>",
             f"<p>{len(runs)} runs, {len(results)} with a result. Varied: "
             f"{text(', '.join(varied_keys(folder)))}.</p>", failures(folder)]
    if (folder / "statistics.csv").is_file():
        parts += [figures(folder), "<h3>In numbers</h3>", statistics_table(folder),
                  variance_table(folder), runs_table(folder)]
    else:
        parts += [figures(folder)]
    parts += ["<h3>Where it comes from</h3>", origin(results), scene_of(folder / "study.scene")]
    return "\n".join(parts)


def result_section(folder):
    """A single run."""
    r = Result(folder)
    facts = [("end", f"{r.about['end']} at {r.end:.6g} s" + (
        f": {r.about['end_reason']}" if r.about["end_reason"] else ""))]
    if r.strain is not None:
        facts.append(("strain at the end", f"{r.strain[-1]:.4g} %"))
    if r.of_particles:
        facts.append(("broken bonds", f"{len(r.breakages['time_s'])} of {r.n_bonds}"))
    scene = (f"<details><summary>The scene, all keys</summary><pre>"
             f"{text(chr(10).join(f'{k} = {v}' for k, v in r.scene.items()))}</pre></details>")
    told = table(("", ""), [(text(a), text(b)) for a, b in facts], "origin")
    return "\n".join([f"<h2>{text(r.about['title'] or folder.name)}</h2>", told,
                      figures(folder), "<h3>Where it comes from</h3>", origin([r]), scene])


def statements_section(folders):
    """Statements of the replicated paper, met or not."""
    try:
        rows = [row for folder in folders for row in statements.all_statements(folder)]
    except Exception as problem:
        return ('<section id="statements"><h2>Statements of the paper</h2><p>They cannot be judged: '
                f"{text(' '.join(str(problem).split()))}</p></section>")
    if not rows:
        return ""
    met = sum(bool(row.met) for row in rows)
    verdicts = {True: ("met", "met"), False: ("not", "not met"), None: ("open", "not tested")}
    body = [(text(row.statement), text(row.measured),
             '<span class="{}">{}</span>'.format(*verdicts[row.met])) for row in rows]
    return ('<section id="statements"><h2>Statements of the paper</h2>'
            f"<p>{met} of {len(rows)} are met.</p>" + table(
                ("statement", "measured", ""), body, "statements") +
            "<p class='note'>The creep constants are estimates, not the paper\u2019s tables: a statement "
            "that is not met may speak against the constants, the solver or the model.</p></section>")


def parts_of(folder):
    """Studies and single results in a folder, outermost first."""
    if (folder / "runs.csv").is_file():
        return [(folder, study_section)]
    if (folder / "result.h5").is_file():
        return [(folder, result_section)]
    return [part for inner in sorted(folder.iterdir()) if inner.is_dir() for part in parts_of(inner)]


def section(number, folder, make):
    """A section of the page; what is wrong with one does not end the others."""
    try:
        inner = make(folder)
    except Exception as problem:
        inner = (f"<h2>{text(folder.name)}</h2><p>Nothing can be told of it: "
                 f"{text(' '.join(str(problem).split()))}</p>")
    return f'<section id="part-{number}">{inner}</section>'


def page(folders):
    """The whole page as HTML."""
    parts = [part for folder in folders for part in parts_of(folder)]
    names = [folder.name for folder, _ in parts]
    names = [f"{folder.parent.name}/{folder.name}" if names.count(folder.name) > 1 else folder.name
             for folder, _ in parts]
    if not parts:
        raise ValueError(f"{joined(map(str, folders))}: there are no results in it")
    parents = {folder.resolve().parent for folder in folders}
    together = len(folders) > 1 and len(parents) == 1
    title = "Report: " + (parents.pop().name if together
                          else joined(folder.resolve().name for folder in folders))
    links = "".join(f'<a href="#part-{k + 1}">{text(name)}</a> ' for k, name in enumerate(names))
    now = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    said = statements_section(folders)
    return "\n".join([
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{text(title)}</title><style>{STYLE}</style></head><body><main>",
        f"<h1>{text(title)}</h1><p class='note'>Written by Mastic, {now}. Compression is positive.</p>",
        f"<nav>{'<a href=#statements>statements</a> ' if said else ''}{links}</nav>", said,
        *(section(k + 1, folder, make) for k, (folder, make) in enumerate(parts)),
        "</main></body></html>"])


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: report.py FILE.html FOLDER...")
    warnings.simplefilter("ignore")  # on standard error too
    file = Path(sys.argv[1])
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        replaced(file, page([Path(each) for each in sys.argv[2:]]))
    except Exception as error:  # the caller shows one line
        kind = "" if isinstance(error, (OSError, ValueError)) else f"{type(error).__name__}: "
        sys.exit(f"report.py: {kind}{' '.join(str(error).split())}")
    print(file)


if __name__ == "__main__":
    main()
