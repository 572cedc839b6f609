"""The head that `run --frame` and find_head() find, against the pose that the scene gives it: rotations by NumPy, the face by
the labels of the true surface."""
import json
import pathlib
import subprocess
import tempfile
import unittest

import numpy

import wobblebench
from module_test import PROGRAM

# Of the held-out heads of docs/decisions/0063: face lying sideways, upside down, turned aside, with clutter.
HEADS = [
    {"phantom.identity": 301, "phantom.gestational_age_weeks": 21, "placement.rotation_deg": [0, 0, 90]},
    {"phantom.identity": 302, "phantom.gestational_age_weeks": 30, "placement.rotation_deg": [0, 0, -170],
     "phantom.head_yaw_deg": -25, "phantom.head_pitch_deg": 15},
    {"phantom.identity": 303, "phantom.gestational_age_weeks": 26, "placement.rotation_deg": [0, 0, -80],
     "phantom.head_yaw_deg": 20, "phantom.head_roll_deg": 10, "simulation.preset": "clinical"},
]
SCAN = {"phantom.voxel_mm": 1, "render.ray_casting.image_size": 64, "render.ray_casting.steps": 64}
# The planes that `export` writes of the default probe.
GEOMETRY = """[geometry]
layout = "planes"
radius_mm = 40
wobble_radius_mm = 27
sector_deg = 77
fan_deg = 61
depth_mm = 160
spacing_mm = [0.5, 0.5]
center_px = [250, -62]
"""


def about(axis, degrees):
    """Right-handed rotation about x, y or z."""
    i, j = [(1, 2), (2, 0), (0, 1)]["xyz".index(axis)]
    angle, turn = numpy.radians(degrees), numpy.eye(3)
    turn[i, i] = turn[j, j] = numpy.cos(angle)
    turn[j, i] = numpy.sin(angle)
    turn[i, j] = -turn[j, i]
    return turn


def true_rotation(options):
    def turned(x, y, z):
        return about("z", z) @ about("y", y) @ about("x", x)
    head = [options["phantom"][f"head_{angle}_deg"] for angle in ("pitch", "yaw", "roll")]
    return turned(*options["placement"]["rotation_deg"]) @ turned(*head)


def camera(settings):
    """Right, down and forward, as docs/units.md has them."""
    yaw, pitch, roll = (settings[f"render.view.{angle}_deg"] for angle in ("yaw", "pitch", "roll"))
    return about("y", -yaw) @ about("x", -pitch) @ about("z", roll)


def as_dict(settings):
    return {key: json.loads(value) for key, value in (setting.split("=") for setting in settings)}


def visible_face(scene):
    """Points of the true face that sound reaches, mm."""
    box = scene.options["render"]["volume_of_interest"]
    size, middle, count = [220, 220, box["size_mm"][2]], numpy.array(box["center_mm"]), 128
    truth = wobblebench.truth(scene.replace({"render.volume_of_interest.size_mm": size, "render.ray_casting.image_size": count,
                                             "render.volume_of_interest.center_mm": box["center_mm"]}))
    across = (numpy.arange(count) + 0.5 - count / 2) * size[0] / count
    x, y = numpy.meshgrid(across, across)
    points = middle + numpy.stack([x, y, truth.crossing_m * 1e3 - numpy.linalg.norm(size) / 2], -1)
    return points[(truth.part >= 1) & (truth.part <= 17) & (truth.reason == 1)]


