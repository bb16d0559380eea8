#!/usr/bin/python3
"""Tests of the pictures of specimens, on a result of four spheres and three bonds.

usage: specimen_picture_test.py [FOLDER OF specimen_picture.py]
"""
import contextlib
import io
import os
import shutil
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

here = Path(__file__).resolve().parents[2] / "apps"
sys.path.insert(0, sys.argv.pop(1) if sys.argv[1:] and Path(sys.argv[1]).is_dir() else str(here))
sys.dont_write_bytecode = True

import h5py  # noqa: E402
import numpy as np  # noqa: E402
import povray  # noqa: E402
import results  # noqa: E402
import snapshot  # noqa: E402
import specimen_picture  # noqa: E402
import specimen_scenes  # noqa: E402
from matplotlib.colors import LogNorm, to_rgb  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.image import imread  # noqa: E402

SCENE = """set Title = Square
subsection Specimen
  set Source = file
  set File = square.csv
end
subsection Temperature
  set Temperature = 20 degC
end
subsection Strength
  set Distribution = none
end
subsection Loading
  set Test = particle loads
  set Release time = never
end
"""
SIDE = 4e-3  # of a square in the plane y = 0 with a sphere at each corner [m]
CENTRES = SIDE * np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1]])
ENDS = [[0, 1], [2, 3], [0, 2]]  # below, above, on the left
LOWERED = 0.5e-3  # by how much the upper spheres come down [m]
needs_povray = unittest.skipUnless(shutil.which("povray"), "POV-Ray is not installed")


def write(folder, classes=(0, 0, 1, 1), radius=2e-3, particles=True):
    """A result.h5: tension below, compression above, on the left a bond that breaks after 4 s."""
    with h5py.File(Path(folder) / "result.h5", "w") as file:
        file.attrs.update({name: np.bytes_(text) for name, text in (
            ("kind", "result"), ("title", "Square"), ("solver", "linear"), ("program", "mastic"),
            ("revision", "abc"), ("estimated_values", "none"))})
        file["scene/resolved"] = np.frombuffer(SCENE.encode(), np.uint8)
        for name, values in (("time_s", [0, 5, 10]), ("load_factor", [1, 1, 1]),
                             ("mean_displacement_mm", [0, 0.125, 0.25]), ("broken_bonds", [0, 1, 1])):
            file[f"history/{name}"] = np.array(values, float)
        for name, value in (("time_s", 4), ("first_particle", 0), ("second_particle", 2)):
            file[f"breakages/{name}"] = np.array([value], float)
        if not particles:
            return
        file["packing/centre"], file["packing/radius"] = CENTRES, np.full(4, radius)
        file["packing/material_class"] = np.array(classes, np.int32)
        file["bonds/particles"], file["bonds/id"] = np.array(ENDS, np.int32), np.arange(3)
        for k, time in enumerate((0.0, 10.0)):
            group = file.create_group(f"snapshots/{k:04}")
            group.attrs["time_s"] = time
            group["displacement"] = np.array([[0, 0, -LOWERED * k * (i > 1)] for i in range(4)])
            group["bond_force"] = np.array([[20.0, 7, 7], [-10.0, 0, 0], [0, 0, 1.0 - k]])
            group["bond_state"] = np.array([0, 0, 2 * k], np.uint8)


