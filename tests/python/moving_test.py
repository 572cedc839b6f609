"""A ball that moves at a constant speed, at later volumes, through each step that hands a volume on: `run`, `score`,
`export`, `stream`, `compare` and the Python module. In each, truth and found surface move by speed times time."""
import json
import pathlib
import subprocess
import tempfile
import unittest

import numpy

import wobblebench
from module_test import PROGRAM, as_arguments, exr_channels

SPEED_MM_S = numpy.array([-30.0, 20.0, 40.0])
RADIUS_MM = 18
FRAMES, LINES = 17, 32
VOLUME_S = FRAMES * LINES * (2 * 0.16 / 1540 + 50e-6)
LATER = 3
SETTINGS = {"phantom.name": "sphere", "phantom.radius_mm": RADIUS_MM, "phantom.voxel_mm": 1,
    "placement.position_mm": [6, -4, 100], "motion.velocity_mm_s": SPEED_MM_S.tolist(), "acquisition.depth_mm": 160,
    "acquisition.sound_speed_m_s": 1540, "acquisition.dead_time_us": 50, "acquisition.frames_per_volume": FRAMES,
    "acquisition.sticks_per_frame": LINES, "acquisition.samples_per_stick": 256, "simulation.speckle": False,
    "render.view.yaw_deg": 25, "render.view.pitch_deg": -15, "render.volume_of_interest.center_mm": [0, 0, 105],
    "render.volume_of_interest.size_mm": [90, 90, 90], "render.scan_conversion.slice_size": 128,
    "render.ray_casting.image_size": 96, "render.ray_casting.steps": 128, "render.ray_casting.iso_level": 0.72}


def run_program(*arguments, code=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr}")
    return done.stderr


def points_mm(depth_mm, camera):
    """Positions of the pixels' surface in the probe frame, by the matrices of the report."""
    rows, columns = numpy.nonzero(numpy.isfinite(depth_mm))
    size = len(depth_mm)
    x, y = (2 * columns + 1) / size - 1, 1 - (2 * rows + 1) / size
    back = numpy.linalg.inv(numpy.array(camera["world_to_ndc"], float).reshape(4, 4))

    def at(z):
        point = numpy.stack([x, y, z + 0 * x, 1 + 0 * x], -1) @ back
        return point[:, :3] / point[:, 3:]

    along = at(1) - at(0)
    along /= numpy.linalg.norm(along, axis=1, keepdims=True)
    return at(0) + depth_mm[rows, columns][:, None] * along


def off_ball_mm(points, volume):
    """How far points lie outside the ball at the time of the stick that images them, by docs/units.md: a stick of the
    plane at rest is turned about the motor's axis, which lies 27 mm behind the face of radius 40 mm."""
    axis, (x, y, z) = 40 - 27, points.T
    phi = numpy.degrees(numpy.arctan2(-y, z - axis))
    theta = numpy.degrees(numpy.arctan2(x, axis + numpy.hypot(y, z - axis)))
    frame = numpy.rint((phi / 61 + 0.5) * (FRAMES - 1))
    line = numpy.rint((theta / 77 + 0.5) * (LINES - 1))
    time_s = volume * VOLUME_S + (frame * LINES + line) * VOLUME_S / (FRAMES * LINES)
    middle = numpy.array(SETTINGS["placement.position_mm"]) + time_s[:, None] * SPEED_MM_S
    return numpy.linalg.norm(points - middle, axis=1) - RADIUS_MM


def exr_depth(path):
    return exr_channels(path)["Z"].astype(float)


