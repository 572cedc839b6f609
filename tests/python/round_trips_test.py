"""Scenes drawn at random, through every export and back, and through `score`, `compare` and the Python module: what comes
back is what was scanned, within the digits of the format, or is refused in a line. ROUND_TRIPS: how many scenes (20).
ROUND_TRIPS_SEED: another number draws other scenes (1)."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy

import wobblebench
from module_test import PROGRAM, as_arguments, exr_channels

COUNT = int(os.environ.get("ROUND_TRIPS", 20))
SEED = int(os.environ.get("ROUND_TRIPS_SEED", 1))
# Endings, what they are asked for, and how far a surface may move by their digits: .vol has 8 bits.
FORMATS = {"nrrd": (",content=polar,type=float", 0.02), "seq.nrrd": (",content=polar,type=float", 0.02),
           "mha": (",content=polar,type=float", 0.02), "hdf5": ("", 0.02), "vol": ("", 0.5)}
# Without knowledge of the aperture, which no format but ours has, nothing is corrected.
ALIKE = {"render.ray_casting.incidence_correction_mm": 0, "render.ray_casting.iso_level": 0.72,
         "render.scan_conversion.slice_size": 96, "render.ray_casting.image_size": 48, "render.ray_casting.steps": 96,
         "render.volume_of_interest.size_mm": [80, 80, 80]}


def drawn(seed):
    """A scene, and the words of its board."""
    random = numpy.random.default_rng([SEED, seed])
    middle = numpy.round(random.uniform([-12, -12, 92], [12, 12, 112]), 2).tolist()
    scene = {**ALIKE, "phantom.name": "sphere", "phantom.voxel_mm": 1.5, "phantom.radius_mm": int(random.integers(14, 22)),
             "placement.position_mm": middle, "render.volume_of_interest.center_mm": middle,
             "acquisition.frames_per_volume": int(random.integers(7, 14)), "acquisition.sticks_per_frame": int(random.integers(20, 33)),
             "acquisition.samples_per_stick": int(random.integers(100, 200)),
             "simulation.fidelity": str(random.choice(["geometry", "field"])), "simulation.seed": int(random.integers(1, 3)),
             "render.view.yaw_deg": int(random.integers(-40, 40)), "render.view.pitch_deg": int(random.integers(-20, 20))}
    if random.random() < 0.6:
        scene["probe.preset"] = str(random.choice(["c5-2v", "curvilinear-60"]))
    if random.random() < 0.4:
        scene["acquisition.motor"] = str(random.choice(["continuous", "alternating", "fly_back"]))
    if random.random() < 0.3:
        scene["acquisition.focal_zones"] = 2
    if random.random() < 0.5:
        scene["motion.velocity_mm_s"] = random.integers(-20, 20, 3).tolist()
    board = f"sim,first_volume={random.integers(0, 5)}"
    if random.random() < 0.2:
        board += f",faults=drop:0.03+seed:{random.integers(1, 100)}"
    return scene, board


class RoundTrips(unittest.TestCase):
    def run_program(self, *words, allowed=(0,)):
        """Exit code, and all that was said. A refusal is one line."""
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
        self.assertIn(done.returncode, allowed, f"{words}: {done.stderr}")
        if done.returncode == 2:
            self.assertEqual(len(re.findall("^wobblebench: (?!warning)", done.stderr, re.M)), 1, done.stderr)
        return done.returncode, done.stdout + done.stderr

    def figures(self, folder):
        return json.loads((self.at / folder / "report.json").read_text())

    def depth_mm(self, folder):
        return exr_channels(self.at / folder / "depth.exr")["Z"].astype(float)

    def through_file(self, ending, lost):
        """Whether a scan came back."""
        how, digits_mm = FORMATS[ending]
        code, said = self.run_program("export", self.at / "run", "--to", self.at / f"scan.{ending}{how}", allowed=(0, 2))
        if code == 2:
            return False
        self.assertIn(f"{lost} sticks were lost" if lost else "scan ", said)
        if lost:  # no format but ours says which sticks are missing: the line above is what a reader has
            return False
        board = f"file={self.at}/scan.{ending}"
        if ending == "vol":  # the format does not say it
            (self.at / "vol.toml").write_text("[geometry]\ndynamic_range_db = 60\n")
            board += f",geometry={self.at}/vol.toml"
        view = {key: value for key, value in self.scene.items() if key.startswith("render.")}
        code, said = self.run_program("run", *as_arguments(view), "--board", board, "--out", self.at / ending, allowed=(0, 2))
        if code == 2:
            return False
        self.assert_same_surface(self.depth_mm(ending), self.depth_mm("run"), digits_mm)
        return True

    def assert_same_surface(self, one, other, most_mm):
        """But for a pixel in a hundred: where a level is met within rounding, one ray stops and the other goes on."""
        apart = numpy.abs(numpy.nan_to_num(one, nan=1e3) - numpy.nan_to_num(other, nan=1e3))
        self.assertLess(numpy.quantile(apart, 0.99), most_mm)

    def through_score(self, figures):
        self.run_program("score", self.at / "run/depth.exr", "--scene", self.at / "run/report.json", "--out", self.at / "scored")
        scored = self.figures("scored")["error"]
        for figure in ("bias_mm", "rms_mm", "median_mm", "p95_mm", "max_mm", "outliers_percent", "pixels"):
            self.assertAlmostEqual(scored[figure], figures["error"][figure], places=4, msg=figure)

    def through_compare(self):
        (self.at / "scene.toml").write_text("".join(f"{key} = {json.dumps(value)}\n" for key, value in self.scene.items()))
        code, said = self.run_program("compare", self.at / "run", "this", "--scene", self.at / "scene.toml", "--seeds", 1,
                                      "--out", self.at / "compared", allowed=(0, 1, 2))
        if code != 0:  # `compare` runs seed 1
            self.assertTrue(code == 2 or self.scene["simulation.seed"] != 1 and "nothing was compared" in said, said)
            return False
        changes = [one["change"] for one in self.figures("compared")["verdicts"] if one["figure"] == "p95_mm"]
        self.assertEqual(changes, [0])
        return True

    def through_python(self, figures):
        scene = wobblebench.Scene(settings=self.scene)
        volume = next(wobblebench.Board(self.board, scene))
        self.assertEqual(volume.index, int(re.search(r"first_volume=(\d+)", self.board)[1]))
        picture = wobblebench.Renderer(scene).render(volume)
        of_map = wobblebench.score(picture.depth_m, scene, volume=volume.index)
        self.assertEqual(of_map["p95_mm"], figures["error"]["p95_mm"])
        self.run_program("export", self.at / "run", "--to", self.at / "scan.npz")
        numpy.testing.assert_array_equal(numpy.load(self.at / "scan.npz")["samples"][0], volume.samples)

    def test_scenes(self):
        came_back = dict.fromkeys((*FORMATS, "compare"), 0)
        for seed in range(COUNT):
            self.scene, self.board = drawn(seed)
            with self.subTest(seed=seed, board=self.board, scene=self.scene), tempfile.TemporaryDirectory() as folder:
                self.at = pathlib.Path(folder)
                self.run_program("run", *as_arguments(self.scene), "--board", self.board, "--out", self.at / "run")
                figures = self.figures("run")
                self.through_score(figures)
                self.through_python(figures)
                came_back["compare"] += self.through_compare()
                for place in (seed, seed + 2):
                    ending = list(FORMATS)[place % len(FORMATS)]
                    came_back[ending] += self.through_file(ending, figures["board"]["missing_sticks"])
        print("came back:", came_back)
        # Refusing all would pass everything above.
        self.assertTrue(all(came_back.values()), came_back)


if __name__ == "__main__":
    unittest.main()
