"""Results of mastic as the figures need them: read from result.h5, named, and told apart."""
import re
from collections import namedtuple
from pathlib import Path

import h5py
import numpy as np
from curves import event_order

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000"]

CYCLIC = {"haversine": "Loading/Peak stress", "block pulses": "Loading/Peak stress",
          "sine": "Loading/Stress amplitude"}  # tests, and what they prescribe

Kind = namedtuple("Kind", "name column axis rate_axis factor")
STRAIN = Kind("strain", "axial_strain_percent", "Axial strain [%], compression positive",
              "Strain rate [1/s]", 0.01)
DISPLACEMENT = Kind("displacement", "mean_displacement_mm", "Mean displacement [mm]",
                    "Displacement rate [mm/s]", 1)


def scene_values(text):
    """Values of a scene by 'Section/Key'."""
    values, sections = {}, []
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word == "subsection":
            sections.append(rest)
        elif word == "end":
            sections.pop()
        elif word == "set":
            key, _, value = rest.partition("=")
            values["/".join(sections + [key.strip()])] = value.strip()
    return values


class Result:
    """What the figures need of one result.h5."""

    def __init__(self, folder):
        self.folder = Path(folder).resolve()
        self.label, self.look, self.left_out = "", {"color": COLOURS[0], "ls": "-"}, []
        if not (self.folder / "result.h5").is_file():
            raise ValueError(f"{folder}: there is no result.h5 in it")
        try:
            with h5py.File(self.folder / "result.h5", "r") as file:
                self.read(file)
        except (OSError, KeyError) as error:
            reason = str(error).strip("'\"").splitlines()[0]
            raise ValueError(f"{folder}: no result can be read there: {reason}") from None

    def read(self, file):
        self.about = {name: value.decode() if isinstance(value, bytes) else value
                      for name, value in file.attrs.items()}
        if self.about.get("kind") != "result":
            raise KeyError("result.h5 is of another kind")
        self.scene = scene_values(bytes(file["scene/resolved"][()]).decode())
        self.history, self.breakages, self.modulus, self.cycles, self.energy = (
            {name: column[()] for name, column in file.get(table, {}).items()}
            for table in ("history", "breakages", "complex_modulus", "cycles", "energy"))
        self.measured = {name: column[()] for name, column in file.get("measured", {}).items()}
        self.difference = (float(file["measured"].attrs["relative_rms_difference"])
                           if self.measured else np.nan)
        self.volumes, self.damage = ({name: column[()] for name, column in file.get(t, {}).items()}
                                     for t in ("volumes", "damage"))
        if self.damage:
            self.damage["vertices"] = self.damage["vertices"].reshape(-1, 8, 3)
        self.of_particles = "packing" in file
        self.n_particles, self.n_bonds = ((len(file["packing/radius"]), len(file["bonds/id"]))
                                          if self.of_particles else (0, 0))
        self.breakages.setdefault("time_s", np.empty(0))
        self.time, self.end = self.history["time_s"], self.history["time_s"][-1]
        times = self.breakages["time_s"]
        times[times < 1e-12 * self.end] = 0  # by the first infinitesimal load
        self.strain, self.stress = (self.history.get(f"axial_{name}")
                                    for name in ("strain_percent", "stress_kPa"))
        self.test = self.scene["Loading/Test"]
        self.follows_stress = self.test in ("stress history", *CYCLIC)
        self.creeps = self.test in ("creep", "particle loads", "boundary loads")
        self.kind = DISPLACEMENT if self.strain is None else STRAIN
        self.shift = (None if self.scene.get("Temperature/Temperature history")
                      else float(self.about.get("viscosity_shift_aT", 1)))  # one aT for the run
        self.first_time = self.time[self.time > 0].min(initial=np.inf)

    def curve(self):
        """Times and strains or mean displacements; jumps are sharp where breakages tell them."""
        value, before = self.history[self.kind.column], self.breakages.get(self.kind.column)
        if before is None:
            return self.time, value
        return event_order(self.time, value, self.history["broken_bonds"],
                           self.breakages["time_s"], before)

    def loaded(self):
        """First and last time at which a creep test is under its load."""
        size = np.abs(self.history["load_factor"] if self.stress is None else self.stress)
        held = np.flatnonzero(size >= 0.95 * np.median(size[size >= 0.5 * size.max()]))
        released = (self.scene["Loading/Release time"] != "never"
                    and self.test in ("creep", "boundary loads"))
        return self.time[held[0]], self.time[held[-1]] if released else self.end

    def legend(self, text=""):
        return ": ".join(part for part in (self.label, text) if part) or None


