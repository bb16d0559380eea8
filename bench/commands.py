#!/usr/bin/env python3
"""Wall time of whole commands, start-up and files included, with what they computed.

Times the program `mastic` itself: D(t) of an intact specimen, a creep test with breakage, packings
of growing size. Every row says what came out, so that a speed stands beside its result.
"""
import argparse
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from report import OtherPrograms, machine, print_table, spread, today

repository = pathlib.Path(__file__).resolve().parent.parent
scene = repository / "scenes" / "creep" / "creep-400.scene"
without_files = ["Output/ParaView = false", "Output/Plots = false"]
linear = ["Solver = linear", "Strength/Distribution = none", "Output/History times = 100"]


class Failed(Exception):
    """A command that did not end well, with its last line."""


def timed(command, threads):
    """Seconds, peak memory [MiB] and text of a command."""
    begin = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               env={**os.environ, "OMP_NUM_THREADS": str(threads)})
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise Failed(f"exit {process.returncode}: {(text.strip().splitlines() or [''])[-1]}")
    return seconds, usage.ru_maxrss / 1024, text


def with_settings(settings):
    return [word for each in settings for word in ("--set", each)]


class Run:
    """`mastic run` of the creep scene on a stored packing."""

    def __init__(self, name, settings, target, repetitions):
        self.name, self.settings, self.target = name, settings, target
        self.repetitions, self.n_particles = repetitions, 6000

    def command(self, program, folder):
        return [program, "run", scene, "--quiet", "--packing", packing_file(folder, 6000),
                *with_settings([*self.settings, f"Output/Folder = {folder / 'result'}"])]

    @staticmethod
    def outcome(text):
        end = re.search(r"strain (\S+) %, (\d+) of (\d+) bonds broken", text)
        return f"strain {end.group(1)} %, {end.group(2)} of {end.group(3)} bonds broken"


class Pack:
    """`mastic pack` of a specimen with as many spheres as asked, of the same sizes."""

    def __init__(self, n_particles, target, repetitions):
        self.name, self.target = f"pack {n_particles} spheres", target
        self.repetitions, self.n_particles = repetitions, n_particles

    def command(self, program, folder):
        scale = (self.n_particles / 6000) ** (1 / 3)
        size = [f"Specimen/Diameter = {60.2 * scale:.6g} mm", f"Specimen/Height = {120.3 * scale:.6g} mm",
                f"Specimen/Particles = {self.n_particles}"] if self.n_particles != 6000 else []
        return [program, "pack", scene, "-o", packing_file(folder, self.n_particles),
                *with_settings(size)]

    @staticmethod
    def outcome(text):
        fraction = re.search(r"solid fraction +(\S+),", text).group(1)
        contacts = re.search(r"mean contact number +(\S+)", text).group(1)
        missed = re.findall(r"^ *(\S.*?)  .*NOT MET", text, re.M)
        return f"solid fraction {fraction}, {contacts} contacts; missed: {', '.join(missed) or 'nothing'}"


def packing_file(folder, n_particles):
    return folder / f"spheres-{n_particles}.h5"


def cases(quick):
    yield Pack(6000, 10, 5)
    yield Run("D(t), 100 times, tables only", [*linear, *without_files], 1, 7)
    yield Run("D(t), 100 times, with ParaView", [*linear, "Output/Plots = false"], 1, 5)
    yield Run("D(t), 100 times, ParaView, plots", linear, None, 3)
    yield Run("creep at 400 kPa to 2000 s", without_files, 6, 3)
    yield Pack(30000, None, 2)
    if not quick:
        yield Pack(100000, None, 1)
        yield Pack(200000, None, 1)


def measure(case, program, folder, threads):
    """Row of the table, and the median seconds (nothing if it failed)."""
    others, times, memory = OtherPrograms(), [], 0
    try:
        for _ in range(case.repetitions):
            seconds, used, text = timed(list(map(str, case.command(program, folder))), threads)
            times.append(seconds)
            memory = max(memory, used)
        outcome = case.outcome(text)
    except Failed as failure:
        return [case.name, case.n_particles, "-", "-", "-", "-", f"FAILED, {failure}"], None
    target = f"{case.target:g}" if case.target else "-"
    row = [case.name, case.n_particles, f"{spread(times)} of {len(times)}", target, f"{memory:.0f}",
           f"{others.processors():.2f}", outcome]
    return row, sorted(times)[len(times) // 2]


def exponent(points):
    """Slope of log seconds over log n by least squares."""
    x = [math.log(n) for n, _ in points]
    y = [math.log(seconds) for _, seconds in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y))
            / sum((a - mean_x) ** 2 for a in x))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, default=repository / "build" / "bin" / "mastic")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--quick", action="store_true", help="without the largest packings")
    parser.add_argument("--only", default="", help="cases whose name contains this (and pack 6000)")
    arguments = parser.parse_args()
    if not arguments.program.exists():
        sys.exit(f"error: {arguments.program} is missing: build the project first")
    version = subprocess.run([arguments.program, "--version"], capture_output=True, text=True)
    print(f"{today()}; {machine()}\n{version.stdout.strip()}, {arguments.threads} threads\n")
    rows, points = [], []
    with tempfile.TemporaryDirectory() as name:
        for case in cases(arguments.quick):
            if arguments.only not in case.name and case.name != "pack 6000 spheres":
                continue
            row, seconds = measure(case, arguments.program, pathlib.Path(name), arguments.threads)
            print(f"measured: {case.name}", file=sys.stderr, flush=True)
            rows.append(row)
            if isinstance(case, Pack) and seconds:
                points.append((case.n_particles, seconds))
    print_table(["command", "spheres", "seconds: median (range)", "target", "MiB",
                 "others", "what came out"], rows)
    print("\nothers: processors busy with other programs meanwhile")
    if len(points) > 1:
        print(f"packing: seconds ~ n^{exponent(points):.2f} from {points[0][0]} to {points[-1][0]} spheres")


if __name__ == "__main__":
    main()
