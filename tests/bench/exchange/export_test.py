#!/usr/bin/env python3
"""What `wobblebench export` writes, read by NumPy, VTK and ITK (plastimatch), against closed forms: a
ball away from all axes, so that no axis can be exchanged or mirrored unseen."""
import os
import re
import shutil
import subprocess
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkNrrdReader
from vtkmodules.vtkIOPLY import vtkPLYReader

from support import BALL, BALL_SCENE, InFolder, RADIUS, SMALL_SCAN, off_ball, positions, run, settings

# The axis in front of the centre of curvature, and behind it, as real fans have it.
PROBES = {"standard": [], "behind": settings("probe.wobble_radius_mm=75", "acquisition.fan_deg=40")}


def read_volume(reader, file):
    reader.SetFileName(file)
    reader.Update()
    image = reader.GetOutput()
    size = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(size[::-1])
    return values, np.array(image.GetSpacing()), np.array(image.GetOrigin())


def centroid(mask, spacing, origin):
    z, y, x = np.nonzero(mask)
    return origin + spacing * np.array([x.mean(), y.mean(), z.mean()])


class Ball(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, probe in PROBES.items():
            files = [f"{name}.npz", f"{name}.nrrd,spacing_mm=1", f"{name}.seq.nrrd,spacing_mm=1",
                     f"{name}.mha", f"{name}_grid.mha,content=cartesian,spacing_mm=1,type=float",
                     f"{name}_labels.nrrd,content=labels,spacing_mm=1",
                     f"{name}_polar.nrrd,content=polar,type=uint16", f"{name}_polar.mha,content=polar",
                     f"{name}.ply", f"{name}_true.ply,content=truth"]
            to = [word for file in files for word in ("--to", cls.path(file))]
            run("export", "sim", *BALL_SCENE, *settings("render.ray_casting.image_size=192"), *probe, *to)

    def scans(self):
        for name in PROBES:
            yield name, np.load(self.path(name + ".npz"))

    def at(self, scan):
        return positions(scan["theta_deg"], scan["motor_angle_deg"][0], scan["range_mm"],
                         float(scan["radius_mm"]), float(scan["wobble_radius_mm"]))

    def test_labels_are_the_ball_where_the_geometry_puts_the_samples(self):
        for _, scan in self.scans():
            off = off_ball(scan)
            inside = scan["labels"][0] == scan["labels"][0][off < -1][0]
            self.assertGreater((off < -1).sum(), 500)
            # Tissue maps resolve a tenth of a millimetre.
            self.assertTrue(inside[off < -0.1].all())
            self.assertFalse(inside[off > 0.1].any())

    def test_times_and_angles_are_those_of_the_schedule(self):
        for name, scan in self.scans():
            period = 2 * 0.16 / 1540
            expected = period * np.arange(21 * 40).reshape(21, 40)
            np.testing.assert_allclose(scan["time_s"][0], expected, atol=1e-8)
            fan = 40 if name == "behind" else 61
            np.testing.assert_allclose(scan["motor_angle_deg"][0][:, 0], np.linspace(-fan / 2, fan / 2, 21))
            np.testing.assert_allclose(scan["theta_deg"], np.linspace(-38.5, 38.5, 40))
            np.testing.assert_allclose(scan["range_mm"], (np.arange(192) + 0.5) * 160 / 192)

    def test_true_and_found_surface_are_the_ball(self):
        for _, scan in self.scans():
            for key, p95_mm in (("truth", 0.005), ("found", 2.0)):
                depth = scan[key + "_depth_mm"]
                points = scan["ray_origin_mm"] + depth[..., None] * scan["ray_direction"]
                known = points[(scan["truth_reason"] == 1) & ~np.isnan(depth)]
                self.assertGreater(len(known), 5000)
                off = abs(np.linalg.norm(known - BALL, axis=-1) - RADIUS)
                self.assertLess(np.percentile(off, 95), p95_mm, key)
            self.assertLess(np.median(abs(np.linalg.norm(known - BALL, axis=-1) - RADIUS)), 0.6)

    def test_grids_lie_where_vtk_reads_them(self):
        for name in PROBES:
            labels, spacing, origin = read_volume(vtkNrrdReader(), self.path(name + "_labels.nrrd"))
            np.testing.assert_allclose(spacing, 1)
            z, y, x = np.indices(labels.shape)
            off = np.linalg.norm(np.stack([x, y, z], -1) * spacing + origin - BALL, axis=-1) - RADIUS
            inside = labels == labels[off < -1][0]
            self.assertTrue(inside[off < -0.1].all())
            self.assertFalse(inside[off > 0.1].any())
            np.testing.assert_allclose(centroid(inside, spacing, origin), BALL, atol=0.03)

    def test_grid_values_are_the_samples_between_which_they_lie(self):
        for name, scan in self.scans():
            grid, spacing, origin = read_volume(vtkMetaImageReader(), self.path(name + "_grid.mha"))
            theta, motor = scan["theta_deg"], scan["motor_angle_deg"][0][:, 0]
            a, b = float(scan["radius_mm"]), float(scan["radius_mm"] - scan["wobble_radius_mm"])
            rng, wrong = np.random.default_rng(3), []
            for index in rng.integers(0, grid.shape, (4000, 3)):
                x, y, z = origin + spacing * index[::-1]
                # The distance from the axis gives the depth in the image plane; r and theta follow.
                depth = b + np.hypot(y, z - b)
                place = [(np.degrees(np.arctan2(-y, z - b)) - motor[0]) / (motor[1] - motor[0]),
                         (np.degrees(np.arctan2(x, depth)) - theta[0]) / (theta[1] - theta[0]),
                         (np.hypot(x, depth) - a) / (160 / 192) - 0.5]
                last = np.array(scan["samples"].shape[1:]) - 1
                value = grid[tuple(index)]
                if min(place) < -0.5 or (place > last + 0.5).any():
                    self.assertEqual(value, 0)
                if min(place) < 0 or (place >= last).any():
                    continue
                low = np.floor(place).astype(int)
                cell = scan["samples"][0][tuple(slice(i, i + 2) for i in low)]
                for share in (place - low)[::1]:
                    cell = cell[0] * (1 - share) + cell[1] * share
                wrong.append(abs(cell - value))
            self.assertGreater(len(wrong), 500)
            self.assertLess(max(wrong), 1e-4)

    def test_polar_files_hold_the_samples(self):
        for name, scan in self.scans():
            samples = scan["samples"][0]
            values, _, _ = read_volume(vtkNrrdReader(), self.path(name + "_polar.nrrd"))
            np.testing.assert_array_equal(values, np.rint(65535 * samples.astype(np.float64)))
            values, _, _ = read_volume(vtkMetaImageReader(), self.path(name + "_polar.mha"))
            self.assertLess(np.abs(values - 255 * samples.astype(np.float64)).max(), 0.5 + 1e-4)

    def test_planes_lie_where_their_transforms_put_them(self):
        for name, scan in self.scans():
            file = self.path(name + ".mha")
            planes, spacing, _ = read_volume(vtkMetaImageReader(), file)
            np.testing.assert_allclose(spacing, [0.5, 0.5, 1])
            with open(file, "rb") as whole:
                header = whole.read().split(b"ElementDataFile")[0].decode()
            at, inside, samples = self.at(scan), off_ball(scan) < 0, scan["samples"][0].astype(float)
            self.assertGreater(inside.sum(), 1000)
            self.assertGreater(np.median(samples[inside]), 0.3)
            padded = np.pad(samples, ((0, 0), (1, 1), (1, 1)), "edge")
            around = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), (1, 2))
            spread = abs(around - samples[..., None, None]).max((-2, -1))
            line_mm = np.diff(np.radians(scan["theta_deg"])).mean() * (scan["radius_mm"] + scan["range_mm"])
            per_mm = np.broadcast_to(1 / line_mm + 1 / np.diff(scan["range_mm"]).mean(), samples.shape)
            for frame in np.nonzero(inside.any((1, 2)))[0]:
                text = re.search(rf"Seq_Frame{frame:04}_ImageToReferenceTransform = (.*)", header)[1]
                pose = np.array(text.split(), float).reshape(4, 4)
                self.assertAlmostEqual(np.linalg.det(pose[:3, :3]), 0.5 ** 3, places=9)
                here = inside[frame]
                pixel = np.linalg.inv(pose) @ np.concatenate([at[frame][here].T, np.ones((1, here.sum()))])
                np.testing.assert_allclose(pixel[2], 0, atol=1e-6)
                column, row = np.rint(pixel[:2]).astype(int)
                # A pixel is interpolated: it differs from a sample beside it by a share of that one's difference from
                # its neighbours, and by half a grey level.
                share = 0.5 * np.hypot(*(pixel[:2] - np.rint(pixel[:2]))) * per_mm[frame][here]
                wrong = abs(planes[frame][row, column] / 255 - samples[frame][here])
                self.assertLess((wrong - share * spread[frame][here]).max(), 0.51 / 255, (name, frame))

    def test_sequence_has_its_time_axis_last(self):
        with open(self.path("standard.seq.nrrd"), "rb") as file:
            header = file.read(2000).split(b"\n\n")[0].decode()
        self.assertIn("dimension: 4", header)
        self.assertRegex(header, r"sizes: \d+ \d+ \d+ 1\n")
        self.assertIn("(0,0,1) none", header)
        self.assertIn("kinds: domain domain domain list", header)
        self.assertIn("axis 3 index values:=0", header)

    def test_surfaces_as_vtk_reads_them(self):
        for name in PROBES:
            for file, p95_mm in (("_true.ply", 0.005), (".ply", 2.0)):
                reader = vtkPLYReader()
                reader.SetFileName(self.path(name + file))
                reader.Update()
                mesh = reader.GetOutput()
                points = vtk_to_numpy(mesh.GetPoints().GetData())
                normals = vtk_to_numpy(mesh.GetPointData().GetNormals())
                triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
                out = points - BALL
                distance = np.linalg.norm(out, axis=1)
                self.assertGreater(len(triangles), 5000)
                self.assertLess(np.percentile(abs(distance - RADIUS), 90), p95_mm)
                # Out of the ball, and so do the corners of each triangle turn.
                core = np.linalg.norm(out[:, :2], axis=1) < 0.6 * RADIUS
                self.assertGreater(np.median((normals * out).sum(1)[core] / distance[core]), 0.9)
                a, b, c = (points[triangles[:, i]] for i in range(3))
                turned = (np.cross(b - a, c - a) * (a - BALL)).sum(1)
                self.assertGreater((turned > 0).mean(), 0.9)

    def test_signed_error_is_found_less_true_depth(self):
        scan = np.load(self.path("standard.npz"))
        error = (scan["found_depth_mm"] - scan["truth_depth_mm"])[~np.isnan(scan["found_depth_mm"])]
        with open(self.path("standard.ply"), "rb") as file:
            header, body = file.read().split(b"end_header\n", 1)
        count = int(re.search(rb"element vertex (\d+)", header)[1])
        kind = np.dtype([("p", "<f4", 3), ("n", "<f4", 3), ("rgb", "u1", 3), ("error", "<f4")])
        np.testing.assert_allclose(np.frombuffer(body, kind, count)["error"], error, atol=1e-4)

    @unittest.skipUnless(shutil.which("plastimatch"), "plastimatch, a program over ITK, is not installed")
    def test_itk_finds_values_at_positions(self):
        for name in PROBES:
            for axis in range(3):
                for sign in (-1, 1):
                    for far, expected in ((0.9, True), (1.1, False)):
                        at = BALL.copy()
                        at[axis] += sign * far * RADIUS
                        text = subprocess.run(["plastimatch", "probe", "--location", " ".join(map(str, at)),
                             self.path(name + "_labels.nrrd")], capture_output=True, text=True, check=True).stdout
                        inside = float(text.split(";")[-1]) == self.inside_label(name)
                        self.assertEqual(inside, expected, (name, at, text))

    def inside_label(self, name):
        scan = np.load(self.path(name + ".npz"))
        return scan["labels"][0][off_ball(scan) < -1][0]