class MovingBall(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.at = pathlib.Path(cls.folder.name)
        cls.addClassCleanup(cls.folder.cleanup)
        cls.scene = wobblebench.Scene(settings=SETTINGS)
        for number in (0, LATER):
            run_program("run", *as_arguments(SETTINGS), "--board", f"sim,first_volume={number}", "--out", cls.at / f"{number}")
        cls.report = json.loads((cls.at / f"{LATER}/report.json").read_text())
        cls.p95 = cls.report["error"]["p95_mm"]

    def assert_on_ball(self, depth_mm, volume, median, most):
        off = numpy.abs(off_ball_mm(points_mm(depth_mm, self.report["camera"]), volume))
        self.assertGreater(len(off), 500)
        self.assertLess(numpy.median(off), median)
        self.assertLess(numpy.quantile(off, 0.95), most)

    def p95_of(self, folder):
        return json.loads((self.at / folder / "report.json").read_text())["error"]["p95_mm"]

    def test_run(self):
        for volume in (0, LATER):
            self.assert_on_ball(exr_depth(self.at / f"{volume}/truth_depth.exr"), volume, 0.05, 0.15)
            self.assert_on_ball(exr_depth(self.at / f"{volume}/depth.exr"), volume, 1, 3)
        self.assertLess(self.p95, 3)

    def test_score_of_a_report_and_of_its_own_report(self):
        depth = self.at / f"{LATER}/depth.exr"
        run_program("score", depth, "--scene", self.at / f"{LATER}/report.json", "--out", self.at / "s1")
        run_program("score", depth, "--scene", self.at / "s1/report.json", "--out", self.at / "s2")
        (self.at / "scene.toml").write_text("")
        toml = ["score", depth, "--scene", self.at / "scene.toml", *as_arguments(SETTINGS), "--out", self.at / "s3"]
        self.assertIn("--volume: is missing", run_program(*toml, code=2))
        run_program(*toml, "--volume", LATER)
        for folder in ("s1", "s2", "s3"):
            self.assertEqual(self.p95_of(folder), self.p95)
        said = run_program("score", depth, "--scene", self.at / "s1/report.json", "--volume", 1, "--out", self.at / "s4", code=2)
        self.assertIn(f"--volume = 1: {self.at}/s1/report.json is of volume {LATER}", said)

    def test_score_of_a_report_without_its_volume_is_refused(self):
        (self.at / "old.json").write_text(json.dumps({**self.report, "board": {}}))
        said = run_program("score", self.at / f"{LATER}/depth.exr", "--scene", self.at / "old.json", "--out", self.at / "s5", code=2)
        self.assertIn("does not say which volume", said)

    def test_export_of_a_run(self):
        said = run_program("export", self.at / f"{LATER}", "--to", self.at / "later.npz", "--to", self.at / "found.ply", "--to", self.at / "true.ply,content=truth")
        self.assertNotIn("without effect", said)  # of what the report resolved, nobody chose anything
        stream = wobblebench.Board(f"sim,first_volume={LATER}", self.scene)
        numpy.testing.assert_array_equal(numpy.load(self.at / "later.npz")["samples"][0], next(stream).samples)

    def test_export_of_a_run_that_lost_sticks(self):
        board = "sim,first_volume=1,faults=drop:0.1+seed:7"
        run_program("run", *as_arguments(SETTINGS), "--board", board, "--out", self.at / "lossy")
        run_program("export", self.at / "lossy", "--to", self.at / "lossy.npz")
        arrived = numpy.load(self.at / "lossy.npz")["arrived"]
        missing = json.loads((self.at / "lossy/report.json").read_text())["board"]["missing_sticks"]
        self.assertGreater(missing, 30)
        self.assertEqual((~arrived.astype(bool)).sum(), missing)

    def test_stream(self):
        several = {**SETTINGS, "acquisition.volumes": LATER + 1}
        run_program("stream", *as_arguments(several), "--out", self.at / "stream")
        text = (self.at / "stream/report.json").read_text()
        figures = [one["p95_mm"] for one in json.loads(text)["timing"]["errors"]]
        self.assertEqual(len(figures), LATER + 1)
        self.assertAlmostEqual(figures[LATER], self.p95, places=6)

    def test_compare_with_a_run(self):
        def compare(settings, **more):
            (self.at / "ball.toml").write_text("".join(f"{key} = {json.dumps(value)}\n" for key, value in settings.items()))
            return run_program("compare", self.at / f"{LATER}", "this", "--scene", self.at / "ball.toml", "--seeds", 1, "--out", self.at / "c", **more)

        compare(SETTINGS)
        verdicts = json.loads((self.at / "c/report.json").read_text())["verdicts"]
        self.assertEqual([(one["outcome"], one["change"]) for one in verdicts if one["figure"] == "p95_mm"], [("kept", 0)])
        self.assertIn("phantom.radius_mm = 20", compare({**SETTINGS, "phantom.radius_mm": 20}, code=2))

    def test_python(self):
        renderer = wobblebench.Renderer(self.scene)
        several = self.scene.replace({"acquisition.volumes": LATER + 1})
        volumes = list(wobblebench.Board("sim", several))
        self.assertEqual([volume.index for volume in volumes], list(range(LATER + 1)))
        self.assertAlmostEqual(volumes[LATER].times_s[0, 0] - volumes[0].times_s[0, 0], LATER * VOLUME_S, places=9)
        for volume in (volumes[0], volumes[LATER]):
            picture = renderer.render(volume, several)
            of_picture = wobblebench.score(picture, several)["p95_mm"]
            of_map = wobblebench.score(picture.depth_m, several, volume=volume.index)["p95_mm"]
            self.assertEqual(of_map, of_picture)
            truth = wobblebench.truth(several, volume.index)
            self.assert_on_ball(1e3 * truth.depth_m.astype(float), volume.index, 0.05, 0.15)
            self.assert_on_ball(1e3 * picture.depth_m.astype(float), volume.index, 1, 3)
        self.assertEqual(of_picture, self.p95)
        with self.assertRaisesRegex(wobblebench.BadInput, "volume is missing: the scene moves"):
            wobblebench.score(picture.depth_m, several)


class OtherScenes(unittest.TestCase):
    """A picture is scored in the view and with the body that it was made of."""

    def test_another_view_or_body_is_refused(self):
        still = {**SETTINGS, "motion.velocity_mm_s": [0, 0, 0]}
        scene = wobblebench.Scene(settings=still)
        picture = wobblebench.Renderer(scene).render(wobblebench.simulate(scene))
        wobblebench.score(picture, scene)
        for key, value, words in (
                ("render.view.yaw_deg", 30, "render.view.yaw_deg = 30.0 of the scene: the picture was made with 25.0"),
                ("phantom.radius_mm", 25, r"the scene's \[phantom\] is not"),
                ("placement.position_mm", [6, -4, 101], r"the scene's \[placement\] is not"),
                ("motion.velocity_mm_s", [0, 0, 1], r"the scene's \[motion\] is not")):
            with self.assertRaisesRegex(wobblebench.BadInput, words):
                wobblebench.score(picture, scene.replace({key: value}))


if __name__ == "__main__":
    unittest.main()
