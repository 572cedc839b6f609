"""The Python module against the program: the same bytes, the same lines, arrays without copies, threads, Ctrl-C."""
import copy
import functools
import gc
import json
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy
import OpenImageIO

import wobblebench

PROGRAM = os.environ["WOBBLEBENCH_PROGRAM"]
USERS_ENVIRONMENT = dict(os.environ)
CACHE = tempfile.TemporaryDirectory()  # not the user's
os.environ["XDG_CACHE_HOME"] = CACHE.name
# Off the easy place: another preset, another seed, turned, an even number of frames.
SETTINGS = {"phantom.name": "sphere", "phantom.radius_mm": 22, "placement.position_mm": [6, -4, 112],
    "probe.preset": "c5-2v", "acquisition.frames_per_volume": 14, "acquisition.sticks_per_frame": 40,
    "acquisition.samples_per_stick": 256, "simulation.seed": 7, "render.view.yaw_deg": 20,
    "render.ray_casting.incidence_correction_mm": 0.8, "render.ray_casting.image_size": 96}


def as_arguments(settings):
    return [word for key, value in settings.items() for word in ("--set", f"{key}={json.dumps(value)}")]


def run_program(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)


def exr_channels(path):
    picture = OpenImageIO.ImageInput.open(str(path))
    pixels = picture.read_image("float")
    return {name: pixels[:, :, i] for i, name in enumerate(picture.spec().channelnames)}


class AgainstProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name) / "run"
        cls.recording = pathlib.Path(cls.folder.name) / "record/recording.wbst"
        for command, out in (("run --labels", cls.out), ("record", cls.recording.parent)):
            done = run_program(*command.split(), *as_arguments(SETTINGS), "--out", str(out))
            assert done.returncode == 0, done.stderr
        cls.report = json.loads((cls.out / "report.json").read_text())
        cls.scene = wobblebench.Scene(settings=SETTINGS)
        cls.volume = wobblebench.simulate(cls.scene)
        cls.picture = wobblebench.Renderer(cls.scene).render(cls.volume)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def assert_same_mm(self, depth_m, channel_mm):
        numpy.testing.assert_array_equal(depth_m * numpy.float32(1000), channel_mm)

    def test_depth_is_that_of_run_to_the_byte(self):
        file = exr_channels(self.out / "depth.exr")
        self.assert_same_mm(self.picture.depth_m, file["Z"])
        self.assert_same_mm(self.picture.filtered_depth_m, file["Z_filtered"])
        numpy.testing.assert_array_equal(self.picture.drawn, file["drawn"])

    def test_truth_is_that_of_run(self):
        file = exr_channels(self.out / "truth_depth.exr")
        truth = wobblebench.truth(self.scene)
        self.assert_same_mm(truth.depth_m, file["Z"])
        self.assert_same_mm(truth.crossing_m, file["Z_crossing"])
        numpy.testing.assert_array_equal(truth.reason, file["truth_reason"])
        labels = exr_channels(self.out / "labels.exr")
        numpy.testing.assert_array_equal(truth.part, labels["part"])
        numpy.testing.assert_array_equal(truth.part > 0, truth.reason > 0)

    def test_every_measure_is_that_of_run(self):
        self.assertEqual(wobblebench.score(self.picture, self.scene), self.report["error"])

    def test_score_of_a_depth_map_is_that_of_its_picture(self):
        figures = wobblebench.score(self.picture.depth_m, self.scene)
        for key in ("bias_mm", "p95_mm", "pixels", "missed_percent", "false_percent", "distance_p95_mm"):
            self.assertEqual(figures[key], self.report["error"][key])
        # By numpy, as docs/output.md says.
        truth = wobblebench.truth(self.scene)
        error = (self.picture.depth_m - truth.depth_m)[~numpy.isnan(self.picture.depth_m) & (truth.reason == 1)]
        self.assertAlmostEqual(figures["bias_mm"], 1e3 * error.mean(dtype=float), places=3)
        shifted = wobblebench.score(self.picture.depth_m + numpy.float32(1e-3), self.scene)
        self.assertAlmostEqual(shifted["bias_mm"] - figures["bias_mm"], 1, places=3)

    def test_score_of_a_depth_map_is_that_of_the_command(self):
        depth_mm = 1e3 * self.picture.depth_m.astype(float)
        depth_mm[numpy.isnan(depth_mm)] = 4000
        file = os.path.join(self.folder.name, "depth.npy")
        numpy.save(file, depth_mm)
        out = os.path.join(self.folder.name, "score")
        scene = pathlib.Path(self.folder.name, "scene.toml")
        scene.write_text("")
        done = run_program("score", file, "--scene", str(scene), *as_arguments(SETTINGS), "--unit", "mm", "--far", "4000", "--kind", "z", "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        expected = json.loads(pathlib.Path(out, "report.json").read_text())["error"]
        self.assertEqual(wobblebench.score(depth_mm, self.scene, unit="mm", kind="z", far=4000), expected)

    def test_resolved_options_and_camera_are_those_of_the_report(self):
        self.assertEqual(self.scene.options, self.report["scene"])
        self.assertEqual(self.picture.camera, self.report["camera"])

    def test_a_recording_holds_the_simulated_samples(self):
        recording = wobblebench.Recording(str(self.recording))
        self.assertTrue(recording.complete and not recording.damaged)
        volumes = list(recording)
        self.assertEqual(len(volumes), 1)
        numpy.testing.assert_array_equal(volumes[0].samples, self.volume.samples)
        frames = list(wobblebench.Board(f"file={self.recording}").frames())
        self.assertEqual([frame.index for frame in frames], list(range(14)))
        self.assertEqual([frame.ends_volume for frame in frames], [False] * 13 + [True])
        numpy.testing.assert_array_equal(frames[5].samples, self.volume.samples[5])

    def test_a_recording_with_its_scene_is_scored_as_by_run(self):
        board = wobblebench.Board(f"file={self.recording}", self.scene)
        picture = wobblebench.Renderer(board.scene).render(next(board))
        self.assertEqual(wobblebench.score(picture, board.scene), self.report["error"])
        for cause in ("ring_full", "link", "corrupt", "out_of_order"):
            self.assertEqual(board.account["lost_" + cause], 0)

    def test_lost_sticks_are_marked_and_counted(self):
        board = wobblebench.Board(f"file={self.recording},faults=drop@101+drop@102")
        volume = next(board)
        # The first packet is the configuration.
        numpy.testing.assert_array_equal(numpy.flatnonzero(~volume.arrived), [100, 101])
        self.assertEqual(volume.samples[~volume.arrived].max(), 0)
        self.assertEqual(board.account["lost_link"], 2)

    def test_other_settings_are_those_of_run(self):
        settings = {"render.ray_casting.detector": "iso", "render.view.yaw_deg": -15}
        tuned = self.scene.replace(settings)
        renderer = wobblebench.Renderer(self.scene)
        renderer.render(self.volume)
        figures = wobblebench.score(renderer.render(scene=tuned), tuned)
        out = pathlib.Path(self.folder.name) / "tuned"
        run_program("run", *as_arguments({**SETTINGS, **settings}), "--out", str(out))
        self.assertEqual(figures, json.loads((out / "report.json").read_text())["error"])

    def test_bad_input_raises_the_program_s_line(self):
        for settings in ({"phantom.radius_mm": -3}, {"phantom.nmae": "sphere"}, {"probe.preset": "x"},
                         {"render.ray_casting.steps": 1.5}, {"placement.position_mm": [1, 2]},
                         {"phantom.name": "points"} | {"phantom.scatterers": "/nowhere.csv"}):
            with self.assertRaises(wobblebench.BadInput) as raised:
                wobblebench.simulate(wobblebench.Scene(settings=settings))
            done = run_program("run", *as_arguments(settings), "--out", self.folder.name + "/bad")
            self.assertEqual(done.returncode, 2)
            self.assertEqual("wobblebench: " + str(raised.exception), done.stderr.strip().splitlines()[-1])
        for board in ("file=/nowhere.wbst", "simm", "file=" + __file__):
            with self.assertRaises(wobblebench.Error) as raised:
                list(wobblebench.Board(board, self.scene))
            done = run_program("run", *as_arguments(SETTINGS), "--board", board, "--out", self.folder.name + "/bad")
            self.assertEqual("wobblebench: " + str(raised.exception), done.stderr.strip().splitlines()[-1])
            self.assertEqual(done.returncode, 2 if isinstance(raised.exception, wobblebench.BadInput) else 1)

    def test_another_scene_than_the_recording_s_is_refused(self):
        with self.assertRaisesRegex(wobblebench.BadInput, "phantom"):
            wobblebench.Board(f"file={self.recording}", self.scene.replace({"phantom.radius_mm": 30}))

    def test_options_without_effect_are_warned_of(self):
        scene = self.scene.replace({"phantom.gestational_age_weeks": 25})
        with self.assertWarnsRegex(wobblebench.SceneWarning, "gestational_age_weeks"):
            wobblebench.truth(scene)

    def test_depths_that_can_be_none_are_refused(self):
        size = SETTINGS["render.ray_casting.image_size"]
        for wrong in (numpy.inf, numpy.nan, -1.0):
            with self.assertRaisesRegex(wobblebench.BadInput, "depth: holds no surface"):
                wobblebench.score(numpy.full((size, size), wrong, numpy.float32), self.scene)
        with self.assertRaisesRegex(wobblebench.BadInput, "in millimetres they would fit"):
            wobblebench.score(1e3 * self.picture.depth_m, self.scene)
        for words in ({"unit": "cm"}, {"kind": "depth"}):
            with self.assertRaises(ValueError):
                wobblebench.score(self.picture.depth_m, self.scene, **words)

    def test_settings_of_wrong_types_are_refused(self):
        for wrong in ("phantom.name=sphere", {1: 2}, {"phantom.name": None}, [1]):
            with self.assertRaises(TypeError):
                wobblebench.Scene(settings=wrong)
        same = [wobblebench.Scene(settings={"placement.position_mm": position}).given
                for position in ([1, 2, 110], (1, 2, 110), numpy.array([1.0, 2, 110]))]
        self.assertEqual(same, [{"placement.position_mm"}] * 3)

    def test_what_would_be_ignored_is_refused(self):
        with self.assertRaisesRegex(wobblebench.BadInput, "image_size"):
            wobblebench.score(numpy.ones((5, 5), numpy.float32), self.scene)
        other = wobblebench.Scene(settings={**SETTINGS, "acquisition.frames_per_volume": 10})
        with self.assertRaisesRegex(wobblebench.BadInput, "plan"):
            wobblebench.Renderer(self.scene).render(self.volume, other)
        board = wobblebench.Board(f"file={self.recording}", self.scene)
        with self.assertRaisesRegex(wobblebench.BadInput, "render"):
            board.scene.replace({"phantom.radius_mm": 30})


class Arrays(unittest.TestCase):
    def setUp(self):
        self.scene = wobblebench.Scene(settings=SETTINGS)
        self.volume = wobblebench.simulate(self.scene)

    def test_views_show_the_same_memory_and_keep_it(self):
        first, second = self.volume.samples, self.volume.samples
        self.assertFalse(first.flags.owndata)
        self.assertEqual(first.__array_interface__["data"], second.__array_interface__["data"])
        kept = first[3, 5].copy()
        row = first[3, 5]
        del first, second
        self.volume = None
        gc.collect()
        numpy.testing.assert_array_equal(row, kept)

    def test_what_is_written_to_a_volume_is_rendered(self):
        renderer = wobblebench.Renderer(self.scene)
        before = renderer.render(self.volume)
        self.volume.samples[:] = 0
        self.assertTrue(numpy.isnan(renderer.render(self.volume).depth_m).all())
        self.assertFalse(numpy.isnan(before.depth_m).all())

    def test_pictures_and_truth_cannot_be_written(self):
        picture = wobblebench.Renderer(self.scene).render(self.volume)
        for array in (picture.depth_m, picture.surface, wobblebench.truth(self.scene).reason, self.volume.arrived):
            with self.assertRaises(ValueError):
                array[0, 0] = 0

    def test_geometry_is_that_of_docs_units(self):
        """x = r sin(theta), y = -(r cos(theta) - b) sin(phi), z = b (1 - cos(phi)) + r cos(theta) cos(phi)."""
        volume = self.volume
        self.assertEqual(volume.samples.shape, (14, 40, 256))
        depth_m = self.scene.options["acquisition"]["depth_mm"] / 1e3
        numpy.testing.assert_allclose(volume.ranges_m, (numpy.arange(256) + 0.5) * depth_m / 256, rtol=1e-12)
        half_sector = numpy.radians(self.scene.options["acquisition"]["sector_deg"]) / 2
        numpy.testing.assert_allclose(volume.line_angles_rad, numpy.linspace(-half_sector, half_sector, 40), atol=1e-12)
        # The first bright sample of a stick lies on the sphere's near side.
        r = volume.radius_m + volume.ranges_m
        b = volume.radius_m - volume.wobble_radius_m
        phi, theta = volume.frame_angles_rad[:, None, None], volume.line_angles_rad[None, :, None]
        points = numpy.stack(numpy.broadcast_arrays(r * numpy.sin(theta), -(r * numpy.cos(theta) - b) * numpy.sin(phi),
            b * (1 - numpy.cos(phi)) + r * numpy.cos(theta) * numpy.cos(phi)), axis=-1)
        is_bright = volume.samples > 0.5
        first = is_bright & (numpy.cumsum(is_bright, axis=2) == 1)
        self.assertGreater(first.sum(), 20)
        distances = numpy.linalg.norm(points[first] - numpy.array([6e-3, -4e-3, 112e-3]), axis=-1)
        self.assertLess(abs(numpy.median(distances) - 22e-3), 1e-3)
        self.assertTrue((numpy.diff(volume.times_s.ravel()) > 0).all())


def run_threads(*targets):
    threads = [threading.Thread(target=target) for target in targets]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


class Threads(unittest.TestCase):
    def test_renderers_of_several_threads_make_the_same_pictures(self):
        scene = wobblebench.Scene(settings=SETTINGS)
        volume = wobblebench.simulate(scene)
        expected = wobblebench.Renderer(scene).render(volume).depth_m
        shared = wobblebench.Renderer(scene)
        found, failed = [], []

        def work(renderer):
            try:
                for _ in range(3):
                    found.append(renderer.render(volume).depth_m)
                    found.append(shared.render(volume).depth_m)
            except BaseException as error:  # noqa: B902
                failed.append(error)

        run_threads(*[functools.partial(work, wobblebench.Renderer(scene)) for _ in range(4)])
        self.assertEqual(failed, [])
        self.assertEqual(len(found), 24)
        for depth_m in found:
            numpy.testing.assert_array_equal(depth_m, expected)

    def test_a_call_that_waits_for_another_stops_no_third_thread(self):
        """Truths are made one after the other; the simulator waits for each."""
        scene = wobblebench.Scene(settings=SETTINGS)
        gaps, took, is_over = [], [], threading.Event()

        def tick():
            last = time.monotonic()
            while not is_over.is_set():
                time.sleep(0.001)
                gaps.append(time.monotonic() - last)
                last += gaps[-1]

        def make_truths():
            for size in (600, 601, 602, 603):
                begun = time.monotonic()
                wobblebench.truth(scene.replace({"render.ray_casting.image_size": size}))
                took.append(time.monotonic() - begun)
            is_over.set()

        def simulate():
            while not is_over.is_set():
                wobblebench.simulate(scene)

        run_threads(tick, make_truths, simulate)
        self.assertLess(max(gaps), min(took) / 2)

    def test_one_board_read_by_two_threads_gives_each_volume_once(self):
        scene = wobblebench.Scene(settings={**SETTINGS, "acquisition.volumes": 4, "simulation.fidelity": "geometry"})
        board = wobblebench.Board("sim", scene)
        numbers = []
        run_threads(*[lambda: numbers.extend(frame.volume for frame in board.frames())] * 2)
        self.assertEqual(sorted(numbers), sorted(list(range(4)) * 14))


INTERRUPTED = """
import sys, wobblebench
scene = wobblebench.Scene(settings={"phantom.name": "sphere", "acquisition.volumes": 1000})
print("reading", flush=True)
try:
    for volume in wobblebench.Board("sim", scene):
        pass
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(5)
"""


# A calculation that cannot be stopped: the process ends under it.
LEFT = """
import sys, wobblebench
scene = wobblebench.Scene(settings={"simulation.fidelity": "scatterers", "acquisition.frames_per_volume": 200})
print("reading", flush=True)
try:
    wobblebench.simulate(scene)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(5)
"""


class Process(unittest.TestCase):
    def test_ctrl_c_raises_keyboard_interrupt_and_the_process_ends_with_its_code(self):
        for code in (INTERRUPTED, LEFT):
            child = subprocess.Popen([sys.executable, "-W", "ignore", "-c", code], stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, text=True, env=USERS_ENVIRONMENT)
            self.assertEqual(child.stdout.readline(), "reading\n")
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            out, err = child.communicate()
            self.assertEqual((out, err, child.returncode), ("interrupted\n", "", 5))

    def test_a_process_that_is_forked_after_rendering_is_refused_by_a_line_that_names_spawn(self):
        code = ("import multiprocessing as m, pickle, wobblebench as w; s = w.Scene(settings={'phantom.name': 'sphere',"
                "'render.ray_casting.image_size': 64}); v = w.simulate(s); r = w.Renderer(s); r.render(v)\n"
                "def job(of):\n" "    try: return of().render(v).depth_m.shape\n"
                "    except w.Failed as error: return str(error)\n"
                "def simulate(): return float(w.simulate(s).samples.mean())\n"
                "jobs = (lambda: job(lambda: w.Renderer(s)), lambda: job(lambda: r), lambda: simulate() > 0)\n"
                "def work(number): return jobs[number]()\n"
                "with m.get_context('fork').Pool(1) as pool: print(pool.map_async(work, range(3)).get(20))")
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.count('multiprocessing.get_context("spawn")'), 2, done.stdout)
        self.assertTrue(done.stdout.endswith("True]\n"), done.stdout)

    def test_a_scene_can_be_pickled(self):
        scene = wobblebench.Scene(settings=SETTINGS)
        again = pickle.loads(pickle.dumps(scene))
        self.assertEqual((again.given, again.options), (scene.given, scene.options))
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write("[phantom]\nname = \"sphere\"\n")
            file.flush()
            self.assertEqual(copy.copy(wobblebench.Scene(file.name)).given, {"phantom.name"})

    def test_a_module_of_another_python_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            package = pathlib.Path(folder) / "wobblebench"
            package.mkdir()
            shutil.copy(wobblebench.__file__, package)
            (package / "_wobblebench.cpython-37m.so").touch()
            done = subprocess.run([sys.executable, "-c", "import wobblebench"], capture_output=True, text=True,
                                  env={**os.environ, "PYTHONPATH": folder})
        self.assertIn("ImportError: wobblebench: _wobblebench.cpython-37m.so is here, which "
                      + sys.implementation.cache_tag + " does not load", done.stderr)

    def test_nothing_is_printed(self):
        code = ("import wobblebench; s = wobblebench.Scene(settings={'phantom.name': 'sphere'}); v = wobblebench.simulate(s);"
                "wobblebench.score(wobblebench.Renderer(s).render(v), s)")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("", "", 0))


if __name__ == "__main__":
    unittest.main(warnings="ignore")