def natural_order(r):
    """Sorts 400-kPa before 1000-kPa."""
    number = re.match(r"[-+]?\d+(\.\d*)?([eE][-+]?\d+)?", r.folder.name)
    return float(number[0]) if number else np.inf, str(r.folder)


def name_results(results):
    """Gives several results their colours and labels; returns the key that a study varied."""
    varied = [key for key in results[0].scene if all(
        re.sub(r"[^0-9A-Za-z.]", "-", r.scene.get(key, "")) == r.folder.name for r in results)]
    alike = len({r.folder.name for r in results}) < len(results)
    for k, r in enumerate(results if len(results) > 1 else []):
        name = re.sub(r"^([\d.]+)-([A-Za-z]+)$", r"\1 \2", r.folder.name)
        r.label = r.scene[varied[0]] if varied else name
        r.label = f"{r.folder.parent.name}/{name}" if alike else r.label
        r.look = {"color": COLOURS[k % len(COLOURS)], "ls": ["-", "--", ":"][k // len(COLOURS) % 3]}
    return varied[0].split("/")[-1] if len(varied) == 1 and len(results) > 1 and not alike else None


def joined(texts, most=4):
    """The different ones among texts, in one line."""
    texts = list(dict.fromkeys(filter(None, texts)))
    return "; ".join(texts[:most]) + (f" and {len(texts) - most} more" if len(texts) > most else "")


def bodies(r):
    """What was simulated, in numbers."""
    if r.of_particles:
        return f"{r.n_particles} particles, {r.n_bonds} bonds"
    return f"{r.about['cells']:g} cells, {r.about['unknowns']:g} unknowns"


def seeds(r):
    """Where particles and strengths come from."""
    if not r.of_particles:
        if r.scene["Body/Material"] != "law file":
            return (f"{r.scene['Body/Material']}, volumes of {r.scene['Volumes/Particles']} "
                    f"spheres, packing seed {r.about['packing_seed']:g}, strength seed "
                    f"{r.about['strength_seed']:g}")
        return f"law {Path(r.scene['Body/Law']).name}"
    parts = [f"packing seed {r.about['packing_seed']:g}" if r.scene["Specimen/Source"] == "generate"
             else f"particles from {r.scene['Specimen/File']}"]
    if r.scene["Strength/Distribution"] != "none":
        parts.append(f"strength seed {r.about['strength_seed']:g}")
    return ", ".join(parts)


def provenance(results):
    """Lines of small print: what was simulated, how, and on which estimates it rests."""
    estimates = dict.fromkeys(name for r in results if r.about["estimated_values"] != "none"
                              for name in r.about["estimated_values"].split(", "))
    loads = {"creep": "Loading/Axial stress", "constant rate": "Loading/Strain rate", **CYCLIC}
    facts = [joined(f(r) for r in results) for f in (
        lambda r: r.folder.name, lambda r: r.test, lambda r: r.scene.get(loads.get(r.test), ""),
        lambda r: (r.scene.get("Temperature/Temperature history") or r.scene[
            "Temperature/Temperature"]).replace("degC", "\u00b0C"),
        lambda r: f"solver {r.about['solver']}",
        bodies, seeds,
        lambda r: f"{r.about['program']} ({r.about['revision']})")]
    lines = [f"Result{'s' * (len(results) > 1)}: " + "  |  ".join(filter(None, facts))]
    if results[0].left_out:
        lines.append(f"Ended at t = 0 and left out: {joined(results[0].left_out)}.")
    if estimates:
        strengths = any(f"Strength/{name}" in results[0].scene for name in estimates)
        lines.append(f"Creep law{' and strengths' if strengths else ''}: partly estimated values "
                     f"({', '.join(estimates)}).")
    return lines