class Slices(InFolder):
    """Pass 1 of plain sticks without a filter: each pixel is interpolated between the samples around it."""

    def test_slices_are_interpolated_samples(self):
        for motor in ("stepped", "alternating"):
            run("export", "sim", *BALL_SCENE, *settings(
                f"acquisition.motor={motor}", "render.reconstruction.sticks=plain",
                "render.scan_conversion.filter_size=1", "render.ray_casting.kernel_3d=1", "render.ray_casting.iso_level=0.72",
                "render.scan_conversion.format=r32f", "render.scan_conversion.slice_size=200"), "--volumes", 2, "--to",
                self.path(f"{motor}.npz") + ",content=polar", "--to", self.path(f"{motor}_slices.npz") + ",content=slices")
            scan, made = np.load(self.path(f"{motor}.npz")), np.load(self.path(f"{motor}_slices.npz"))
            self.assertEqual(int(made["volume"]), 1)
            # Motor angles of the second volume's sticks: those of the slices, turned with the stick.
            angles = made["motor_angle_deg"][:, None] + float(made["turn"]) * scan["theta_deg"]
            np.testing.assert_allclose(angles, scan["motor_angle_deg"][1], atol=1e-9)
            self.assertEqual(float(made["turn"]) != 0, motor == "alternating")
            self.assertAlmostEqual(float(made["axis_mm"]), float(scan["radius_mm"] - scan["wobble_radius_mm"]))
            x, depth = np.meshgrid(made["x_mm"], made["depth_mm"])
            theta, r = np.degrees(np.arctan2(x, depth)), np.hypot(x, depth) - float(scan["radius_mm"])
            line = (theta - scan["theta_deg"][0]) / np.diff(scan["theta_deg"]).mean()
            sample = (r - scan["range_mm"][0]) / np.diff(scan["range_mm"]).mean()
            within = ((line > 0) & (line < len(scan["theta_deg"]) - 1) &
                      (sample > 0) & (sample < len(scan["range_mm"]) - 1))
            self.assertGreater(within.mean(), 0.3)
            i, k = line[within].astype(int), sample[within].astype(int)
            u, v = line[within] - i, sample[within] - k
            for frame in (0, 9, 20):
                s = scan["samples"][1, frame].astype(np.float64)
                expected = ((1 - u) * ((1 - v) * s[i, k] + v * s[i, k + 1]) +
                            u * ((1 - v) * s[i + 1, k] + v * s[i + 1, k + 1]))
                self.assertLess(np.abs(made["slices"][frame][within] - expected).max(), 1e-3)
            self.assertGreater(made["slices"].max(), 0.3)


