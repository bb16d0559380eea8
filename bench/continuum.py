#!/usr/bin/python3
"""Speed of the continuum: the specimen of the paper, a million unknowns on one and two ranks, growth of
the iterations with refinement, and FEniCSx on the same problem where it is installed.

usage: continuum.py [--specimen] [--large] [--peer] [--mastic PATH]      (default: all)

Times are whole commands but for the peer, where both are those of the time steps; medians of --repeat runs. Set-ups,
figures and ParaView files are part of the commands unless said. One rank is one thread.
"""
import argparse
import os
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "scenes/continuum"
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
               "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def run(arguments, scene, settings, folder, ranks=1):
    """Runs a scene; returns wall time [s], attributes and last row of the history, memory [GiB]."""
    launch = ["mpirun", "--oversubscribe", "-np", str(ranks)] if ranks > 1 else []
    command = [*launch, str(arguments.mastic), "run", str(scene), "--quiet"]
    for setting in [*settings, "Output/Plots = false", f"Output/Folder = {folder}"]:
        command += ["--set", setting]
    start = time.perf_counter()
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(command, env=ENVIRONMENT, stdout=said, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)  # with the largest of the processes below it
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        if process.returncode != 0:
            raise SystemExit(f"{' '.join(command)}\n{said.read()}")
    memory = usage.ru_maxrss / 2**20
    with h5py.File(Path(folder) / "result.h5", "r") as file:
        about = dict(file.attrs)
        last = {name: column[-1] for name, column in file["history"].items()}
    statistics_text = about["solver_statistics"]
    if isinstance(statistics_text, bytes):
        statistics_text = statistics_text.decode()
    about["iterations"] = int(statistics_text.split(" linear solves, ")[1].split()[0])
    about["linear_solves"] = int(statistics_text.split(" linear solves, ")[0].split()[-1])
    return wall, about, last, memory


def specimen(arguments, folder):
    """100 creep steps of the specimen with the extracted law and with one that is not proportional."""
    print("Specimen of the paper, 100 creep steps, one rank, order 2:")
    print("  law              cell [mm]  unknowns  steps  whole [s]  solved [s]  error of the last strain")
    for law in ("mixture-20C.law", "burgers-in-shear.law"):
        scene = SCENES / "specimen-400.scene"
        common = [f"Body/Law = {SCENES / law}", "Output/ParaView = false", "Output/Frequencies = none",
                  "Output/First time = 1 s"]
        fine = run(arguments, scene, [*common, "Body/Cell size = 4 mm", "Continuum/Step tolerance = 1e-6"]
                   if law.startswith("mix") else
                   [*common, "Body/Cell size = 5 mm", "Continuum/Step tolerance = 1e-6"], folder / "fine")
        for cell in (16, 8, 6.5):
            runs = [run(arguments, scene, [*common, f"Body/Cell size = {cell} mm"], folder / "specimen")
                    for _ in range(arguments.repeat)]
            wall = statistics.median(r[0] for r in runs)
            solved = statistics.median(r[1]["wall_time_s"] for r in runs)
            strain, exact = (r[2]["axial_strain_percent"] for r in (runs[0], fine))
            print(f"  {law:<22} {cell:>5}  {runs[0][1]['unknowns']:8.0f}  {runs[0][1]['steps']:5.0f}  {wall:9.2f}"
                  f"  {solved:10.2f}  {abs(strain / exact - 1):.1e}", flush=True)


def large(arguments, folder):
    """One step from scratch, over refinements and ranks."""
    print("Cylinder, order 1, bonded platens, elastic answer from scratch:")
    print("  refinements  unknowns  ranks  whole [s]  solved [s]  solves  iterations  memory of a rank [GiB]")
    settings = ["Body/Cell size = 4.5 mm", "Continuum/Order = 1", "Loading/End time = 0 s",
                "Output/ParaView = false", "Output/Frequencies = none",
                f"Body/Law = {SCENES / 'mixture-20C.law'}"]
    times = {}
    for refinements, ranks in ((0, 1), (1, 1), (2, 1), (2, 2)):
        wall, about, _, memory = run(arguments, SCENES / "specimen-400.scene",
                                     [*settings, f"Body/Refinements = {refinements}"], folder / "large", ranks)
        times[refinements, ranks] = wall
        print(f"  {refinements:>11}  {about['unknowns']:8.0f}  {ranks:>5}  {wall:9.1f}  {about['wall_time_s']:10.1f}"
              f"  {about['linear_solves']:6}  {about['iterations']:10}  {memory:22.1f}", flush=True)
    print(f"  two ranks: {times[2, 1] / times[2, 2]:.2f} times one")


def peer(arguments, folder):
    """The same mesh, order, law and steps by FEniCSx."""
    try:
        ours = run(arguments, SCENES / "traction-box.scene", [], folder / "box")
        peer_run = subprocess.run(["/usr/bin/python3", str(ROOT / "bench/continuum_fenicsx.py"),
                                   str(folder / "box" / "history.csv")],
                                  env=ENVIRONMENT, capture_output=True, text=True, check=True)
    except subprocess.CalledProcessError as problem:
        print(f"FEniCSx: not measured ({problem.stderr.strip().splitlines()[-1]})")
        return
    seconds, unknowns, displacement = (float(word) for word in peer_run.stdout.split())
    steps = ours[1]["steps"]
    print("Box under traction, order 2, law that is not proportional, one rank, time of a step:")
    print(f"  mastic   {ours[1]['unknowns']:.0f} unknowns  {ours[1]['wall_time_s'] / steps:.3f} s")
    print(f"  FEniCSx  {unknowns:.0f} unknowns  {seconds / steps:.3f} s, "
          f"{seconds / ours[1]['wall_time_s']:.1f} times ours; "
          f"difference of the last displacement {abs(displacement / ours[2]['mean_displacement_mm'] - 1):.1e}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("specimen", "large", "peer"):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--mastic", type=Path, default=ROOT / "build/bin/mastic")
    arguments = parser.parse_args()
    every = not (arguments.specimen or arguments.large or arguments.peer)
    print(f"load at the start: {os.getloadavg()[0]:.1f}")
    with tempfile.TemporaryDirectory() as name:
        for part in (specimen, large, peer):
            if every or getattr(arguments, part.__name__):
                part(arguments, Path(name))


if __name__ == "__main__":
    main()
