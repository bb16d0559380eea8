"""One instant of a result as pictures need it: spheres, bonds and breakages in mm, N and s."""
import re
from collections import namedtuple

import h5py
import numpy as np

INTACT, PRESSED, GONE = 0, 1, 2  # states of bonds in result.h5
SECONDS = {"ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
SMALL_DISPLACEMENTS = ("linear", "events")  # solvers that keep the normals of the start

Snapshot = namedtuple("Snapshot", "time centre start radius material_class ends force state "
                                  "broken_ends broken_time")


def seconds(text):
    """A time with its unit, such as '100 s' or '2 min', in seconds."""
    found = re.fullmatch(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([a-z]*)\s*", text)
    unit = found and (found[2] or "s")
    if not found or unit not in SECONDS:
        raise ValueError(f"'{text}' is no time; one is a number and {', '.join(SECONDS)}")
    return float(found[1]) * SECONDS[unit]


def nearest(times, wanted=None):
    """Index of the time nearest to the wanted one; without one, of the last."""
    return len(times) - 1 if wanted is None else int(np.argmin(np.abs(np.asarray(times) - wanted)))


def same_time(a, b):
    return abs(a - b) <= 1e-4 * max(abs(a), abs(b))


def along(vectors, start, end):
    """Components of vectors along the lines from start to end, which is tension in bonds."""
    line = end - start
    length = np.maximum(np.linalg.norm(line, axis=-1, keepdims=True), 1e-300)
    return np.sum(vectors * line / length, axis=-1)


def read(result, wanted=None, magnify=1.0):
    """The snapshot nearest to a time [s], its displacements magnified."""
    if not result.of_particles:
        raise ValueError(f"{result.folder}: there are no particles in it (solver "
                         f"{result.about['solver']}), so there is no packing to show")
    with h5py.File(result.folder / "result.h5", "r") as file:
        groups = [file["snapshots"][name] for name in sorted(file.get("snapshots", ()))]
        if not groups:
            raise ValueError(f"{result.folder}: there are no snapshots in it")
        group = groups[nearest([g.attrs["time_s"] for g in groups], wanted)]
        start, displacement = file["packing/centre"][()], group["displacement"][()]
        ends = file["bonds/particles"][()].reshape(-1, 2)
        real = start if result.about["solver"] in SMALL_DISPLACEMENTS else start + displacement
        force = along(group["bond_force"][()].reshape(-1, 3), real[ends[:, 0]], real[ends[:, 1]])
        time = float(group.attrs["time_s"])
        return Snapshot(time, 1e3 * (start + magnify * displacement), 1e3 * start,
                        1e3 * file["packing/radius"][()], file["packing/material_class"][()], ends,
                        force, group["bond_state"][()], *breakages(result, time))


def breakages(result, until):
    """Ends and times of the bonds that broke so far."""
    table, time = result.breakages, result.breakages["time_s"]
    if not len(time):
        return np.empty((0, 2), int), time
    ends = np.stack([table["first_particle"], table["second_particle"]], axis=1).astype(int)
    so_far = time <= until * (1 + 1e-9)
    return ends[so_far], time[so_far]


def reading(result, time):
    """What the history says of an instant, for a headline: strain or mean displacement."""
    past = np.flatnonzero(result.time <= time * (1 + 1e-9))
    value = result.history[result.kind.column][past[-1] if len(past) else 0] + 0.0  # no -0
    if result.kind.name == "strain":
        return f"axial strain {value:.3g} %"
    return f"mean displacement {value:.3g} mm"


def in_sight(snapshot, most=0.5):
    """Which spheres to show: those that are not far beyond where the specimen was at the start."""
    low, high = np.min(snapshot.start, axis=0), np.max(snapshot.start, axis=0)
    room = most * max(np.max(high - low), 2 * np.max(snapshot.radius))
    inside = (snapshot.centre >= low - room) & (snapshot.centre <= high + room)
    shown = np.all(inside, axis=1)
    return shown if np.any(shown) else np.ones(len(shown), bool)