class WithResult(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        write(self.folder)

    def read(self, *rest):
        return snapshot.read(results.Result(self.folder), *rest)


class Times(unittest.TestCase):
    def test_carry_their_unit(self):
        for text, value in (("100 s", 100), ("2 min", 120), ("1.5e-3 h", 5.4), ("7", 7)):
            self.assertAlmostEqual(snapshot.seconds(text), value)

    def test_that_are_none_are_refused(self):
        for text in ("soon", "3 apples", "", "1e s"):
            with self.assertRaisesRegex(ValueError, "is no time"):
                snapshot.seconds(text)


class Snapshot(WithResult):
    def test_is_the_last_or_the_nearest(self):
        self.assertEqual([self.read(*at).time for at in ((), (4.9,), (5.1,), (1e9,))],
                         [10, 0, 10, 10])

    def test_is_displaced_and_magnified(self):
        for factor in (1, 2.5):
            np.testing.assert_allclose(self.read(None, factor).centre[3],
                                       1e3 * np.array([SIDE, 0, SIDE - factor * LOWERED]))

    def test_forces_are_those_along_the_bonds(self):
        np.testing.assert_allclose(self.read(0).force, [20, -10, 1])

    def test_knows_what_broke_so_far(self):
        self.assertEqual(len(self.read(0).broken_time), 0)
        self.assertEqual(self.read().broken_time.tolist(), [4])
        self.assertEqual(self.read().broken_ends.tolist(), [[0, 2]])

    def test_spheres_that_flew_away_are_out_of_sight(self):
        s = self.read()
        s.centre[2] = (0, 1e3, 0)
        self.assertEqual(snapshot.in_sight(s).tolist(), [True, True, False, True])


class Scenes(WithResult):
    def test_show_each_sphere(self):
        bodies = "\n".join(specimen_scenes.packing(self.read()).objects)
        self.assertEqual(bodies.count("sphere {"), 4)
        self.assertIn("<4, 0, 3.5>, 2 texture", bodies)

    def test_show_bonds_by_sign_and_size(self):
        picture = specimen_scenes.forces(self.read())
        self.assertEqual(len(picture.objects), 2)  # the third one is broken
        tension, compression = (text.split(">, ")[2].split() for text in picture.objects)
        self.assertAlmostEqual(float(tension[0]), 2 * float(compression[0]), places=3)
        self.assertEqual(picture.heading, "Bonds: 1 in compression, 1 in tension")
        self.assertEqual(picture.key.norm.vmax, 20)
        ends = [picture.key.scale(picture.key.norm(force))[:3] for force in (-20, 20)]
        np.testing.assert_allclose(ends, [to_rgb(results.COLOURS[k]) for k in (1, 0)], atol=0.01)

    def test_show_broken_bonds_by_time(self):
        s = self.read()._replace(broken_time=np.array([0, 1, 3000.0]), broken_ends=np.array(ENDS))
        picture = specimen_scenes.broken(s, True)
        self.assertEqual("".join(picture.objects).count("cylinder {"), 3)
        self.assertIsInstance(picture.key.norm, LogNorm)
        self.assertEqual(["AtOnce" in text for text in picture.objects], [True, False, False])
        self.assertIn("S63", picture.objects[2])
        self.assertEqual(picture.key.entries[0][1], "at t = 0: 1")

    def test_a_disc_stands_between_its_spheres(self):
        s = self.read(0)
        text = specimen_scenes.disc(s, 0, 1, 1, "S0")
        self.assertRegex(text, r"^cylinder \{ <1\.76, 0, 0>, <2\.24, 0, 0>, 2 ")

    def test_have_colours_for_sizes_or_classes(self):
        self.assertEqual([text for _, text in specimen_scenes.packing(self.read()).key.entries],
                         ["class 0", "class 1"])
        write(self.folder, (0, 0, 0, 0))
        self.assertEqual(specimen_scenes.packing(self.read()).key.entries[0][1], "diameter 4 mm")
        self.assertEqual(len(set(specimen_scenes.class_colours(14))), 13)  # black has no darker one


class Frame(unittest.TestCase):
    def test_holds_every_sphere(self):
        camera = povray.camera_on(1e3 * CENTRES, np.full(4, 2.0))
        self.assertAlmostEqual(camera.width, 8 * povray.MARGIN)
        self.assertAlmostEqual(np.linalg.norm(camera.up), 1)
        self.assertGreater(camera.height, 4 + 4 * np.cos(np.radians(povray.TILT)))

    def test_of_a_tower_is_not_a_line(self):
        camera = povray.camera_on(np.array([[0, 0, z] for z in range(100)]), np.full(100, 0.5))
        self.assertAlmostEqual(camera.width / camera.height, 0.4)

    def test_scale_bar_has_the_length_it_says(self):
        for width, length in ((60, 20), (4.9, 1), (2500, 1000), (125, 50)):
            axes = Figure().add_subplot()
            camera = povray.camera_on(np.zeros((1, 3)), np.array([0.5 * width / povray.MARGIN]))
            specimen_picture.draw_scale_bar(axes, camera)
            self.assertAlmostEqual(np.ptp(axes.lines[0].get_xdata()), length)
            self.assertEqual(axes.texts[0].get_text(), f"{length} mm")


class Command(WithResult):
    def run_it(self, *words):
        """Exit message, standard output and standard error."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                specimen_picture.main([str(self.folder / "pictures"), *map(str, words)])
                message = ""
            except SystemExit as end:
                message = end.code
        return message, out.getvalue(), err.getvalue()

    @needs_povray
    def test_draws_every_picture(self):
        message, out, err = self.run_it(self.folder, "--height", 120, "--time", "10 s")
        self.assertEqual((message, err), ("", ""))
        names = [Path(line).name for line in out.split()]
        self.assertEqual(names, ["specimen_packing.png", "specimen_forces.png",
                                 "specimen_broken.png", "specimen.png"])
        self.assertEqual(sorted(os.listdir(self.folder / "pictures")), sorted(names))
        for line in out.split():
            self.assertGreater(np.std(imread(line)[..., :3]), 0.02)

    @needs_povray
    def test_says_which_snapshot_is_nearest(self):
        message, out, err = self.run_it(self.folder, "--height", 100, "--time", "2 s")
        self.assertEqual(message, "")
        self.assertEqual(err, "note: no snapshot at 2 s; the nearest is at 0 s\n")
        self.assertNotIn("broken", out)  # nothing yet

    def test_says_what_to_install(self):
        with mock.patch.object(povray, "PROGRAM", "povray-that-is-not-there"):
            message, out, _ = self.run_it(self.folder)
        self.assertEqual(message, "specimen_picture.py: pictures of specimens need POV-Ray: install "
                                  "the Debian package povray")
        self.assertEqual(out, "")

    def test_refuses_what_it_cannot_show(self):
        self.assertIn("there is no result.h5 in it", self.run_it(self.folder / "nowhere")[0])
        self.assertIn("is no time", self.run_it(self.folder, "--time", "soon")[0])
        write(self.folder, particles=False)
        self.assertIn("there are no particles in it", self.run_it(self.folder)[0])


@needs_povray
class Render(WithResult):
    def test_puts_spheres_in_their_places_and_colours(self):
        s = self.read(0)
        camera, picture = povray.camera_on(s.centre, s.radius), specimen_scenes.packing(s)
        wide, tall = povray.pixels(camera, 80)
        image = povray.render(povray.scene(camera, picture.textures, picture.objects), wide, tall)
        self.assertEqual(image.shape, (tall, wide, 3))
        np.testing.assert_allclose(image[[0, 0, -1, -1], [0, -1, 0, -1]], 1)  # white corners
        for centre, name in zip(s.centre, s.material_class):
            x, y = ((centre - camera.centre) @ axis for axis in (camera.right, camera.up))
            row, column = tall * (0.5 - y / camera.height), wide * (0.5 + x / camera.width)
            pixel = image[int(row), int(column)]
            colour = np.array(to_rgb(results.COLOURS[name]))
            self.assertEqual(np.argmax(pixel), np.argmax(colour))
            self.assertLess(np.abs(pixel - colour).max(), 0.35)

    def test_failures_are_told_in_a_line(self):
        with self.assertRaisesRegex(ValueError, "^POV-Ray failed: .+"):
            povray.render("sphere { oops", 8, 8)


if __name__ == "__main__":
    unittest.main()
