"""Sections through a body of volumes that break: which part of its stiffness is lost where."""
import numpy as np
from matplotlib.collections import PolyCollection

FIELDS = (("stiffness_loss", "stiffness lost [-]", "inferno_r"),
          ("strength_use", "largest force over strength [-]", "viridis"))


def hull(points):
    """Corners of the convex hull of points in the plane, in order (monotone chain)."""
    points = sorted(set(map(tuple, points)))

    def half(sequence):
        chain = []
        for p in sequence:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0:
                    break
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return half(points) + half(reversed(points)) if len(points) > 2 else points


def section(corners, height):
    """The polygon in which the plane y = height cuts a cell, or nothing."""
    above = corners[:, 1] - height
    points = []
    for i in range(len(corners)):
        for j in range(i):
            if above[i] * above[j] < 0:
                share = above[i] / (above[i] - above[j])
                points.append((corners[i] + share * (corners[j] - corners[i]))[[0, 2]].round(9))
    return hull(points)


def draw_section(axes, damage, name, label, colours):
    """Colours the cells that the upright plane through the middle of the body cuts."""
    corners = 1e3 * damage["vertices"]
    low, high = corners[..., 1].min(), corners[..., 1].max()
    height = 0.5 * (low + high) + 1e-6 * (high - low)  # beside the faces of cells
    found = [(k, section(cell, height)) for k, cell in enumerate(corners)]
    found = [(k, polygon) for k, polygon in found if len(polygon) > 2]
    cells = PolyCollection([polygon for _, polygon in found], cmap=colours, edgecolor="0.8",
                           linewidth=0.4)
    cells.set_array(np.array([damage[name][k] for k, _ in found]))
    cells.set_clim(0, max(1e-3, float(np.max(damage[name]))))
    axes.add_collection(cells)
    axes.set_aspect("equal")
    axes.autoscale_view()
    left, right = axes.get_xlim()
    axes.set_xlim(left, right + 0.35 * (right - left))  # room for the colours
    axes.grid(False)
    axes.set(xlabel="x [mm]", ylabel="z [mm]")
    axes.figure.colorbar(cells, cax=axes.inset_axes([0.81, 0.05, 0.035, 0.9]), label=label)


def draw_sections(sheet, result):
    """Both sections of a result; returns what to say about them."""
    for axes, (name, label, colours) in zip(sheet.panels, FIELDS):
        draw_section(axes, result.damage, name, label, colours)
    return (f"Upright section through the middle at t = {result.end:.4g} s; means over each cell, "
            "for the force over strength the largest of its points.")


def draw_histories(sheet, results, log):
    """Broken bonds and live points over time."""
    for r in results:
        for axes, column in zip(sheet.panels, ("broken_share_percent", "live_share_percent")):
            axes.plot(r.volumes["time_s"], r.volumes[column], label=r.legend(), **r.look)
    for panel, what in enumerate(("Broken bonds [%]", "Live points [%]")):
        sheet.label(panel, "Time [s]", what, log)
        sheet.panels[panel].set_ylim(bottom=0)
