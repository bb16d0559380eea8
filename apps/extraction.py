#!/usr/bin/python3
"""Figures of a law taken from volume elements.

usage: extraction.py FOLDER

Reads compliance.csv, complex_modulus.csv and realisations.csv in FOLDER, writes creep_compliance.png,
complex_modulus.png and volume_elements.png there and prints their paths, one a line.
"""
import csv
import logging
import os
import sys
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import matplotlib
    from matplotlib.figure import Figure
except ImportError as problem:
    sys.exit(f"extraction.py: {problem}")

STYLE = {"axes.grid": True, "grid.color": "0.88", "axes.axisbelow": True, "lines.linewidth": 1.6,
         "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False}
CONDITIONS = {"affine": "affine (no particle relaxes)", "kinematic": "kinematic",
              "periodic": "periodic", "uniform_traction": "uniform traction"}
DPI = 160


def table(path):
    """Columns of a CSV as lists of numbers; empty cells are not numbers."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) if row[name] else float("nan") for row in rows]
            for name in rows[0]}


def save(figure, path):
    """Writes under a temporary name, renames, prints the name."""
    part = path.with_suffix(".part.png")
    figure.tight_layout(rect=(0, 0, 1, 0.93 if figure.legends else 1))
    figure.savefig(part, dpi=DPI)
    os.replace(part, path)
    print(path)


def draw_compliance(folder):
    data = table(folder / "compliance.csv")
    figure = Figure(figsize=(10, 4.6))
    left, right = figure.subplots(1, 2)
    time = data["time_s"][1:]  # the first is 0
    left.loglog(time, data["uniaxial_compliance_isotropic_per_GPa"][1:], color="0.75", lw=5,
                label="nearest isotropic")
    for axis in "123":
        left.loglog(time, data[f"uniaxial_compliance_{axis}_per_GPa"][1:], "--", label=f"along {axis}")
    left.set(xlabel="Time [s]", ylabel="Uniaxial creep compliance D(t) [1/GPa]")
    left.legend()
    right.semilogx(time, data["poisson_ratio"][1:], "k")
    right.set(xlabel="Time [s]", ylabel="Creep Poisson's ratio, nearest isotropic [-]")
    right.ticklabel_format(axis="y", useOffset=False)
    save(figure, folder / "creep_compliance.png")


def draw_modulus(folder):
    data = table(folder / "complex_modulus.csv")
    if not data["frequency_Hz"]:
        return
    figure = Figure(figsize=(11, 8.4))
    (modulus, phase), (cole, black) = figure.subplots(2, 2)
    temperatures = sorted(set(data["temperature_degC"]))
    for number, temperature in enumerate(temperatures):
        rows = [k for k, t in enumerate(data["temperature_degC"]) if t == temperature]
        def column(name):
            return [data[name][k] for k in rows]
        look = {"marker": "os^dv<>"[number % 7], "color": f"C{number}", "label": f"{temperature:g} °C",
                "markersize": 6 if len(rows) <= 10 else 4}
        modulus.loglog(column("reduced_frequency_Hz"), column("dynamic_modulus_MPa"), **look)
        phase.semilogx(column("reduced_frequency_Hz"), column("phase_angle_deg"), **look)
        cole.plot(column("storage_modulus_MPa"), column("loss_modulus_MPa"), **look)
        black.semilogy(column("phase_angle_deg"), column("dynamic_modulus_MPa"), **look)
    modulus.set(xlabel="Reduced frequency [Hz]", ylabel="|E*| [MPa]", title="Modulus, master curve")
    phase.set(xlabel="Reduced frequency [Hz]", ylabel="Phase angle [deg]", title="Phase angle, master curve")
    cole.set(xlabel="E' [MPa]", ylabel="E'' [MPa]", title="Cole-Cole diagram")
    black.set(xlabel="Phase angle [deg]", ylabel="|E*| [MPa]", title="Black diagram")
    modulus.legend()
    save(figure, folder / "complex_modulus.png")


def draw_elements(folder):
    data = table(folder / "realisations.csv")
    figure = Figure(figsize=(10, 4.6))
    young, poisson = figure.subplots(1, 2)
    for number, (name, label) in enumerate(CONDITIONS.items()):
        if all(value != value for value in data[f"{name}_young_MPa"]):
            continue
        look = {"marker": "vsox"[number], "color": f"C{number}", "linestyle": "", "label": label}
        young.plot(data["spheres"], data[f"{name}_young_MPa"], **look)
        poisson.plot(data["spheres"], data[f"{name}_poisson"], **look)
    for axes, text in ((young, "Young's modulus at t = 0+ [MPa]"), (poisson, "Poisson's ratio [-]")):
        axes.set(xlabel="Spheres in the volume element", ylabel=text)
        sizes = sorted(set(data["spheres"]))
        if len(sizes) > 1:
            axes.set_xscale("log")
        axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axes.minorticks_off()
    figure.legend(*young.get_legend_handles_labels(), loc="upper center", ncols=4)
    save(figure, folder / "volume_elements.png")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    folder = Path(sys.argv[1])
    with matplotlib.rc_context(STYLE):
        draw_compliance(folder)
        draw_modulus(folder)
        draw_elements(folder)


if __name__ == "__main__":
    main()
