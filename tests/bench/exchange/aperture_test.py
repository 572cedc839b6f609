#!/usr/bin/env python3
"""Faces written by `export` and read back without the probe's aperture, with it, and with another one; and what else a
file of another program does not say."""
import json
import os
import re
import unittest

import numpy as np
import OpenImageIO as oiio

from scans import Input, POLAR, geometry_text, kretz, mha
from support import BALL_SCENE, attempt, run, settings

FACE = settings("phantom.identity=7", "phantom.gestational_age_weeks=28", "render.ray_casting.image_size=256")
# As the sources of the presets give them: docs/references.md [14], [15], and decision 6.
PROBES = {"default": dict(radius_mm=40.0, center_frequency_mhz=3.5, fractional_bandwidth=0.6, f_number=4.0, transmit_focus_mm=75.0,
                          elements=128, pitch_mm=0.42, element_height_mm=13.5, elevation_focus_mm=75.0),
          "c5-2v": dict(radius_mm=49.57, center_frequency_mhz=3.57, fractional_bandwidth=0.79, f_number=4.0, transmit_focus_mm=75.0,
                        elements=128, pitch_mm=0.508, element_height_mm=13.5, elevation_focus_mm=60.0),
          "curvilinear-60": dict(radius_mm=60.0, center_frequency_mhz=3.0, fractional_bandwidth=1.0, f_number=4.0, transmit_focus_mm=75.0,
                                 elements=128, pitch_mm=0.477, element_height_mm=14.0, elevation_focus_mm=50.0)}
APERTURE = [key for key in PROBES["default"] if key != "radius_mm"]
UNKNOWN = r"(\S+) mm for a beam (\S+) mm wide, (\S+) mm for one of (\S+) mm"


def width_across_mm(probe, depth_mm):
    """Of a point's echo across the image plane, -6 dB: the lens as a line of sources, over the pulse's band."""
    source = np.linspace(-0.5, 0.5, 301) * probe["element_height_mm"]
    at = np.linspace(0, 15, 601)
    path = np.hypot(depth_mm, at[:, None] - source) - np.hypot(probe["elevation_focus_mm"], source)
    echo = 0
    for share in np.linspace(0.4, 1.6, 25):
        weight = np.exp(-0.5 * ((share - 1) * 2.3548 / probe["fractional_bandwidth"]) ** 2)
        wave_mm = 1.54 / (share * probe["center_frequency_mhz"])
        echo = echo + weight * abs(np.exp(2j * np.pi / wave_mm * path).sum(1)) ** 2
    return 2 * at[np.nonzero(echo >= echo.max() / 2)[0][-1]]


