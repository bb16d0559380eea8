#!/usr/bin/env python3
"""Cost per bond and step of the explicit solver beside a program that Debian ships, Yade.

Both run data/cylinder.* (6000 spheres, 16500 bonds), a part of the steps each in turn, so that
what else happens on the machine strikes both alike. Yade's bonds are elastic: it has no Burgers
bond. Its wall time per step is that of its own run call, ours that of dem::advance.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

from report import OtherPrograms, machine, print_table, spread, today

here = pathlib.Path(__file__).resolve().parent
data = here / "data"


class Stepper:
    """A program that runs as many steps as it is told and says how long they took."""

    def __init__(self, name, threads, command, environment=None):
        self.name, self.threads, self.costs, self.force = name, threads, [], None
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True,
                                        env={**os.environ, **(environment or {})})
        self.n_bonds = int(self.answer("ready bonds").split()[-1])

    def answer(self, begin):
        for line in self.process.stdout:
            if begin in line:
                return line
        sys.exit(f"error: {self.name} ended without an answer, exit {self.process.wait()}")

    def run(self, steps, counted=True):
        self.process.stdin.write(f"{steps}\n")
        self.process.stdin.flush()
        found = re.search(r"seconds (\S+) force (\S+)", self.answer("done seconds"))
        self.force = float(found.group(2))
        if counted:
            self.costs.append(1e9 * float(found.group(1)) / steps / self.n_bonds)

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def yade_command():
    for name in ("yade", "yadedaily"):
        if shutil.which(name):
            return name
    sys.exit("error: Yade is not installed. On Debian:\n"
             "  apt-get install --no-install-recommends yade\n"
             "or yadedaily from the project's own repository, see https://yade-dem.org/doc/")


def yade_version(program):
    found = subprocess.run([program, "--version"], capture_output=True, text=True)
    version = re.search(r"\d{4}\.\d+\w*|\d{8}\S*", found.stdout + found.stderr)
    return f"Yade {version.group(0) if version else ''}".strip()


def start_all(arguments):
    program = yade_command()
    ours = str(arguments.program)
    for threads in arguments.threads:
        yield Stepper(yade_version(program) + ", elastic", threads,
                      [program, f"-j{threads}", "-n", "-x", str(here / "peer_yade.py")],
                      {"BENCH_DATA": str(data), "OMP_NUM_THREADS": str(threads)})
        for law in ("elastic", "burgers"):
            yield Stepper(f"Mastic, {law}", threads,
                          [ours, "--serve", "--law", law, "--threads", str(threads)])


def rows_of(steppers):
    for each in steppers:
        peer = next(s for s in steppers if s.threads == each.threads)
        ratio = statistics.median(peer.costs) / statistics.median(each.costs)
        yield [each.name, each.threads, spread(each.costs), f"{ratio:.1f}", f"{each.force:.2f}"]


def main():
    scene = json.load(open(data / "cylinder.json"))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path,
                        default=here.parent / "build" / "bin" / "bench_dynamic")
    parser.add_argument("--threads", type=int, nargs="+", default=[1])
    parser.add_argument("--steps", type=int, default=scene["steps"])
    parser.add_argument("--turns", type=int, default=10)
    arguments = parser.parse_args()
    if not arguments.program.exists():
        sys.exit(f"error: {arguments.program} is missing: configure with -DMASTIC_BENCH=ON and build")
    others = OtherPrograms()
    steppers = list(start_all(arguments))
    warm_up, share = 100, (arguments.steps - 100) // arguments.turns
    for each in steppers:
        each.run(warm_up, counted=False)
    for _ in range(arguments.turns):
        for each in steppers:
            each.run(share)
    for each in steppers:
        each.close()
    print(f"{today()}; {machine()}")
    print(f"{warm_up + share * arguments.turns} steps of {scene['time_step_s']:g} s, {arguments.turns} "
          f"turns; {steppers[0].n_bonds} and {steppers[1].n_bonds} bonds; other programs used "
          f"{others.processors():.2f} processors\n")
    print_table(["program, bonds", "threads", "ns per bond and step: median (range)",
                 "Yade / this", "platen force [N]"], list(rows_of(steppers)))


if __name__ == "__main__":
    main()
