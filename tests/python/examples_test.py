"""Runs the examples as their users would."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

PROGRAM = pathlib.Path(os.environ["WOBBLEBENCH_PROGRAM"])
CACHE = tempfile.TemporaryDirectory()  # not the user's
os.environ["XDG_CACHE_HOME"] = CACHE.name
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
SMALL = [word for setting in ("phantom.name=sphere", "acquisition.frames_per_volume=13", "acquisition.sticks_per_frame=32",
                              "acquisition.samples_per_stick=256", "render.ray_casting.image_size=64")
         for word in ("--set", setting)]


class Examples(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def answer(self, *command):
        environment = {**os.environ, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
        done = subprocess.run(list(command), capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def python(self, name, *arguments):
        return self.answer(sys.executable, str(EXAMPLES / "python" / name), *arguments)

    def test_render_and_score_says_what_run_reports(self):
        said = self.python("render_and_score.py", "", self.path("depth.npy"), *SMALL)
        report = json.loads(self.answer(str(PROGRAM), "run", *SMALL, "--json", "--out", self.path("run")))
        error = report["error"]
        self.assertIn(f"P95 {error['p95_mm']:.2f} mm, missed {error['missed_percent']:.2f} %", said)
        found = ~numpy.isnan(numpy.load(self.path("depth.npy")))
        self.assertGreaterEqual(found.sum(), error["pixels"])

    def test_tuning_ends_and_repeats(self):
        said = [self.python("tune.py", "--trials", "5", *SMALL) for _ in range(2)]
        self.assertRegex(said[0], r"^\d+\.\d+ by the scene's own settings\n\d+\.\d+ with render\.\S+ \S+, render\.\S+ \S+, render\.\S+ \S+\n$")
        own, tuned = (float(line.split()[0]) for line in said[0].splitlines())
        self.assertLessEqual(tuned, own)
        self.assertEqual(said[0], said[1])

    def test_a_recording_is_looked_at(self):
        self.answer(str(PROGRAM), "record", *SMALL[:8], "--out", self.path("record"))
        said = self.python("look_at_recording.py", self.path("record/recording.wbst"))
        self.assertIn("1 volumes, 416 sticks, 0 lost, complete\nvolume 0: frames, lines, samples (13, 32, 256)\n", said)
        self.assertEqual(said.count(" mm: mean "), 8)

    def test_errors_of_seeds_is_a_table(self):
        scene = self.path("scene.toml")
        pathlib.Path(scene).write_text("[phantom]\nname = \"sphere\"\n[acquisition]\nframes_per_volume = 13\n"
                                       "sticks_per_frame = 32\n[render.ray_casting]\nimage_size = 64\n")
        rows = self.answer("sh", str(EXAMPLES / "shell/errors_of_seeds.sh"), scene, "1", "2").splitlines()
        self.assertEqual(rows[0], "seed,bias_mm,p95_mm,missed_percent")
        self.assertEqual([row.split(",")[0] for row in rows[1:]], ['"1"', '"2"'])
        self.assertNotEqual(*(row.split(",")[1] for row in rows[1:]))


if __name__ == "__main__":
    unittest.main()