class FetalFace(InFolder):
    """The hand lies at one side of the face: the picture's left and right stay what they are."""

    def test_hand_stays_at_its_side(self):
        scene = settings("phantom.name=fetal_face", "render.ray_casting.image_size=128", *SMALL_SCAN)
        run("export", "sim", *scene, "--to", self.path("face.npz"), "--to",
            self.path("face.nrrd") + ",content=labels,spacing_mm=1", "--to", self.path("true.ply") + ",content=truth")
        scan = np.load(self.path("face.npz"))
        labels, spacing, origin = read_volume(vtkNrrdReader(), self.path("face.nrrd"))
        at = positions(scan["theta_deg"], scan["motor_angle_deg"][0], scan["range_mm"],
                       float(scan["radius_mm"]), float(scan["wobble_radius_mm"]))
        x, y, z = np.rint((at - origin) / spacing).astype(int).reshape(-1, 3).T
        here = scan["labels"][0].reshape(-1)
        agree = (labels[z, y, x] == here).mean()
        mirrored = (labels[z, y, -1 - x] == here).mean()
        self.assertGreater(agree, 0.985)
        self.assertLess(mirrored, agree - 0.005)
        # The true surface is not its own mirror image either, and lies as the picture shows it.
        depth, origin_mm = scan["truth_depth_mm"], scan["ray_origin_mm"]
        self.assertGreater(origin_mm[0, -1, 0], origin_mm[0, 0, 0], "columns grow with x")
        reader = vtkPLYReader()
        reader.SetFileName(self.path("true.ply"))
        reader.Update()
        points = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
        expected = (origin_mm + depth[..., None] * scan["ray_direction"])[~np.isnan(depth)]
        np.testing.assert_allclose(points, expected, atol=2e-4)


