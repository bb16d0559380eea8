"""Scenes of spheres and cylinders as text for POV-Ray, and pictures of them.

Lengths are in mm. The projection is parallel, so that a length across the picture is the same at every depth.
"""
import shutil
import subprocess
import tempfile
from collections import namedtuple
from pathlib import Path

import numpy as np
from matplotlib.image import imread

PROGRAM, PACKAGE = "povray", "povray"  # the command, and Debian's package that has it
TILT = 10.0  # the camera looks down by so much [degrees]
MARGIN = 1.04  # of the frame around what it shows
MIST = 2.0  # length over which it takes all but 1/e, in depths of the scene

Camera = namedtuple("Camera", "centre right up forward width height depth size")


def axes_of_view(tilt=TILT):
    """Unit vectors to the right, up and into the picture; z of the specimen stands upright."""
    cosine, sine = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    return np.array([1.0, 0, 0]), np.array([0, sine, cosine]), np.array([0, cosine, -sine])


def camera_on(centres, radii, narrowest=0.4):
    """A camera whose frame holds spheres; a frame is never narrower than a part of its other side."""
    view = np.array(axes_of_view())
    along = np.asarray(centres) @ view.T
    low, high = (along - radii[:, None]).min(axis=0), (along + radii[:, None]).max(axis=0)
    size = high - low
    width, height = (MARGIN * max(size[k], narrowest * size[1 - k]) for k in (0, 1))
    return Camera(0.5 * (low + high) @ view, *view, width, height, size[2], max(size))


def vector(numbers):
    return "<" + ", ".join(f"{x:.5g}" for x in numbers) + ">"


def texture(name, colour, transmit=0.0):
    """Declares a matt surface of a colour (red, green, blue from 0 to 1)."""
    return (f"#declare {name} = texture {{ pigment {{ srgbt <{colour[0]:.4f}, {colour[1]:.4f}, "
            f"{colour[2]:.4f}, {transmit:.3f}> }} finish {{ Matt }} }}")


def sphere(centre, radius, surface):
    return f"sphere {{ {vector(centre)}, {radius:.5g} texture {{ {surface} }} }}"


def cylinder(start, end, radius, surface):
    return f"cylinder {{ {vector(start)}, {vector(end)}, {radius:.5g} texture {{ {surface} }} }}"


def light(camera, place, strength, soft):
    """A light at a place right, up and towards the viewer, in sizes of the scene, wide if soft."""
    size = camera.size
    where = camera.centre + size * (place[0] * camera.right + place[1] * camera.up
                                    - place[2] * camera.forward)
    wide = (f" area_light {vector(size * camera.right)}, {vector(size * camera.up)}, 4, 4 "
            "adaptive 0 circular orient" if soft else " shadowless")
    return f"light_source {{ {vector(where)}, rgb {strength:g}{wide} }}"


def scene(camera, textures, objects, shadows=True, mist=False):
    """The whole text: a white background, a wide light above on the left, a weak one on the right.

    Mist lets what is far fade into white, where there are no shadows to tell depths apart.
    """
    start = camera.centre - 0.5 * camera.depth * camera.forward
    fog = f"fog {{ fog_type 1 distance {MIST * camera.depth:.5g} color rgb 1 }}"
    lines = ["#version 3.7;",
             "global_settings { assumed_gamma 1.0 max_trace_level 40 }",
             "background { rgb 1 }",
             f"camera {{ orthographic location {vector(start)} direction {vector(camera.forward)} "
             f"right {vector(camera.width * camera.right)} up {vector(camera.height * camera.up)} }}",
             light(camera, (-1.5, 2.2, 3.0), 0.82, shadows),
             light(camera, (2.5, 0.6, 3.0), 0.4, False),
             "#declare Matt = finish { ambient 0.26 diffuse 0.8 specular 0.12 roughness 0.06 }"]
    return "\n".join([*lines, *[fog] * mist, *textures, *objects]) + "\n"


def pixels(camera, height):
    """Width and height of a picture with square pixels."""
    return max(1, round(height * camera.width / camera.height)), height


def require():
    """Raises an error that says what to install if the program is missing."""
    if not shutil.which(PROGRAM):
        raise ValueError(f"pictures of specimens need POV-Ray: install the Debian package {PACKAGE}")


def render(text, width, height, threads=1):
    """The picture of a scene as an array of rows, columns and red, green, blue from 0 to 1."""
    require()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.pov").write_text(text)
        done = subprocess.run(
            [PROGRAM, "+Iscene.pov", "+Oscene.png", f"+W{width}", f"+H{height}", "+FN8", "-D", "-P",
             "+A0.15", "+AM2", "+R2", f"+WT{threads}", "File_Gamma=sRGB"],
            cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace")
        if done.returncode != 0:
            lines = [line for line in done.stderr.splitlines() if "error" in line.lower()]
            raise ValueError(f"POV-Ray failed: {lines[-1].strip() if lines else done.returncode}")
        return imread(Path(folder, "scene.png"))[..., :3]
