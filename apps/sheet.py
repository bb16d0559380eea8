"""The sheet that figures are drawn on: panels side by side, legend above, small print below."""
import functools
import os
import textwrap

import numpy as np
from matplotlib.figure import Figure

from results import joined, provenance

STYLE = {"axes.grid": True, "grid.color": "0.88", "axes.axisbelow": True, "lines.linewidth": 1.6,
         "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False}
WIDTH, PANEL_HEIGHT, LEFT, GAP, DPI = 10.0, 4.6, 0.95, 1.0, 160  # [inches]


def log_label(x, _, form, every):
    """Label of a tick on a log axis: at every digit, or at 1, 2, 3, 5."""
    return form.format(x).replace("e-0", "e-") if every or f"{x:e}"[0] in "1235" else ""


class Sheet:
    """A figure of panels side by side, all places in inches."""

    def __init__(self, results, widths=(1,)):
        self.results, self.widths = results, widths
        self.figure = Figure(dpi=DPI)
        self.panels = [self.figure.add_axes([0, 0, 1, 1], label=str(k)) for k in range(len(widths))]

    def label(self, panel, x, y, log=""):
        """Names the axes of a panel that is drawn; `log` names those that are logarithmic."""
        axes = self.panels[panel]
        axes.set(xlabel=x, ylabel=y, xscale="log" if "x" in log else "linear",
                 yscale="log" if "y" in log else "linear")
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            if axis.get_scale() == "log" and high < 50 * low:  # few powers of ten to be labels
                form = "{:g}" if 1e-3 < low and high < 1e5 else "{:.0e}"
                every = high < 5 * low and len(self.widths) < 3
                label = functools.partial(log_label, form=form, every=every)
                axis.set_major_formatter(label)
                axis.set_minor_formatter(label)

    def mark(self, x, y, marker, r, filled=True, panel=0):
        """A point of a result that stands out from its curve."""
        self.panels[panel].plot(x, y, marker, color=r.look["color"] if filled else "white",
                                mec="black" if filled else r.look["color"], ms=8, zorder=3)

    def save(self, path, key, note=""):
        """Adds legend and texts, writes under a temporary name, renames, prints the name.

        The legend stands above the panels, where it hides nothing.
        """
        lines = [part for line in [note] * bool(note) + provenance(self.results)
                 for part in textwrap.wrap(line, 185)]
        handles, labels = self.panels[0].get_legend_handles_labels()
        columns = int((WIDTH - 1) / (0.6 + 0.085 * max(map(len, labels), default=0)))
        columns = max(1, min(columns, 4, len(labels)))
        rows = -(-len(labels) // columns) + bool(key and labels)
        below, top = 0.7 + 0.14 * len(lines), 0.5 + 0.22 * rows + 0.15 * (rows > 0)
        height = PANEL_HEIGHT + 1.4 + max(0, 0.22 * (rows - 3))
        self.figure.set_size_inches(WIDTH, height)
        title = textwrap.shorten(joined((r.about["title"] for r in self.results), 2), 95)
        self.figure.text(LEFT / WIDTH, 1 - 0.15 / height, title, va="top", size=12, weight="bold",
                         parse_math=False)
        self.figure.text(0.1 / WIDTH, 0.08 / height, "\n".join(lines), size=7.5, color="0.3",
                         parse_math=False)
        if labels:
            self.figure.legend(handles, labels, ncol=columns, title=key, alignment="left",
                               loc="upper left", borderaxespad=0, borderpad=0,
                               bbox_to_anchor=(LEFT / WIDTH, 1 - 0.5 / height))
        left, room = LEFT, WIDTH - LEFT - 0.25 - GAP * (len(self.panels) - 1)
        for axes, width in zip(self.panels, np.array(self.widths) / sum(self.widths)):
            axes.set_position([left / WIDTH, below / height, room * width / WIDTH,
                               1 - (below + top) / height])
            left += room * width + GAP
        part = path.with_name(path.name + ".part")
        try:
            self.figure.savefig(part, format="png")
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
        print(path)