class Several(InFolder):
    def test_volumes_follow_each_other(self):
        scene = settings("phantom.name=sphere", "motion.velocity_mm_s=[20, 0, 0]",
                         "acquisition.frames_per_volume=7", "acquisition.sticks_per_frame=9",
                         "acquisition.samples_per_stick=16")
        run("export", "sim", *scene, "--volumes", 3, "--to", self.path("three.npz") + ",content=polar",
            "--to", self.path("three.seq.nrrd") + ",content=polar,type=float", "--to",
            self.path("three.mha") + ",content=polar,type=float")
        scan = np.load(self.path("three.npz"))
        self.assertEqual(scan["samples"].shape, (3, 7, 9, 16))
        self.assertEqual(scan["volume"].tolist(), [0, 1, 2])
        self.assertFalse((scan["samples"][0] == scan["samples"][1]).all())
        with open(self.path("three.seq.nrrd"), "rb") as file:
            header, body = file.read().split(b"\n\n", 1)
        np.testing.assert_array_equal(np.frombuffer(body, "<f4").reshape(3, 7, 9, 16), scan["samples"])
        times = re.search(r"axis 3 index values:=(.*)", header.decode())[1].split()
        np.testing.assert_allclose(np.array(times, float), scan["time_s"].min(axis=(1, 2)), atol=1e-8)
        frames, _, _ = read_volume(vtkMetaImageReader(), self.path("three.mha"))
        np.testing.assert_array_equal(frames.reshape(3, 7, 9, 16), scan["samples"])

    def test_frames_of_many_angles_are_refused(self):
        """A file with one angle a frame would be read with sticks up to half a step off."""
        for motor in ("continuous", "alternating", "fly_back"):
            scene = settings("phantom.name=sphere", f"acquisition.motor={motor}", *SMALL_SCAN)
            for name in ("a.nrrd,content=polar", "a.seq.nrrd,content=polar", "a.mha,content=polar", "a.mha", "a.vol"):
                said = run("export", "sim", *scene, "--to", self.path(name), code=2)
                self.assertIn("holds one motor angle a frame", said)
            said = run("stream", *scene, "--send", "igtl=0,content=polar", "--out", self.path("s"), code=2)
            self.assertIn("polar: holds one motor angle a frame", said)

    def test_recording_gives_what_the_scene_gives(self):
        scene = settings("phantom.name=sphere", *SMALL_SCAN)
        run("record", *scene, "--volumes", 2, "--out", self.path("rec"))
        run("export", self.path("rec/recording.wbst"), "--volumes", 2, "--to", self.path("rec.npz") + ",content=polar",
            *settings("phantom.name=sphere"))
        run("export", "sim", *scene, "--volumes", 2, "--to", self.path("sim.npz") + ",content=polar")
        a, b = np.load(self.path("rec.npz")), np.load(self.path("sim.npz"))
        for key in a.files:
            np.testing.assert_array_equal(a[key], b[key], key)

    def test_folder_of_a_run_is_its_scene(self):
        scene = settings("phantom.name=sphere", "simulation.seed=7", "render.ray_casting.image_size=96", *SMALL_SCAN)
        run("run", *scene, "--out", self.path("run"))
        run("export", self.path("run"), "--to", self.path("again.npz"))
        run("export", "sim", *scene, "--to", self.path("direct.npz"))
        a, b = np.load(self.path("again.npz")), np.load(self.path("direct.npz"))
        for key in set(b.files) - {"source", "label_names"}:
            np.testing.assert_allclose(a[key], b[key], rtol=1e-5, atol=1e-5, err_msg=key)


