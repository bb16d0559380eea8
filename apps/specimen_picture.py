#!/usr/bin/python3
"""Pictures of a specimen of mastic: its spheres, the forces in its bonds, its broken bonds.

usage: specimen_picture.py FOLDER RESULT [--time "100 s"] [--magnify 10] [--height 1300] [--threads 1]

RESULT is a folder that holds result.h5. POV-Ray renders, without a display; the pictures are written
into FOLDER and their paths printed, one a line.
"""
import argparse
import logging
import os
import sys
import textwrap
import warnings
from pathlib import Path

logging.disable(logging.CRITICAL)  # the caller reads paths and errors only
try:
    import matplotlib
    import numpy as np
    import povray
    import snapshot
    import specimen_scenes
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch, Polygon
    from matplotlib.ticker import LogLocator

    from results import Result, provenance
except ImportError as problem:
    sys.exit(f"specimen_picture.py: {problem}")

STYLE = {"font.size": 9, "legend.frameon": False, "axes.linewidth": 0.6}
TALL, HEIGHT = 6.5, 1300  # of a rendered picture [inches], [pixels]
KEY, EDGE, GAP, TOP = 1.35, 0.25, 0.15, 0.95  # room for key, edge, between, headline [inches]


def round_length(most):
    """The largest of 1, 2, 5, 10, ... that is not longer."""
    power = 10.0 ** np.floor(np.log10(most) + 1e-9)
    return max(step * power for step in (1, 2, 5) if step * power <= most * (1 + 1e-9))


def draw_scale_bar(axes, camera):
    """A bar of a round length under the picture, at its true length."""
    length, left, below = round_length(0.4 * camera.width), -0.5 * camera.width, -0.5 * camera.height
    axes.plot([left, left + length], [below, below], "k-", lw=2.5, solid_capstyle="butt",
              clip_on=False)
    axes.annotate(f"{length:g} mm", (left + 0.5 * length, below), xytext=(0, -4), va="top",
                  ha="center", textcoords="offset points", annotation_clip=False)


def signed(number):
    """A number with its sign, zero without."""
    return f"{number:+.3g}".replace("-", "\u2212") if number else "0"


def draw_wedge(axes, key):
    """A scale of colours that is as wide as its number is large."""
    low, high = key.norm.vmin, key.norm.vmax
    colours = axes.imshow(np.linspace(low, high, 256)[:, None], cmap=key.scale, norm=key.norm,
                          extent=(-1, 1, low, high), origin="lower", aspect="auto")
    corners = Polygon([(-1, low), (1, low), (-1, high), (1, high)], closed=True, fill=False)
    colours.set_clip_path(axes.add_patch(corners))
    corners.set_visible(False)
    for x, y, text, side in ((0, high, "tension", "bottom"), (0, low, "compression", "top")):
        axes.annotate(text, (x, y), xytext=(0, 9 if side == "bottom" else -9), va=side, ha="center",
                      textcoords="offset points", annotation_clip=False)
    axes.set_xlim(-1, 1)
    axes.set_xticks([])
    axes.yaxis.tick_right()
    axes.yaxis.set_label_position("right")
    axes.set_ylabel(key.label)
    axes.set_yticks(np.linspace(low, high, 5))
    axes.set_yticklabels([signed(x) for x in axes.get_yticks()])
    for spine in axes.spines.values():
        spine.set_visible(False)


def draw_key(figure, key, place):
    """The key of a picture in a place of the figure (left, bottom, width, height in inches)."""
    wide, tall = figure.get_size_inches()
    left, bottom, _, height = place
    middle = bottom + 0.25 * height
    if key.scale is not None:
        left += 0.12 * key.wedge  # room for its texts
        axes = figure.add_axes([left / wide, middle / tall, (0.36 if key.wedge else 0.16) / wide,
                                0.5 * height / tall])
        if key.wedge:
            draw_wedge(axes, key)
        else:
            bar = figure.colorbar(ScalarMappable(key.norm, key.scale), cax=axes, extend=key.beyond,
                                  extendfrac=0.04, label=key.label)
            if isinstance(key.norm, LogNorm) and key.norm.vmax < 1e3 * key.norm.vmin:
                bar.ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
                bar.ax.yaxis.set_major_formatter("{x:g}")
                bar.ax.yaxis.set_minor_formatter("")
    if key.entries:
        handles = [Patch(facecolor=colour, edgecolor="0.5", lw=0.4, label=text)
                   for colour, text in key.entries]
        figure.legend(handles=handles, loc="upper left", borderaxespad=0, borderpad=0,
                      handlelength=1.2, handletextpad=0.5,
                      bbox_to_anchor=((left - 0.02) / wide, (middle - 0.3) / tall
                                      if key.scale else (bottom + 0.75 * height) / tall))


def headline(result, s, magnify):
    """Time and deformation of what is shown."""
    size = "" if magnify == 1 else f", displacements times {magnify:g}"
    return f"t = {s.time:.4g} s, {snapshot.reading(result, s.time)}{size}"