class Face(Input):
    def shown(self, name, *words):
        """What `run` says on stderr, its report and its depth map."""
        done = attempt("run", *words, "--out", self.path(name))
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path(name + "/report.json"), encoding="utf-8") as file:
            report = json.load(file)
        return done.stderr, report, self.depth(name + "/depth.exr")

    def depth(self, name):
        return oiio.ImageBuf(self.path(name)).get_pixels(oiio.FLOAT)[:, :, 0].astype(float)

    def direct(self, preset):
        """The face that is simulated and rendered at once, and the settings that show its scan from the same side."""
        scene = settings(f"probe.preset={preset}") + FACE
        _, report, depth = self.shown("direct-" + preset, *scene)
        box = report["scene"]["render"]["volume_of_interest"]
        same_view = settings("render.ray_casting.image_size=256", *(f"render.volume_of_interest.{key}={box[key]}" for key in box))
        return scene, report, depth, same_view

    def planes(self, preset):
        """Of 8 bits, and all that a geometry file must say of them."""
        file = self.path(f"planes-{preset}.mha")
        scene, report, depth, same_view = self.direct(preset)
        run("export", "sim", *scene, "--replace", "--to", file + ",content=planes")
        with open(file, "rb") as whole:
            fields = dict(re.findall(r"wobblebench_(\S+) = (.*)", whole.read(4000).decode("latin1")))
        probe = report["scene"]["probe"]
        keys = {"layout": "planes", "radius_mm": probe["radius_mm"], "wobble_radius_mm": probe["wobble_radius_mm"],
                "sector_deg": float(fields["sector_deg"]), "fan_deg": 61.0, "depth_mm": 160.0, "spacing_mm": [0.5, 0.5],
                "center_px": [float(word) for word in fields["center_px"].split()], "axes": ["column", "row", "frame"],
                "lines": 64, "samples": 512, "dynamic_range_db": 60.0}
        return file, keys, report, depth, same_view

    def test_an_aperture_that_is_not_known_is_said_once_with_the_surface_that_is_then(self):
        for preset, probe in PROBES.items():
            file, keys, direct, _, same_view = self.planes(preset)
            said, report, found = self.shown("unknown", *same_view, "--board", self.board(file, **keys))
            self.assertEqual(said.count("the aperture of the probe is not known"), 1, said)
            self.assertNotIn("taken to be 60 dB", said)
            self.assertEqual((report["scene"]["probe"]["elements"], report["scene"]["probe"]["element_height_mm"]), (0, 0))
            truth = self.depth(f"direct-{preset}/truth_depth.exr")
            view_plane_mm = -direct["camera"]["world_to_camera"][3][2]
            width_mm = width_across_mm(probe, np.nanmedian(truth) + view_plane_mm - probe["radius_mm"])
            stated = np.array(re.search(UNKNOWN, said).groups(), float)
            slope = (stated[2] - stated[0]) / (stated[3] - stated[1])
            before_mm = stated[0] + slope * (width_mm - stated[1])
            self.assertLess(abs(np.nanmedian(truth - found) - before_mm), 0.3, (preset, width_mm, before_mm))

    def test_an_aperture_that_is_given_shows_the_surface_of_the_direct_run(self):
        scene, _, direct, same_view = self.direct("curvilinear-60")
        file = self.path("polar.mha")
        run("export", "sim", *scene, "--to", file + ",content=polar")
        said, _, own = self.shown("own", *same_view, "--board", "file=" + file)
        self.assertNotIn("is not known", said)
        self.assertLess(np.nanpercentile(abs(own - direct), 95), 0.05)
        self.assertLess(abs(np.nanmedian(own - direct)), 0.01)
        probe = PROBES["curvilinear-60"]
        keys = {"layout": "polar", "radius_mm": 60.0, "wobble_radius_mm": 27.0, "fan_deg": 61.0, "depth_mm": 160.0,
                "sector_deg": np.degrees(127 * 0.477 / 60), "axes": ["sample", "line", "frame"], "dynamic_range_db": 60.0}
        aperture = {key: probe[key] for key in APERTURE}
        for name, more, given in (("keys", [], aperture), ("preset", [], {"preset": "curvilinear-60"}),
                                  ("set", settings("probe.preset=curvilinear-60"), {}),
                                  ("sets", settings(*(f"probe.{key}={value}" for key, value in aperture.items())), {})):
            board = self.board(file, **keys, **given)
            said, report, found = self.shown(name, *same_view, *more, "--board", board)
            self.assertNotIn("the aperture of the probe is not known", said)
            for key, value in aperture.items():
                self.assertAlmostEqual(report["scene"]["probe"][key], value, places=9)
            np.testing.assert_allclose(found, own, atol=1e-3, err_msg=name)