class Refusals(InFolder):
    def refused(self, *arguments, says):
        before = sorted(os.listdir(self.folder))
        line = run("export", *arguments, code=2)
        self.assertEqual(line.count("\n"), 1, line)
        self.assertIn(says, line)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_one_line_each_and_nothing_written(self):
        to = self.path("a.npz")
        self.refused("sim", says="--to: is missing")
        self.refused("sim", "--to", self.path("a.xyz"), says="must end with .npz")
        self.refused("sim", "--to", to + ",spacing_mm=1", says="spacing_mm: acts with content=cartesian")
        self.refused("sim", "--to", to + ",type=uint8", says="type: acts with samples in .nrrd and .mha")
        self.refused("sim", "--to", to + ",content=planes", says="content = planes: must be one of everything, polar")
        self.refused("sim", "--to", self.path("a.nrrd"), "--volumes", 2, says="holds one volume")
        self.refused("sim", "--to", self.path("a.vol"), "--volumes", 2, says="holds one volume")
        self.refused("sim", "--to", to + ",colour=1", says="no such key")
        self.refused("sim", "--to", to, "--to", "/tmp/b.npz", says="must lie in one folder")
        self.refused("missing.wbst", "--to", to, says="missing.wbst")
        self.refused(self.folder, "--to", to, says="report.json: is missing")
        self.refused("sim", "--to", self.path("a.nrrd") + ",spacing_mm=0.02", says="voxels; must have at most 2e9")
        with open(self.path("kept.npz"), "w", encoding="ascii") as file:
            file.write("mine")
        self.refused("sim", "--to", self.path("kept.npz"), says="exists; must be a new file")


if __name__ == "__main__":
    unittest.main()