class Frame(unittest.TestCase):
    def check(self, settings, scene):
        """Within 15 degrees of the pose, and no part of the face cut by box or picture."""
        options, found = scene.options, as_dict(settings)
        turn = camera(found).T @ true_rotation(options)
        angle = numpy.degrees(numpy.arccos(numpy.clip((numpy.trace(turn) - 1) / 2, -1, 1)))
        self.assertLess(angle, 15, settings)
        size = numpy.array(found["render.volume_of_interest.size_mm"])
        away = visible_face(scene) - found["render.volume_of_interest.center_mm"]
        self.assertGreater(len(away), 500)
        self.assertTrue((numpy.abs(away) <= size / 2).all(), settings)
        self.assertTrue((numpy.abs(away @ camera(found))[:, :2] <= max(size[:2]) / 2).all(), settings)

    def run_program(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)

    def test_heads(self):
        for head in HEADS:
            scene = wobblebench.Scene("", SCAN | head)
            with self.subTest(**head):
                self.check(wobblebench.find_head(wobblebench.simulate(scene)), scene)

    def test_other_bodies(self):
        for body in ({"phantom.radius_mm": 30}, {"phantom.radius_mm": 45, "simulation.preset": "clinical"},
                     {"phantom.name": "steps"}, {"phantom.name": "plane"}):
            scene = wobblebench.Scene("", {"phantom.name": "sphere"} | body)
            with self.subTest(**body), self.assertRaisesRegex(wobblebench.BadInput, "^find_head: no head was found"):
                wobblebench.find_head(wobblebench.simulate(scene))

    def test_imported_planes_and_what_is_given(self):
        head = HEADS[0] | SCAN
        words = [word for key, value in head.items() for word in ("--set", f"{key}={json.dumps(value)}")]
        with tempfile.TemporaryDirectory() as folder:
            planes, geometry = pathlib.Path(folder, "planes.mha"), pathlib.Path(folder, "scan.toml")
            self.assertEqual(self.run_program("export", "sim", *words, "--to", f"{planes},content=planes").returncode, 0)
            header, pixels = planes.read_bytes().split(b"ElementDataFile", 1)  # what a scanner's file says
            kept = [line for line in header.split(b"\n") if not line.startswith((b"wobblebench", b"Seq_"))]
            planes.write_bytes(b"\n".join(kept) + b"ElementDataFile" + pixels)
            geometry.write_text(GEOMETRY)
            board = ["--board", f"file={planes},geometry={geometry}", *words[-4:]]
            framed = self.run_program("run", *board, "--frame", "--out", f"{folder}/framed")
            self.assertEqual(framed.returncode, 0, framed.stderr)
            line = next(line for line in framed.stdout.splitlines() if line.startswith("frame "))
            settings = line.split("'")[1::2]
            self.check(settings, wobblebench.Scene("", head))
            # They are a user's own: the same picture without --frame.
            again = self.run_program("run", *board, *(word for one in settings for word in ("--set", one)), "--out", f"{folder}/again")
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertEqual(*(pathlib.Path(folder, name, "depth.exr").read_bytes() for name in ("framed", "again")))
            given = self.run_program("run", *board, "--frame", "--set", "render.view.roll_deg=10", "--out", f"{folder}/given")
            self.assertIn("(given, and kept: render.view.roll_deg)", given.stdout)
            report = json.loads(pathlib.Path(folder, "given/report.json").read_text())
            self.assertEqual(report["scene"]["render"]["view"]["roll_deg"], 10)
            self.assertEqual(report["scene"]["render"]["view"]["yaw_deg"], as_dict(settings)["render.view.yaw_deg"])

    def test_a_report_as_the_scene(self):
        """It names every option, and nobody gave them."""
        words = [word for key, value in (HEADS[0] | SCAN).items() for word in ("--set", f"{key}={json.dumps(value)}")]
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.run_program("run", *words, "--out", f"{folder}/run").returncode, 0)
            framed = self.run_program("run", f"{folder}/run/report.json", "--frame", "--out", f"{folder}/framed")
            line = next(line for line in framed.stdout.splitlines() if line.startswith("frame "))
            self.assertNotIn("given", line)
            self.check(line.split("'")[1::2], wobblebench.Scene("", HEADS[0] | SCAN))

    def test_refusal(self):
        with tempfile.TemporaryDirectory() as folder:
            done = self.run_program("run", "--frame", "--set", "phantom.name=sphere", "--set", "phantom.radius_mm=30", "--out", f"{folder}/out")
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, "(?m)^wobblebench: --frame: no head was found behind fluid")
            self.assertFalse(pathlib.Path(folder, "out").exists())


if __name__ == "__main__":
    unittest.main()
