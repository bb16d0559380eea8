#!/usr/bin/python3
"""Figure of a calibrated bond law.

usage: calibration.py FOLDER

Reads check.csv and branches.csv in FOLDER, writes calibration.png there and prints its path.
"""
import logging
import sys
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import matplotlib
    from extraction import STYLE, save, table
    from matplotlib.figure import Figure
except ImportError as problem:
    sys.exit(f"calibration.py: {problem}")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    folder = Path(sys.argv[1])
    check, ladder = table(folder / "check.csv"), table(folder / "branches.csv")
    names = list(check)
    at, measured, packing = names[:3]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12, 4.4))
        curve, error, branches = figure.subplots(1, 3)
        curve.loglog(check[at], check[measured], "ko", mfc="white", label="measured")
        order = sorted(range(len(check[at])), key=lambda k: check[at][k])
        curve.loglog([check[at][k] for k in order], [check[packing][k] for k in order],
                     ".:", lw=1, label="packing, calibrated law")
        curve.legend()
        error.semilogx(check[at], check["error_percent"], "o")
        error.axhline(0, color="k", lw=0.8)
        axis = "Reduced time [s]" if at.endswith("_s") else "Reduced frequency [Hz]"
        unit = "1/GPa" if "per_GPa" in measured else "MPa"
        name = measured.split("_", 1)[1].rsplit("_", 1)[0].replace("_per", "").replace("_", " ")
        curve.set(xlabel=axis, ylabel=f"{name[0].upper()}{name[1:]} [{unit}]")
        error.set(xlabel=axis, ylabel="Error of the packing [%]")
        branches.semilogy(ladder["kelvin_branches_asked"], ladder["rms_error_percent"], "o-", label="rms")
        branches.semilogy(ladder["kelvin_branches_asked"], ladder["largest_error_percent"], "s--",
                          label="largest")
        branches.set(xlabel="Kelvin branches of a bond", ylabel="Error [%]",
                     xticks=ladder["kelvin_branches_asked"])
        branches.legend()
        save(figure, folder / "calibration.png")


if __name__ == "__main__":
    main()