def outside(s):
    """What to say about spheres that left the frame."""
    number = int(np.sum(~snapshot.in_sight(s)))
    return [f"{number} spheres that moved far away are not in the frame."] if number else []


def sheet(result, s, camera, pictures, images, magnify):
    """A figure with pictures side by side, each with its key."""
    one = TALL * camera.width / camera.height
    panel = max(one + KEY, 3.4) + GAP
    wide = len(pictures) * panel + 2 * EDGE
    notes = [p.note for p in pictures if p.note] + outside(s)
    small = [part for line in [" ".join(notes)] * bool(notes) + provenance([result])
             for part in textwrap.wrap(line, int(18.5 * wide))]
    below = 0.5 + 0.13 * len(small)
    tall = below + TALL + TOP
    figure = Figure(figsize=(wide, tall), dpi=HEIGHT / TALL)
    title = textwrap.shorten(str(result.about["title"]), int(10 * wide), placeholder=" ...")
    for text, place, size, weight in ((title, 0.15, 12, "bold"),
                                      (headline(result, s, magnify), 0.42, 10, "normal")):
        figure.text(EDGE / wide, 1 - place / tall, text, va="top", size=size, weight=weight,
                    parse_math=False)
    figure.text(EDGE / wide, 0.1 / tall, "\n".join(small), size=6.5, color="0.3", linespacing=1.3,
                parse_math=False)
    for k, (picture, image) in enumerate(zip(pictures, images)):
        left = EDGE + k * panel
        axes = figure.add_axes([left / wide, below / tall, one / wide, TALL / tall])
        half = 0.5 * np.array([-camera.width, camera.width, -camera.height, camera.height])
        axes.imshow(image, extent=half, interpolation="antialiased")
        axes.set_axis_off()
        figure.text(left / wide, (below + TALL + 0.12) / tall, picture.heading, size=10)
        draw_scale_bar(axes, camera)
        draw_key(figure, picture.key, (left + one + 0.12, below, KEY, TALL))
    return figure


def save(figure, path, dpi):
    """Writes under a temporary name, renames, prints the name."""
    part = path.with_name(path.name + ".part")
    try:
        figure.savefig(part, format="png", dpi=dpi)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    print(path, flush=True)


def draw(result, s, folder, options):
    """Renders the pictures and writes each, then all side by side."""
    shown = snapshot.in_sight(s)
    camera = povray.camera_on(s.centre[shown], s.radius[shown])
    pictures = [specimen_scenes.packing(s)]
    if np.any(s.force[s.state != snapshot.GONE]):
        pictures.append(specimen_scenes.forces(s))
    if len(s.broken_time):
        pictures.append(specimen_scenes.broken(s, result.creeps))
    dpi, images = options.height / TALL, []
    for p in pictures:
        text = povray.scene(camera, p.textures, p.objects, shadows=p.solid, mist=not p.solid)
        images.append(povray.render(text, *povray.pixels(camera, options.height), options.threads))
        save(sheet(result, s, camera, [p], images[-1:], options.magnify),
             folder / f"specimen_{p.name}.png", dpi)
    if len(pictures) > 1:
        save(sheet(result, s, camera, pictures, images, options.magnify), folder / "specimen.png",
             0.7 * dpi)


def arguments(words):
    parser = argparse.ArgumentParser(prog="specimen_picture.py", allow_abbrev=False,
                                     description="Pictures of a specimen, rendered by POV-Ray.")
    parser.add_argument("folder", type=Path, help="where the pictures go")
    parser.add_argument("result", help="folder that holds result.h5")
    parser.add_argument("--time", help="time of the snapshot, such as '100 s' (default: the last)")
    parser.add_argument("--magnify", type=float, default=1.0, help="factor on displacements")
    parser.add_argument("--height", type=int, default=HEIGHT,
                        help="of a rendered picture [pixels], at least 100")
    parser.add_argument("--threads", type=int, default=1, help="of POV-Ray")
    options = parser.parse_args(words)
    if options.height < 100 or options.threads < 1 or not np.isfinite(options.magnify):
        parser.error("--height is at least 100, --threads at least 1, --magnify a number")
    return options


def main(words=None):
    options = arguments(words)
    warnings.simplefilter("ignore")  # on standard error too
    matplotlib.rcParams.update(STYLE)
    try:
        wanted = None if options.time is None else snapshot.seconds(options.time)
        result = Result(options.result)
        s = snapshot.read(result, wanted, options.magnify)
        povray.require()
        if wanted is not None and not snapshot.same_time(s.time, wanted):
            print(f"note: no snapshot at {wanted:g} s; the nearest is at "
                  f"{s.time:.6g} s", file=sys.stderr)
        options.folder.mkdir(parents=True, exist_ok=True)
        draw(result, s, options.folder, options)
    except Exception as error:  # the caller shows one line
        kind = "" if isinstance(error, (OSError, ValueError)) else f"{type(error).__name__}: "
        sys.exit(f"specimen_picture.py: {kind}{' '.join(str(error).split())}")


if __name__ == "__main__":
    main()
