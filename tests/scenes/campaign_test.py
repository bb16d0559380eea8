#!/usr/bin/python3
"""Studies of many runs as users see them: tables, statistics, failures, resuming, and the report in a browser.

usage: campaign_test.py PATH-OF-MASTIC
"""
import csv
import html
import json
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy as np

MASTIC = sys.argv.pop(1)
ROOT = Path(__file__).resolve().parents[2]
CHROMIUM = shutil.which("chromium")

STUDY = f"""
include {ROOT}/scenes/specimen.inc
set Solver = events
set Title = Small study
subsection Specimen
  set Particles = 150
  set Diameter = 17.6 mm
  set Height = 35.2 mm
end
subsection Loading
  set Axial stress = 600 kPa
  set End time = 300 s
  set Strain limit = 10 %
end
subsection Study
  set Vary   = Loading/Axial stress; Strength/Distribution; Specimen/Seed & Strength/Seed
  set Values = 300 kPa, 1.5 MPa; normal, Weibull; 1 & 1, 1 & 2, 1 & 3, 2 & 1
end
subsection Output
  set ParaView = false
  set History times = 60
end
"""


def mastic(folder, *words, code=0):
    done = subprocess.run([MASTIC, *map(str, words)], capture_output=True, text=True, cwd=folder)
    if done.returncode != code:
        raise AssertionError(f"{words}: exit code {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def rows(file):
    with open(file, newline="", encoding="utf-8") as opened:
        return list(csv.DictReader(opened))


def without_wall_time(file):
    return [{k: v for k, v in row.items() if k != "wall_time_s"} for row in rows(file)]


def in_browser(page, width):
    """What a browser finds in a page of a width: figures that show something, requests, overflow."""
    probe = """<script>window.onload = () => {
      const d = document.getElementById('f').contentDocument, w = d.defaultView;
      for (const e of d.querySelectorAll('details')) e.open = true;
      const seen = [...d.images].filter(i => i.complete && i.naturalWidth > 400);
      document.body.dataset.found = JSON.stringify({
        figures: seen.length, images: d.images.length, title: d.title,
        statements: d.querySelectorAll('table.statements tr').length - 1,
        rows: d.querySelectorAll('table.numbers tr').length,
        outside: w.performance.getEntriesByType('resource').map(e => e.name)
                  .filter(n => !n.startsWith('data:')),
        overflow: d.documentElement.scrollWidth - d.documentElement.clientWidth,
        narrowest: Math.min(...seen.map(i => i.clientWidth))});
    };</script>"""
    frame = Path(tempfile.mkdtemp()) / "frame.html"
    frame.write_text(f'<!DOCTYPE html><body><iframe id="f" width="{width}" height="800" srcdoc="'
                     f'{html.escape(page.read_text(encoding="utf-8"))}"></iframe>{probe}</body>',
                     encoding="utf-8")
    done = subprocess.run(
        [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         f"--user-data-dir={frame.parent}/profile", "--virtual-time-budget=10000", "--dump-dom",
         frame.as_uri()], capture_output=True, text=True, timeout=60)
    found = re.search(r'data-found="([^"]*)"', done.stdout)
    if not found:
        raise AssertionError(f"the browser found nothing: {done.stdout[-300:]} {done.stderr[-500:]}")
    return json.loads(html.unescape(found[1]))


class Campaign(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        (cls.folder / "small.scene").write_text(STUDY)
        cls.output = mastic(cls.folder, "run", "small.scene", "--quiet", "--threads", "2")
        cls.study = cls.folder / "results/small"

    def test_factors_are_combined(self):
        self.assertIn("study of 16 runs", self.output)
        names = [row["run"] for row in rows(self.study / "runs.csv")]
        self.assertEqual(names[:5], ["300-kPa_normal_1_1", "300-kPa_normal_1_2",
                                     "300-kPa_normal_1_3", "300-kPa_normal_2_1",
                                     "300-kPa_Weibull_1_1"])
        self.assertEqual(len(set(names)), 16)
        recipes = {h5py.File(self.study / name / "result.h5")["packing/radius"][()].tobytes()
                   for name in names}
        self.assertEqual(len(recipes), 2)  # packings

    def test_runs_are_what_single_runs_are(self):
        settings = []
        for setting in ("Study/Vary =", "Study/Values =", "Loading/Axial stress = 1.5 MPa",
                        "Strength/Distribution = Weibull", "Specimen/Seed = 2", "Strength/Seed = 1",
                        "Output/Folder = single", "Output/Plots = false"):
            settings += ["--set", setting]
        mastic(self.folder, "run", "small.scene", "--quiet", *settings)
        self.assertEqual((self.folder / "single/history.csv").read_text(),
                         (self.study / "1.5-MPa_Weibull_2_1/history.csv").read_text())

    def test_runs_know_which_values_are_estimates(self):
        with h5py.File(self.study / "300-kPa_normal_1_1/result.h5") as file:
            self.assertIn("Maxwell stiffness", str(file.attrs["estimated_values"]))
        self.assertIn("stand for Maxwell stiffness",
                      (self.study / "1.5-MPa_Weibull_2_1/run.log").read_text())

    def test_seeds_draw_the_same_numbers_for_all_stresses(self):
        def broken_at_once(name):
            with h5py.File(self.study / name / "result.h5") as file:
                times = file["breakages/time_s"][()]
                return set(file["breakages/bond"][()][times < 1e-9])
        for seed in 1, 2, 3:
            low, high = (broken_at_once(f"{s}_normal_1_{seed}") for s in ("300-kPa", "1.5-MPa"))
            self.assertGreater(len(low), 10)
            self.assertTrue(low <= high)
        self.assertFalse(broken_at_once("300-kPa_normal_1_1") <= broken_at_once("1.5-MPa_normal_1_2"))

    def test_statistics_are_those_of_the_summary(self):
        summary = rows(self.study / "summary.csv")
        self.assertEqual(len(summary), 16)
        times = [float(row["rupture_time_s"] or "inf") for row in summary
                 if row["Loading/Axial stress"] == "1.5 MPa"]
        found = {(next(iter(row.values())), row["quantity"]): row
                 for row in rows(self.study / "statistics.csv")}
        row = found["1.5 MPa", "rupture_time_s"]
        self.assertAlmostEqual(float(row["median"]), np.median(times), delta=1e-6 * np.median(times))
        share = found["1.5 MPa", "share_ruptured"]
        self.assertAlmostEqual(float(share["median"]), np.mean(np.isfinite(times)))
        for row in summary:
            with h5py.File(self.study / row["run"] / "result.h5") as file:
                self.assertAlmostEqual(float(row["end_time_s"]), file["history/time_s"][-1],
                                       delta=1e-9 * float(row["end_time_s"]))

    def test_one_file_holds_it_all(self):
        with h5py.File(self.study / "study.h5") as file:
            self.assertEqual(file.attrs["kind"], "study")
            self.assertEqual(bytes(file["tables/summary.csv"][()]).decode(),
                             (self.study / "summary.csv").read_text())
            bands = file["bands/2"]
            self.assertEqual(bands.attrs["group"], "1.5 MPa")
            low, middle, high = (bands[f"axial_strain_percent_{n}"][()]
                                 for n in ("low", "median", "high"))
            known = np.isfinite(high) & np.isfinite(middle)
            self.assertTrue(np.all(low[known] <= middle[known]) and np.all(middle <= high))

    def test_is_drawn_again_as_a_study(self):
        before = (self.study / "summary.csv").read_text()
        said = mastic(self.folder, "plot", "results/small")
        self.assertIn("strain_time_band.png", said)
        self.assertNotIn("strain_time.png", said)
        self.assertEqual((self.study / "summary.csv").read_text(), before)
        self.assertIn("a study of several runs", mastic(self.folder, "info", "results/small", code=2))

    def test_interrupted_and_resumed_it_ends_with_the_same_tables(self):
        folder = Path(tempfile.mkdtemp())
        (folder / "small.scene").write_text(STUDY)
        begun = subprocess.Popen([MASTIC, "run", "small.scene", "--quiet", "--threads", "1"],
                                 cwd=folder, stdout=subprocess.PIPE, text=True)
        while not list(folder.glob("results/small/300-kPa_normal_1_3/result.h5")):
            self.assertIsNone(begun.poll(), "it ended before it could be interrupted")
            time.sleep(0.005)
        begun.send_signal(signal.SIGTERM)
        said, _ = begun.communicate()
        self.assertEqual(begun.returncode, 4, said)
        self.assertIn("to go on: mastic run --resume results/small", said)
        self.assertFalse((folder / "results/small/summary.csv").exists())
        said = mastic(folder, "run", "--resume", "results/small", "--quiet", "--threads", "2")
        self.assertIn("300-kPa_normal_1_1: finished before\n", said)
        self.assertEqual(without_wall_time(folder / "results/small/summary.csv"),
                         without_wall_time(self.study / "summary.csv"))
        for name in ("statistics.csv", "variance.csv"):
            self.assertEqual((folder / "results/small" / name).read_text(),
                             (self.study / name).read_text())

    def test_runs_that_fail_are_listed_and_the_others_finish(self):
        folder = Path(tempfile.mkdtemp())
        (folder / "small.scene").write_text(STUDY)
        settings = ["--set", "Study/Vary = Loading/Axial stress; Specimen/Source & Specimen/File",
                    "--set", "Study/Values = 300 kPa, 1.5 MPa; generate & none, file & nowhere.csv"]
        said = mastic(folder, "run", "small.scene", "--quiet", *settings, code=2)
        self.assertIn("failed: 300-kPa_file_nowhere.csv (exit code 2): error: ", said)
        self.assertIn("2 of 4 runs finished", said)
        summary = {row["run"]: row for row in rows(folder / "results/small/summary.csv")}
        self.assertEqual(summary["1.5-MPa_file_nowhere.csv"]["end"], "failed")
        self.assertEqual(summary["1.5-MPa_generate_none"]["exit_code"], "0")
        page = Path(mastic(folder, "report", "results/small").strip())
        self.assertIn("Runs that failed", (folder / page).read_text())


class UnusualStudies(unittest.TestCase):
    def study(self, vary, values, *settings, code=0, folder=None):
        folder = folder or Path(tempfile.mkdtemp())
        (folder / "small.scene").write_text(STUDY)
        words = []
        for setting in (f"Study/Vary = {vary}", f"Study/Values = {values}", *settings):
            words += ["--set", setting]
        said = mastic(folder, "run", "small.scene", "--quiet", *words, code=code)
        return folder / "results/small", said

    def report(self, study):
        return (study.parent.parent / mastic(study.parent.parent, "report", "results/small").strip()
                ).read_text()

    def test_tension_and_rupture_under_the_load_itself(self):
        study, _ = self.study("Loading/Axial stress; Strength/Seed", "-300 kPa, -20 MPa; 1, 2",
                              "Output/Plots = true")
        found = {(row["Loading/Axial stress"], row["quantity"]): row
                 for row in rows(study / "statistics.csv")}
        self.assertEqual(float(found["-20 MPa", "share_ruptured"]["median"]), 1)
        self.assertEqual(float(found["-20 MPa", "rupture_time_s"]["median"]), 0)
        self.assertGreater(float(found["-300 kPa", "strain_at_common_time_percent"]["median"]), 0)
        self.assertNotIn("Statements of the paper", self.report(study))

    def test_keys_without_a_section(self):
        study, _ = self.study("Solver; Strength/Seed", "events, quasistatic; 1, 2",
                              "Loading/End time = 20 s")
        self.assertEqual([row["Solver"] for row in rows(study / "summary.csv")],
                         ["events", "events", "quasistatic", "quasistatic"])
        self.assertEqual({row["Solver"] for row in rows(study / "statistics.csv")},
                         {"events", "quasistatic"})
        self.assertIn("Solver", self.report(study))

    def test_nothing_but_failures_still_makes_a_page(self):
        study, said = self.study("Specimen/Source & Specimen/File", "file & a.csv, file & b.csv",
                                 code=2)
        self.assertIn("0 of 2 runs finished", said)
        self.assertIn("Runs that failed", self.report(study))

    def test_exit_codes_survive_an_interruption(self):
        study, _ = self.study("Strength/Seed", "1, 2", "Loading/Axial stress = 40 MPa",
                              "Solver = quasistatic", "Loading/Strain limit = 50 %")
        before = (study / "runs.csv").read_text()
        self.assertIn(",5,", before)
        mastic(study.parent.parent, "run", "--resume", "results/small", "--quiet")
        self.assertEqual((study / "runs.csv").read_text(), before)
        (study / "runs.csv").unlink()
        mastic(study.parent.parent, "run", "--resume", "results/small", "--quiet")
        self.assertEqual((study / "runs.csv").read_text(), before)

    def test_a_study_takes_nothing_from_an_earlier_one(self):
        study, _ = self.study("Strength/Seed", "1..3", "Loading/Axial stress = 2 MPa")
        self.assertTrue((study / "rupture_times.png").exists())
        _, said = self.study("Strength/Seed", "1, 2", "Loading/End time = 1 s",
                             "Loading/Axial stress = 1 kPa", folder=study.parent.parent)
        self.assertNotIn("finished before", said)
        self.assertFalse((study / "rupture_times.png").exists())
        self.assertEqual([row["end_time_s"] for row in rows(study / "summary.csv")], ["1", "1"])
        self.assertNotIn("/3/", mastic(study.parent.parent, "plot", "results/small"))

    def test_values_with_quotes_and_long_values(self):
        study, _ = self.study("Title", 'my "best" <b>one</b>, other')
        self.assertEqual(rows(study / "summary.csv")[0]["Title"], 'my "best" <b>one</b>')
        page = self.report(study)
        self.assertIn("my &quot;best&quot; &lt;b&gt;one&lt;/b&gt;", page)
        self.assertNotIn("<b>one</b>", page)

    def test_a_result_that_is_cut_off_does_not_end_the_report(self):
        study, _ = self.study("Strength/Seed", "1, 2")
        file = study / "1/result.h5"
        file.write_bytes(file.read_bytes()[:3000])
        self.assertIn("2 runs, 1 with a result", self.report(study))


class Collection(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        (cls.folder / "creep.scene").write_text(STUDY)
        rate = STUDY.replace("Loading/Axial stress;", "Loading/Strain rate;").replace(
            "300 kPa, 1.5 MPa;", "0.0005 1/s, 0.005 1/s;").replace(
            "  set End time = 300 s\n  set Strain limit = 10 %\n",
            "  set Test = constant rate\n  set End strain = 2 %\n")
        (cls.folder / "rates.scene").write_text(rate)
        (cls.folder / "all.scene").write_text(
            "set Title = All\nsubsection Study\n  set Scene files = creep.scene, rates.scene, "
            f"{ROOT}/scenes/paper/scaling.scene\nend\n")
        cls.output = mastic(cls.folder, "run", "all.scene", "--quiet", "--threads", "2")
        cls.page = cls.folder / "results/all/report.html"

    def test_every_scene_has_its_folder_and_there_is_one_report(self):
        self.assertIn("report results/all/report.html", self.output)
        for name, number in ("creep", 16), ("rates", 16), ("scaling", 2):
            self.assertEqual(len(rows(self.folder / "results/all" / name / "runs.csv")), number)

    def test_statements_are_judged(self):
        said = subprocess.run(["/usr/bin/python3", ROOT / "apps/statements.py",
                               self.folder / "results/all"], capture_output=True, text=True).stdout
        self.assertRegex(said, r"strain grows with stress \| in 8 of 8 series.* \| met \|")
        self.assertRegex(said, r"Fig\. 4.*0\.2991 m at 2000 s, 0\.2991 m at 200 s.* \| met \|")
        self.assertRegex(said, r"peak stress grows by.* per decade")
        page = self.page.read_text()
        self.assertIn(f"{said.count('| met |')} of {len(said.strip().splitlines()) - 2} are met", page)
        self.assertEqual(sum(page.count(f'class="{c}"') for c in ("met", "not", "open")),
                         len(said.strip().splitlines()) - 2)

    def test_report_names_nothing_outside(self):
        page = self.page.read_text()
        for source in re.findall(r'(?:src|href)=["\']?([^"\' >]+)', page):
            self.assertTrue(source.startswith(("data:", "#")), source[:80])
        self.assertNotIn("@import", page)
        self.assertNotIn("<script", page)

    @unittest.skipUnless(CHROMIUM, "chromium is not installed")
    def test_report_in_a_browser(self):
        wide, phone = in_browser(self.page, 1100), in_browser(self.page, 390)
        self.assertEqual(wide["title"], "Report: all")
        self.assertEqual(wide["figures"], wide["images"])
        self.assertGreaterEqual(wide["figures"], 6)
        self.assertGreaterEqual(wide["statements"], 8)
        self.assertGreater(wide["rows"], 30)
        for found in wide, phone:
            self.assertEqual(found["outside"], [])
            self.assertEqual(found["overflow"], 0)
        self.assertGreater(wide["narrowest"], 800)
        self.assertGreater(phone["narrowest"], 300)

    def test_goes_on_from_its_folder(self):
        said = mastic(self.folder, "run", "--resume", "results/all", "--quiet")
        self.assertEqual(said.count("finished before"), 34)
        self.assertIn("report results/all/report.html", said)

    def test_check_names_what_is_missing(self):
        (self.folder / "wrong.scene").write_text(
            "subsection Study\n  set Scene files = creep.scene, nowhere.scene, creep.scene\nend\n")
        said = mastic(self.folder, "check", "wrong.scene", code=2)
        self.assertIn("nowhere.scene: there is no such file", said)
        self.assertIn("two scenes would have their results in a folder 'creep'", said)


if __name__ == "__main__":
    unittest.main()
