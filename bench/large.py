#!/usr/bin/env python3
"""Elastic solution of intact specimens of growing size on one thread: iteration and factor.

Every row is a process of its own, so that its peak memory is its own. Packings are made once by
radius expansion, like those of `mastic pack`, and kept; 600,000 spheres take 20 minutes.
"""
import argparse
import math
import os
import pathlib
import subprocess
import sys

from report import machine, print_table, today

repository = pathlib.Path(__file__).resolve().parent.parent
limit_seconds, limit_memory, limit_spheres = 180, 10, 600000


def solved(program, folder, n_spheres, factor):
    """What one run printed, as numbers by name."""
    command = [program, str(n_spheres), "--packing", folder / f"spheres-{n_spheres}.h5"]
    text = subprocess.run([*command, *(["--factor"] if factor else [])], check=True,
                          stdout=subprocess.PIPE, text=True,
                          env={**os.environ, "OMP_NUM_THREADS": "1"}).stdout
    words = dict(line.split() for line in text.splitlines())
    return {name: word if name == "solver" else float(word) for name, word in words.items()}


def row(run, error):
    return [run["solver"], *(f"{run[name]:.0f}" for name in ("spheres", "bonds", "unknowns")),
            *(f"{run[name]:.2f}" for name in ("network_s", "set_up_s", "solution_s", "total_s", "wall_s")),
            f"{run['iterations']:.0f}", f"{run['residual']:.0e}", error, f"{run['memory_GiB']:.2f}",
            f"{run['others']:.2f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path,
                        default=repository / "build" / "bin" / "bench_large")
    parser.add_argument("--packings", type=pathlib.Path, default=repository / "build" / "packings")
    parser.add_argument("--spheres", type=int, nargs="+", default=[6000, 60000, 200000, 600000])
    parser.add_argument("--factor-up-to", type=int, default=60000,
                        help="200000 takes 16 GiB and minutes")
    arguments = parser.parse_args()
    if not arguments.program.exists():
        sys.exit(f"error: {arguments.program} is missing: build with -DMASTIC_BENCH=ON first")
    print(f"{today()}; {machine()}\n1 thread\n")
    rows, points = [], []
    for n in arguments.spheres:
        run = solved(arguments.program, arguments.packings, n, factor=False)
        points.append(run)
        error = "-"
        if n <= arguments.factor_up_to:
            exact = solved(arguments.program, arguments.packings, n, factor=True)
            rows.append(row(exact, "-"))
            compliance = exact["compliance_m_per_N"]
            error = f"{abs(run['compliance_m_per_N'] / compliance - 1):.0e}"
        rows.append(row(run, error))
        print(f"measured: {n}", file=sys.stderr, flush=True)
    print_table(["solver", "spheres", "bonds", "unknowns", "network s", "set-up s", "solution s",
                 "total s", "wall s", "iterations", "residual", "error", "GiB", "others"], rows)
    print("\nseconds of processor time but for the wall; network: bonds and their stiffness; set-up: "
          "matrix\nand multigrid; total: with the bond forces\nerror: of the compliance, against the factor; others: processors busy with other "
          "programs")
    first, last = points[0], points[-1]
    if last["spheres"] > first["spheres"]:
        growth = (math.log(last["total_s"] / first["total_s"])
                  / math.log(last["spheres"] / first["spheres"]))
        print(f"iteration: seconds ~ n^{growth:.2f}")
    if last["spheres"] == limit_spheres:
        met = last["wall_s"] <= limit_seconds and last["memory_GiB"] <= limit_memory
        print(f"target for {limit_spheres} spheres: {limit_seconds} s wall and {limit_memory} GiB, "
              f"{'met' if met else 'NOT MET'}")


if __name__ == "__main__":
    main()
