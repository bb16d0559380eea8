"""What the pictures of a specimen show: its spheres, the forces in its bonds, its broken bonds.

Each picture comes as surfaces and bodies for POV-Ray and the key to its colours.
"""
from collections import namedtuple

import matplotlib
import numpy as np
import povray
from matplotlib.colors import (LinearSegmentedColormap, ListedColormap, LogNorm, Normalize,
                               to_rgb)
from results import COLOURS
from snapshot import GONE

SHADES = 64  # different colours of a scale
COMPRESSION, TENSION = COLOURS[1], COLOURS[0]
SIZES = ["#ECE3CF", "#A9A391", "#56606B", "#26323F"]  # small to large
AT_ONCE, ONLY_AT_ONCE = "#D3D6D9", "#7D848A"
DISC, DISC_AT_ONCE = 0.85, 0.5  # radius of the disc for a broken bond over that of its smaller sphere
THICKEST = 0.5  # radius of the bond with the largest force over the mean radius of spheres
WEAKEST = 0.04  # bonds below this part of the largest force are left out

# Colours of numbers: a scale, from numbers to it, which of its ends has more beyond, and whether
# thickness goes with the number, too. Colours of kinds: entries, each a colour and a text.
Key = namedtuple("Key", "label scale norm beyond wedge entries",
                 defaults=("", None, None, "neither", False, ()))
# What is solid casts shadows; the rest stands in mist.
Picture = namedtuple("Picture", "name heading textures objects key solid note")


def shades(scale):
    """Colours of a scale, to be declared once and referred to by number."""
    return [scale((k + 0.5) / SHADES)[:3] for k in range(SHADES)]


def shade_of(values, norm):
    """Numbers of the shades for values; those beyond the scale take its ends."""
    share = np.ma.filled(norm(np.asarray(values, float)), 0)
    return np.clip((SHADES * share).astype(int), 0, SHADES - 1)


def textures(colours):
    return [povray.texture(f"S{k}", colour) for k, colour in enumerate(colours)]


def part_of(scale, low, high):
    """A part of a colour map."""
    return ListedColormap(scale(np.linspace(low, high, 256)))


def class_colours(number):
    """Colours of material classes; each further round through the palette is darker."""
    return [tuple(0.5 ** (k // len(COLOURS)) * np.array(to_rgb(COLOURS[k % len(COLOURS)])))
            for k in range(number)]


def packing(s):
    """The spheres, coloured by class if there are several, else by diameter."""
    classes = np.unique(s.material_class)
    if len(classes) > 1:
        colours, entries = class_colours(len(classes)), []
        shade = np.searchsorted(classes, s.material_class)
        entries = [(colour, f"class {name}") for colour, name in zip(colours, classes)]
        key = Key(entries=entries)
    else:
        scale = LinearSegmentedColormap.from_list("sizes", SIZES)
        low, high = 2 * s.radius.min(), 2 * s.radius.max()
        if high < 1.001 * low:  # one size
            colours, shade = [scale(0.25)[:3]], np.zeros(len(s.radius), int)
            key = Key(entries=[(colours[0], f"diameter {high:.3g} mm")])
        else:
            norm = Normalize(low, high)
            colours, shade = shades(scale), shade_of(2 * s.radius, norm)
            key = Key("Diameter [mm]", scale, norm)
    objects = [povray.sphere(c, r, f"S{k}") for c, r, k in zip(s.centre, s.radius, shade)]
    return Picture("packing", f"{len(s.radius)} spheres", textures(colours), objects, key, True,
                   "")


def rounded_up(x):
    """The next number that reads well."""
    power = 10.0 ** np.floor(np.log10(x))
    return next(k * power for k in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if k * power >= x * (1 - 1e-9))


def largest_force(force):
    """Where the scale of forces ends: all but the largest of a hundred bonds are on it."""
    size = np.abs(force[force != 0])
    return rounded_up(np.quantile(size, 0.99)) if len(size) else 1.0


def forces(s):
    """Bonds that carry a force, as thick as it is large; tension and compression by colour."""
    carrying = s.state != GONE
    force, ends = s.force[carrying], s.ends[carrying]
    limit, thickest = largest_force(force), THICKEST * np.mean(s.radius)
    scale = LinearSegmentedColormap.from_list("forces", [
        (0, COMPRESSION), (0.35, "#F2A877"), (0.5, "#E4E4E4"), (0.65, "#7DB9DE"), (1, TENSION)])
    norm, shown = Normalize(-limit, limit), np.abs(force) >= WEAKEST * limit
    shade, width = shade_of(force, norm), thickest * np.minimum(np.abs(force) / limit, 1)
    objects = [povray.cylinder(s.centre[i], s.centre[j], w, f"S{k}")
               for (i, j), w, k in zip(ends[shown], width[shown], shade[shown])]
    note = f"Forces below {WEAKEST * limit:.2g} N are left out"
    over = int(np.sum(np.abs(force) > limit * (1 + 1e-9)))
    note += f", the {over} beyond {limit:g} N drawn as {limit:g} N." if over else "."
    heading = f"Bonds: {np.sum(force < 0)} in compression, {np.sum(force > 0)} in tension"
    return Picture("forces", heading, textures(shades(scale)), objects,
                   Key("Normal force [N]", scale, norm, wedge=True), False, note)


def disc(s, i, j, size, surface):
    """A crack: a flat disc across the line between two spheres, where they touched."""
    radius = size * min(s.radius[i], s.radius[j])
    line = s.centre[j] - s.centre[i]
    normal = line / max(np.linalg.norm(line), 1e-12)
    middle = s.centre[i] + line * s.radius[i] / (s.radius[i] + s.radius[j])
    return povray.cylinder(middle - 0.12 * radius * normal, middle + 0.12 * radius * normal, radius,
                           surface)


def time_norm(times, log):
    """From times after the start to colours; in log time the few first ones share a colour."""
    first, last = np.quantile(times, 0.02), times.max()
    if log and last > 3 * first:
        return LogNorm(first, last)
    return Normalize(0, last)


def broken(s, log):
    """Broken bonds as discs, coloured by the time of breakage.

    Those that broke as the load came on would hide the others: they are small and grey.
    """
    later = s.broken_time[s.broken_time > 0]
    at_once = len(s.broken_time) - len(later)
    grey, size = (AT_ONCE, DISC_AT_ONCE) if len(later) else (ONLY_AT_ONCE, DISC)
    entries = [(grey, f"at t = 0: {at_once}")] if at_once else []
    note = "A disc stands across each broken bond"
    note += ", a small one if it broke at t = 0." if at_once and len(later) else "."
    key, shade = Key(entries=entries), np.zeros(len(s.broken_time), int)
    scale = part_of(matplotlib.colormaps["plasma_r"], 0.06, 0.86)
    if len(later):
        norm = time_norm(later, log)
        shade = shade_of(s.broken_time, norm)
        key = Key("Time of breakage [s]", scale, norm,
                  "min" if norm.vmin > later.min() else "neither", entries=entries)
    surfaces = [povray.texture("AtOnce", to_rgb(grey)), *textures(shades(scale))]
    objects = [disc(s, i, j, DISC, f"S{k}") if time > 0 else disc(s, i, j, size, "AtOnce")
               for (i, j), k, time in zip(s.broken_ends, shade, s.broken_time)]
    return Picture("broken", f"{len(s.broken_time)} of {len(s.ends)} bonds broken", surfaces,
                   objects, key, True, note)