class Unsaid(Input):
    """A scan of a few sticks."""

    def scan(self, **keys):
        voxels = np.full((21, 30, 200), 10, np.uint8)
        voxels[:, :, 120:] = 200
        return self.board(self.write("s.mha", mha(voxels)), **{**POLAR, **keys})

    def line(self, board, *more):
        said = run("run", "--board", board, *more, "--out", self.path("no"), code=2)
        self.assertEqual(said.count("\n"), 1, said)
        return said

    def test_an_aperture_is_given_whole_and_fits_the_face(self):
        for keys, says in (({"elements": 128}, "geometry.pitch_mm: is missing; the beam's width follows from it and elements"),
                           ({"element_height_mm": 8.0, "elevation_focus_mm": 60.0}, "geometry.center_frequency_mhz: is missing"),
                           ({"fractional_bandwidth": 0.7}, "geometry.fractional_bandwidth: acts with elements or element_height_mm"),
                           ({"center_frequency_mhz": 4.0}, "geometry.center_frequency_mhz: acts with elements or"),
                           ({"elements": 0}, "geometry.elements = 0: must be within 1 and 1024"),
                           ({"preset": "c5-2v"}, "geometry.preset: its face has a radius of 49.57 mm, and that of this scan 30 mm")):
            self.assertIn(says, self.line(self.scan(**keys)))
        for word, says in (("probe.element_height_mm=8", "probe.elevation_focus_mm: is missing"),
                           ("probe.preset=c5-2v", "probe.preset = c5-2v: its face has a radius of 49.57 mm, and that of this scan 30 mm"),
                           ("probe.center_frequency_mhz=4", "probe.center_frequency_mhz: acts with probe.elements or"),
                           ("probe.radius_mm=31", "delivers 30"), ("probe.elements=0", "must be within 1 and 1024")):
            self.assertIn(says, self.line(self.scan(), *settings(word)))
        # Of a lens alone the array stays unknown.
        lens = self.scan(element_height_mm=8.0, elevation_focus_mm=60.0, center_frequency_mhz=4.0)
        said = run("run", "--board", lens, "--out", self.path("lens"), *settings("render.ray_casting.image_size=64"))
        self.assertIn("the array of the probe is not known", said)

    def test_a_preset_that_is_not_the_recorded_probe_is_refused(self):
        run("record", *BALL_SCENE, "--out", self.path("rec"))
        said = self.line("file=" + self.path("rec/recording.wbst"), *BALL_SCENE, *settings("probe.preset=c5-2v"))
        self.assertIn("probe.preset = c5-2v: its radius_mm is 49.57; --board file=", said)

    def test_times_that_a_file_does_not_say_are_not_known(self):
        small = settings("render.ray_casting.image_size=64")
        said = run("run", "--board", self.scan(), *small, "--out", self.path("timeless"))
        self.assertNotIn("lines/s", said)
        run("stream", "--board", self.scan(), *small, "--out", self.path("streamed"))
        run("record", "--board", self.scan(), "--out", self.path("recorded"))
        for name in ("timeless", "streamed", "recorded"):
            with open(self.path(name + "/report.json"), encoding="utf-8") as file:
                acquisition = json.load(file)["acquisition"]
            self.assertEqual((acquisition["line_rate_hz"], acquisition["volume_time_ms"]), (None, None), name)
        recording = self.path("recorded/recording.wbst")
        for inspected in (run("inspect", self.path("s.mha"), "--geometry", self.path("geometry.toml")), run("inspect", recording)):
            self.assertIn("times not known", inspected)
            self.assertNotIn("lines/s", inspected)
        for board in (self.scan(), "file=" + recording):
            self.assertIn("pace = realtime: must be asap; the times of this file are not known", self.line(board + ",pace=realtime"))

    def test_what_a_file_does_not_say_stays_unknown_in_what_is_made_of_it(self):
        for name, board in (("import", self.scan(dynamic_range_db=45.0)), ("recording", None)):
            if board is None:
                run("record", "--board", self.scan(dynamic_range_db=45.0), "--out", self.path("kept"))
                board = "file=" + self.path("kept/recording.wbst")
                with open(self.path("kept/report.json"), encoding="utf-8") as file:
                    self.assertEqual(json.load(file)["recording"]["display_scale"],
                                     {"full_scale_db": None, "dynamic_range_db": 45, "tgc_db_per_cm_mhz": None})
            said = run("run", "--board", board, "--out", self.path(name), *settings("render.ray_casting.image_size=64"))
            self.assertNotIn("taken to be 60 dB", said)
            self.assertIn("the aperture of the probe is not known", said)
            with open(self.path(name + "/report.json"), encoding="utf-8") as file:
                report = json.load(file)
            self.assertEqual(report["acquisition"]["volume_time_ms"], None)
            self.assertEqual(report["scene"]["render"]["reconstruction"]["display_range_db"], 45)
            scan = self.exported(board)
            self.assertTrue(np.isnan(scan["time_s"]).all())
            self.assertEqual((float(scan["dynamic_range_db"]), np.isnan(scan["full_scale_db"])), (45, True))
            for file, content in (("back.mha", "polar"), ("back.nrrd", "polar"), ("back.seq.nrrd", "polar"), ("back.hdf5", "polar")):
                run("export", board, "--replace", "--to", self.path(file) + ",content=" + content)
                with open(self.path(file), "rb") as whole:
                    text = whole.read()
                self.assertNotIn(b"Timestamp", text)
                self.assertNotIn(b"time_s", text)
                if file != "back.seq.nrrd":
                    again = self.exported("file=" + self.path(file))
                    self.assertEqual((float(again["dynamic_range_db"]), np.isnan(again["full_scale_db"])), (45, True), file)

    def test_a_recording_of_a_scan_without_an_aperture_is_exported_by_its_name(self):
        run("record", "--board", self.scan(), "--out", self.path("named"))
        self.assertTrue(os.path.exists(self.path("named/recording.json")))
        run("export", self.path("named/recording.wbst"), "--to", self.path("named.npz") + ",content=polar")
        self.assertEqual(np.load(self.path("named.npz"))["samples"].shape, (1, 21, 30, 200))

    def test_an_export_warns_of_lost_sticks(self):
        board = "file=" + self.write("s.mha", mha(np.full((21, 30, 200), 99, np.uint8)))
        board += ",geometry=" + self.write("geometry.toml", geometry_text(**POLAR)) + ",faults=drop:0.1"
        done = attempt("export", board, "--to", self.path("gaps.mha") + ",content=polar", "--to", self.path("gaps.npz") + ",content=polar")
        lost = int((np.load(self.path("gaps.npz"))["arrived"] == 0).sum())
        self.assertGreater(lost, 20)
        self.assertIn(f"{lost} sticks were lost: their samples are 0 in the files", done.stderr)

    def test_a_dynamic_range_is_asked_where_it_is_used(self):
        keys = {key: value for key, value in POLAR.items() if key != "dynamic_range_db"}
        voxels = np.random.default_rng(8).integers(0, 256, (9, 13, 40), dtype=np.uint8)
        board = "file=" + self.write("v.vol", kretz(voxels))
        np.testing.assert_allclose(self.exported(board)["samples"][0], voxels / 255, atol=1e-6)
        small = settings("render.ray_casting.image_size=64")
        self.assertIn("a dynamic range that is not known", run("inspect", self.path("v.vol")))
        file = self.scan().split(",")[0]
        for more, range_db, is_said in (({}, 60, True), ({"dynamic_range_db": 45.0}, 45, False)):
            board = file + ",geometry=" + self.write("g.toml", geometry_text(**keys, **more))
            said = run("run", "--board", board, *small, "--out", self.path("ranged"))
            self.assertEqual("is not known and taken to be 60 dB" in said, is_said)
            with open(self.path("ranged/report.json"), encoding="utf-8") as report:
                shown = json.load(report)["scene"]["render"]["reconstruction"]
            self.assertEqual(shown["display_range_db"], range_db)
            os.rename(self.path("ranged"), self.path(f"ranged-{range_db}"))


if __name__ == "__main__":
    unittest.main()
