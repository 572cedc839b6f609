#!/usr/bin/env python3
"""HDF5 files for zea, read by h5py, and DICOM Enhanced US Volumes, read by pydicom and dciodvfy, against
closed forms: a ball away from all axes."""
import shutil
import subprocess
import unittest

import h5py
import numpy as np
import pydicom

from support import InFolder, SMALL_SCAN, positions, run, settings

BALL = np.array([14.0, -9.0, 106.0])
RADIUS = 18.0
SCENE = settings("phantom.name=sphere", f"phantom.radius_mm={RADIUS}",
                 f"placement.position_mm=[{BALL[0]}, {BALL[1]}, {BALL[2]}]", "probe.wobble_radius_mm=60", *SMALL_SCAN)


class Zea(InFolder):
    """The rules are those of zea/data/spec.py (commit 01c5d71)."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        run("export", "sim", *SCENE, "--volumes", 2, "--to", cls.path("a.hdf5"),
            "--to", cls.path("a.npz") + ",content=polar")
        cls.scan = np.load(cls.path("a.npz"))
        cls.file = h5py.File(cls.path("a.hdf5"))
        cls.addClassCleanup(cls.file.close)
        cls.data = cls.file["tracks/track_0/data"]

    def test_samples_are_db_below_white_with_a_position_each(self):
        image = self.data["image"]
        values = image["values"]
        self.assertEqual((values.dtype, values.shape), (np.float32, (2, 192, 40, 21)))
        self.assertLessEqual(values[()].max(), 0)
        self.assertEqual(image["unit"].asstr()[()], "dB")
        expected = 60 * (self.scan["samples"].transpose(0, 3, 2, 1) - 1)
        np.testing.assert_allclose(values[()], expected, atol=1e-4)
        at = positions(self.scan["theta_deg"], self.scan["motor_angle_deg"][0], self.scan["range_mm"],
                       float(self.scan["radius_mm"]), float(self.scan["wobble_radius_mm"]))
        for group in self.data.values():
            coordinates = group["coordinates"]
            self.assertEqual((coordinates.dtype, coordinates.shape), (np.float32, (2, 192, 40, 21, 3)))
            np.testing.assert_allclose(1e3 * coordinates[1], at.transpose(2, 1, 0, 3), atol=1e-4)
            self.assertEqual(coordinates.attrs["unit"], "m")

    def test_truth_is_the_ball(self):
        segments, names = self.data["segmentation/values"], self.data["segmentation/labels"].asstr()[()]
        self.assertEqual(segments.dtype, np.bool_)
        self.assertEqual(segments.shape, (2, 192, 40, 21, len(names)))
        self.assertTrue((segments[()].sum(-1) == 1).all())
        off = np.linalg.norm(1e3 * self.data["image/coordinates"][0] - BALL, axis=-1) - RADIUS
        here = segments[0]
        ball = int(np.argmax(here[off < -1].sum(0)))
        self.assertTrue(here[..., ball][off < -0.1].all())
        self.assertFalse(here[..., ball][off > 0.1].any())
        speed = self.data["sos_map/values"][0]
        self.assertEqual(self.data["sos_map/unit"].asstr()[()], "m/s")
        self.assertEqual(len(np.unique(speed[off < -0.1])), 1)
        self.assertTrue(((speed > 1400) & (speed < 1700)).all())

    def test_says_that_it_is_simulated(self):
        self.assertIn("SIMULATED", self.file.attrs["description"])
        self.assertIn("simulated", self.file.attrs["us_machine"])


class Dicom(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        run("export", "sim", *SCENE, "--to", cls.path("a.dcm") + ",spacing_mm=1",
            "--to", cls.path("grid.mha") + ",content=cartesian,spacing_mm=1")
        cls.volume = pydicom.dcmread(cls.path("a.dcm"))

    def test_voxels_and_positions_are_those_of_the_grid(self):
        with open(self.path("grid.mha"), "rb") as file:
            header, body = file.read().split(b"ElementDataFile = LOCAL\n", 1)
        size = header.decode().split("DimSize =")[1].split("\n")[0].split()
        self.assertEqual(self.volume.pixel_array.shape, tuple(map(int, size))[::-1])
        np.testing.assert_array_equal(self.volume.pixel_array.reshape(-1), np.frombuffer(body, np.uint8))
        shared = self.volume.SharedFunctionalGroupsSequence[0]
        self.assertEqual(list(shared.PlaneOrientationVolumeSequence[0].ImageOrientationVolume), [1, 0, 0, 0, 1, 0])
        self.assertEqual([float(v) for v in shared.PixelMeasuresSequence[0].PixelSpacing], [1, 1])
        origin = np.array(header.decode().split("Offset =")[1].split("\n")[0].split(), float)
        frames = self.volume.PerFrameFunctionalGroupsSequence
        for index in (0, 7, len(frames) - 1):
            position = frames[index].PlanePositionVolumeSequence[0].ImagePositionVolume
            np.testing.assert_allclose(position, origin + [0, 0, index])
            self.assertEqual(frames[index].FrameContentSequence[0].DimensionIndexValues, index + 1)

    def test_transducer_lies_at_the_face(self):
        """y of the transducer's frame points into the body, and the frame is right-handed."""
        matrix = np.array(self.volume.VolumeToTransducerMappingMatrix).reshape(4, 4)
        np.testing.assert_allclose(matrix @ [0, 0, 40, 1], [0, 0, 0, 1], atol=1e-12)
        np.testing.assert_allclose(matrix @ [5, 0, 70, 1], [5, 30, 0, 1], atol=1e-12)
        self.assertAlmostEqual(np.linalg.det(matrix[:3, :3]), 1)

    def test_is_marked_as_simulated(self):
        self.assertEqual(str(self.volume.PatientName), "SIMULATED^WOBBLEBENCH")
        self.assertIn("SIMULATED", self.volume.SeriesDescription)

    @unittest.skipUnless(shutil.which("dciodvfy"), "dciodvfy (dicom3tools) is not installed")
    def test_standard_has_nothing_against_it(self):
        done = subprocess.run(["dciodvfy", self.path("a.dcm")], capture_output=True, text=True, check=False)
        said = done.stdout + done.stderr
        self.assertIn("EnhancedUltrasoundVolume", said)
        self.assertNotIn("Error", said)
        self.assertNotIn("Warning", said)


if __name__ == "__main__":
    unittest.main()
