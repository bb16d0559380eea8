#!/usr/bin/python3
"""Tests of the figure of a study of solvers: what it draws, and what it says is missing."""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "apps"))
sys.dont_write_bytecode = True

import work_precision as figure  # noqa: E402

NAMES = ("solver knob value state is_reference solver_wall_time_s largest_error_percent quantity "
         "which_rupture cheapest_for machine threads program revision bonds scene reference "
         "left_out_by_reference_percent").split()
SAME = "a machine,1,mastic,abc,400,net,events,0.2"
TABLE = "\n".join((
    ",".join(NAMES),
    f"events,,,finished,1,2.5,0,strain,neither,0.1 %,{SAME}",
    f"linear,,,finished,0,0.1,30,strain,neither,,{SAME}",
    f"dynamic,viscosity scaling,1e-05,finished,0,1,5,strain,neither,10 %,{SAME}",
    f"dynamic,viscosity scaling,0.0001,finished,0,10,1e-9,strain,only here,,{SAME}",
    f"dynamic,viscosity scaling,0.001,over budget,0,,,,,,{SAME}",
    f"quasistatic,strain per step,0.008,does not apply,0,,,,,,{SAME}")) + "\n"


class WorkPrecision(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "study.csv"
        self.file.write_text(TABLE)
        self.rows = figure.read(self.file)

    def test_lines_are_solvers_over_their_knobs(self):
        found = figure.ladders(self.rows)
        self.assertEqual(list(found), [("events", ""), ("linear", ""),
                                       ("dynamic", "viscosity scaling")])
        self.assertEqual([row["value"] for row in found["dynamic", "viscosity scaling"]],
                         [1e-5, 1e-4])

    def test_tiny_errors_are_drawn_at_the_floor(self):
        self.assertEqual(figure.drawn_error(self.rows[3]), figure.FLOOR)
        self.assertEqual(figure.drawn_error(self.rows[2]), 5)

    def test_small_print_names_what_is_not_drawn(self):
        text = " ".join(figure.notes(self.rows))
        for part in ("Over budget: dynamic, viscosity scaling 0.001.", "Does not apply: quasistatic.",
                     "Open symbol:", "are drawn there.", "a machine, 1 thread(s)", "400 bonds",
                     "Cheapest for 0.1 %: the reference itself."):
            self.assertIn(part, text)

    def test_legend_names_every_line_and_the_reference(self):
        labels = [text.get_text() for text in figure.draw(self.rows).legends[0].get_texts()]
        self.assertEqual(labels[:3], ["linear", "dynamic, viscosity scaling",
                                      "reference: events, 2.5 s"])
        self.assertIn("0.2 %", labels[3])

    def test_table_without_runs_is_refused(self):
        self.file.write_text(",".join(NAMES) + "\n")
        with self.assertRaisesRegex(ValueError, "no runs"):
            figure.read(self.file)


if __name__ == "__main__":
    unittest.main()
