#!/usr/bin/env python3
"""Scans in files of other programs, through --board file=: against NumPy's own computation, and against the
published picture of a real probe."""
import gzip
import itertools
import os
import re
import shutil
import struct
import subprocess
import unittest
import zlib

import h5py
import numpy as np

from scans import Input, POLAR, geometry_text, kretz, mha, nrrd
from support import BALL_SCENE, PROGRAM, SMALL_SCAN, SMOOTH, off_ball, positions, run, settings

REAL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "real")


class Polar(Input):
    def test_own_files_come_back(self):
        scene = settings("phantom.name=sphere", "probe.wobble_radius_mm=70", "acquisition.fan_deg=35", *SMALL_SCAN)
        names = {"a.nrrd,content=polar,type=uint16": 1 / 65535, "a.mha,content=polar": 1 / 255, "a.vol": 1 / 255, "a.hdf5": 0}
        to = [word for name in names for word in ("--to", self.path(name))]
        run("export", "sim", *scene, "--to", self.path("a.npz") + ",content=polar", *to)
        scan = np.load(self.path("a.npz"))
        for name, step in names.items():
            keys = {"dynamic_range_db": 60.0} if name == "a.vol" else {}
            back = self.exported(self.board(self.path(name.split(",")[0]), **keys))
            self.assertLess(abs(back["samples"] - scan["samples"].astype(float)).max(), 0.5 * step + 1e-6, name)
            for key in ("theta_deg", "range_mm", "motor_angle_deg", "radius_mm", "wobble_radius_mm"):
                np.testing.assert_allclose(back[key], scan[key], atol=1e-6, err_msg=name + " " + key)

    def test_axes_types_byte_orders_and_ends(self):
        values = np.random.default_rng(1).integers(-2000, 1500, (5, 7, 16), dtype=np.int16)
        expected = np.maximum(0, (values.astype(float) + 1500) / 3000)
        orders = {("sample", "line", "frame"): values, ("line", "sample", "frame"): values.transpose(0, 2, 1),
                  ("frame", "line", "sample"): values.transpose(2, 1, 0)}
        for axes, array in orders.items():
            for big in (False, True):
                file = self.write("v.raw", b"head" + array.astype(">i2" if big else "<i2").tobytes())
                scan = self.exported(self.board(
                    file, **POLAR, axes=axes, element="int16", big_endian=big, offset_bytes=4,
                    sizes=array.shape[::-1], black=-1500.0, white=1500.0, reversed=["line"]))
                np.testing.assert_allclose(scan["samples"][0], expected[:, ::-1], atol=1e-6)

    def test_several_volumes_angles_and_linear_values(self):
        values = np.random.default_rng(2).uniform(0.001, 1, (6, 4, 5, 9)).astype("<f4")
        angles = [-20.0, -11.0, 3.0, 17.5]
        keys = {**POLAR, "motor_angles_deg": angles, "values": "linear", "white": 1.0}
        del keys["fan_deg"]
        scan = self.exported(self.board(self.write("v.mha", mha(values, element="MET_FLOAT")), **keys), "--volumes", 6)
        np.testing.assert_allclose(scan["samples"], np.maximum(0, 1 + np.log10(values) / 3), atol=1e-5)
        np.testing.assert_allclose(scan["motor_angle_deg"][:, :, 0], [angles] * 6, atol=1e-9)
        # One frame after the other along the last axis of three.
        flat = self.write("f.mha", mha(values.reshape(24, 5, 9), element="MET_FLOAT"))
        again = self.exported(self.board(flat, **keys, frames_per_volume=4), "--volumes", 6)
        np.testing.assert_array_equal(again["samples"], scan["samples"])

    def test_kretz_samples_lie_where_public_readers_put_them(self):
        voxels = np.random.default_rng(3).integers(0, 256, (9, 13, 40), dtype=np.uint8)
        for axis in (-40.0, 60.0):
            scan = self.exported(self.board(self.write("v.vol", kretz(voxels, axis=axis)), dynamic_range_db=60.0))
            np.testing.assert_allclose(scan["samples"][0], voxels / 255, atol=1e-6)
            theta, phi = np.linspace(-0.6, 0.6, 13)[None, :, None], np.linspace(-0.5, 0.5, 9)[:, None, None]
            r, b = (100 + np.arange(40)) * 0.5, -axis * 0.5
            read = np.stack(np.broadcast_arrays(r * np.sin(theta), -(r * np.cos(theta) - b) * np.sin(phi),
                b * (1 - np.cos(phi)) + r * np.cos(theta) * np.cos(phi)), -1)
            ours = positions(scan["theta_deg"], scan["motor_angle_deg"][0], scan["range_mm"],
                             float(scan["radius_mm"]), float(scan["wobble_radius_mm"]))
            np.testing.assert_allclose(ours, read, atol=1e-6)

    def test_rendered_and_never_scored(self):
        voxels = np.full((21, 30, 200), 10, np.uint8)
        voxels[:, :, 120:] = 200
        board = self.board(self.write("v.vol", kretz(voxels)), dynamic_range_db=60.0)
        out = run("run", "--board", board, "--out", self.path("run"), "--json",
                  *settings("render.ray_casting.image_size=64"))
        self.assertIn('"no_truth_because"', out)
        self.assertIn("hardware", out)
        seen = run("inspect", self.path("v.vol"), "--geometry", self.path("geometry.toml"))
        self.assertIn("200 x 30 x 21 of uint8", seen)
        self.assertIn("0 to 255 are 60 dB", seen)
        run("record", "--board", board, "--out", self.path("rec"))
        run("inspect", self.path("rec/recording.wbst"))


class Dialects(Input):
    """One scan in each dialect of NRRD and MetaImage, written by plain Python, has the plain file's samples."""
    VALUES = np.random.default_rng(51).integers(0, 128, (5, 7, 16), dtype=np.uint8)
    NRRD_FIELDS = {"type": "uint8", "dimension": 3, "sizes": "16 7 5", "encoding": "raw"}
    META_FIELDS = {"ObjectType": "Image", "NDims": 3, "BinaryData": "True", "DimSize": "16 7 5", "ElementType": "MET_UCHAR",
                   "ElementDataFile": "LOCAL"}
    SCALE = {**POLAR, "black": 0.0, "white": 255.0}

    def nrrd(self, data, upper=False, **changes):
        fields = {**self.NRRD_FIELDS, **{key.replace("_", " "): value for key, value in changes.items()}}
        head = "".join(f"{key}: {value}\n" for key, value in fields.items())
        return b"NRRD0004\n" + (head.upper() if upper else head).encode() + b"\n" + data

    def meta(self, data, upper=False, **changes):
        fields = {**self.META_FIELDS, **changes}
        fields["ElementDataFile"] = fields.pop("ElementDataFile")
        head = "".join(f"{key} = {value}\n" for key, value in fields.items())
        return (head.upper() if upper else head).encode() + data

    def dialects(self):
        values, raw = self.VALUES, self.VALUES.tobytes()
        text, lines = " ".join(map(str, values.ravel())).encode(), b"\r\n".join(b"%.1f" % v for v in values.ravel())
        zipped, zlibbed = gzip.compress(raw), zlib.compress(raw, 9)
        self.write("beside.raw", raw)
        self.write("beside.zraw", zlibbed)
        self.write("beside.gz", b"two\nlines\n" + zipped)
        placed = {"space_directions": "(1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,1)", "space_origin": "(0,0,0,0)",
                  "dimension": 4, "sizes": "16 7 5 1"}
        yield from {"gzip": self.nrrd(zipped, encoding="gzip"), "GZ": self.nrrd(zipped, encoding="GZ"),
                    "ascii": self.nrrd(text, encoding="ascii"), "text": self.nrrd(lines, encoding="text", type="double"),
                    "upper case": self.nrrd(raw, upper=True), "last bytes": self.nrrd(b"junk" + raw, byte_skip=-1),
                    "bytes": self.nrrd(b"junk" + raw, byteskip=4), "lines": self.nrrd(b"a\nb\n" + raw, line_skip=2),
                    "no skip": self.nrrd(raw, line_skip=0, byte_skip=0), "SimpleITK": self.nrrd(raw, space_dimension=4, **placed),
                    "time": self.nrrd(raw, space="Left-Posterior-Superior-Time", **placed),
                    "beside": self.nrrd(b"", data_file="beside.raw"), "no end": self.nrrd(b"", datafile="./beside.raw")[:-1],
                    "gzip beside": self.nrrd(b"", data_file="beside.gz", line_skip=2, encoding="gzip"),
                    "Local": self.meta(raw, ElementDataFile="Local"), "meta upper case": self.meta(raw, upper=True),
                    "zlib": self.meta(zlibbed, CompressedData="TRUE", CompressedDataSize=len(zlibbed)),
                    "zlib, no size": self.meta(zlibbed, CompressedData="true"), "numbers": self.meta(text, BinaryData="False"),
                    "mhd": self.meta(b"", ElementDataFile="beside.raw"), "mhd, header": self.meta(b"", ElementDataFile="beside.raw", HeaderSize=-1),
                    "mhd, zraw": self.meta(b"", ElementDataFile="beside.zraw", CompressedData="True")}.items()
        for names, kind in {"signed char|int8|int8_t": "i1", "uchar|unsigned char|uint8|uint8_t": "u1", "float": "f4", "double": "f8",
                            "short|short int|signed short|signed short int|int16|int16_t": "i2",
                            "ushort|unsigned short|unsigned short int|uint16|uint16_t": "u2",
                            "int|signed int|int32|int32_t": "i4", "uint|unsigned int|uint32|uint32_t": "u4"}.items():
            for order, name in itertools.product("<>", names.split("|")):
                yield order + name, self.nrrd(values.astype(order + kind).tobytes(), type=name, endian="little" if order == "<" else "Big")
        yield "meta big-endian", self.meta(values.astype(">u2").tobytes(), ElementType="MET_USHORT", BinaryDataByteOrderMSB="True")

    def test_have_the_plain_file_s_samples(self):
        for number, (name, data) in enumerate(self.dialects()):
            # The name's ending says nothing: first bytes do.
            scan = self.exported(self.board(self.write("dialect" + (".nhdr", ".mhd", ".vol", ".bin")[number % 4], data), **self.SCALE))
            np.testing.assert_allclose(scan["samples"][0], self.VALUES / 255, atol=1e-6, err_msg=name)

    def test_are_refused_by_a_line(self):
        raw = self.VALUES.tobytes()
        zipped, zlibbed = gzip.compress(raw), zlib.compress(raw)
        self.write("short.raw", raw[1:])
        self.write("folder.npz", b"PK\x03\x04")
        for says, data in {
                "encoding = hex: must be raw, gzip or ascii": self.nrrd(raw, encoding="hex"), "type = int64": self.nrrd(raw, type="int64"),
                "data file = none.raw: must be one file that is there": self.nrrd(b"", data_file="none.raw"),
                "data file = ../a.raw: must be a file in the header's folder": self.nrrd(b"", data_file="../a.raw"),
                "ElementDataFile = /dev/zero: must be a file in the": self.meta(b"", ElementDataFile="/dev/zero"),
                "short.raw: has 559 bytes": self.meta(b"", ElementDataFile="short.raw"),
                "its voxels cannot be decompressed to 560 bytes": self.nrrd(zipped[:15] + b"\xff\xff" + zipped[17:], encoding="gzip"),
                "voxels cannot be decompressed to 560 bytes": self.nrrd(zipped + b"x", encoding="gzip"),
                "cannot be decompressed to 560 bytes": self.nrrd(zipped[:-9], encoding="gzip"),
                "cannot be decompressed to 1120 bytes": self.nrrd(zipped, encoding="gzip", sizes="16 7 10"),
                "cannot be decompressed to 448 bytes": self.meta(zlibbed, CompressedData="True", DimSize="16 7 4"),
                "voxels cannot be 99000000000 bytes": self.nrrd(zipped, encoding="gzip", sizes="1000000 1000 99"),
                "voxels are 2 numbers; must be 99000000000": self.nrrd(b"1 2", encoding="ascii", sizes="1000000 1000 99"),
                "hold no finite number at index 1": self.meta(b"1 1.#IND 3", BinaryData="False", DimSize="1 1 3"),
                "voxels are 559 numbers; must be 560": self.nrrd(b"7 " * 559, encoding="ascii"), "voxels must not have bytes to skip": self.nrrd(zipped, encoding="gzip", byte_skip=3),
                "has fewer lines than": self.nrrd(b"", line_skip=3), "byte skip = -2: must be a whole number from -1 on": self.nrrd(raw, byte_skip=-2),
                "bytes; the header says 7": self.meta(zlibbed, CompressedData="True", CompressedDataSize=7),
                "CompressedData = maybe: must be True or False": self.meta(raw, CompressedData="maybe")}.items():
            self.refused(self.board(self.write("bad.bin", data), **self.SCALE), says)
        grid = self.nrrd(raw, space_directions="(1,0,0) (0,1,0) (0,0,1)")
        self.refused(self.board(self.write("g.nrrd", grid), layout="cartesian", dynamic_range_db=60.0), "space is missing; must be given as")
        self.refused("file=" + self.path("folder.npz"), "arrays: numpy.load reads those")
        self.refused("file=" + self.write("d", b"\0" * 128 + b"DICM"), "DICOM: pydicom")


class Plus(Input):
    """Fields that PLUS writes: which way the axes go, and which frames are valid."""

    def test_orientation(self):
        values = np.random.default_rng(5).integers(0, 256, (5, 7, 16), dtype=np.uint8)  # frame, line, sample
        expected = values / 255
        for letters, stored in {"FM": values, "FU": values[:, ::-1], "NM": values[:, :, ::-1],
                                "MF": values.transpose(0, 2, 1), "UN": values[:, ::-1, ::-1].transpose(0, 2, 1)}.items():
            field = f"UltrasoundImageOrientation = {letters}\n"
            file = self.write("o.mha", mha(np.ascontiguousarray(stored), more=field))
            np.testing.assert_allclose(self.exported(self.board(file, **POLAR))["samples"][0], expected, atol=1e-6)
        for keys in ({"reversed": ["sample"]}, {"axes": ["sample", "line", "frame"]}):
            said = run("run", "--board", self.board(file, **POLAR, **keys), "--out", self.path("no"), code=2)
            self.assertIn("is not what the file says", said)
            self.assertIn("UltrasoundImageOrientation = UN", said)
        wrong = self.write("w.mha", mha(values, more="UltrasoundImageOrientation = QF\n"))
        self.assertIn("must be F or N and M or U", run("run", "--board", self.board(wrong, **POLAR), code=2))

    def test_invalid_frames_are_lost_sticks(self):
        values = np.full((10, 7, 16), 100, np.uint8)
        status = "".join(f"Seq_Frame{i:04d}_ImageStatus = {'INVALID' if i in (2, 8) else 'OK'}\n" for i in range(10))
        file = self.write("i.mha", mha(values, more=status))
        for keys, expected in (({}, [[2], [3]]), ({"reversed": ["frame"]}, [[2], [1]])):
            scan = self.exported(self.board(file, **POLAR, **keys, frames_per_volume=5), "--volumes", 2)
            there = scan["arrived"].astype(bool)
            lost = [sorted(set(np.nonzero(~volume)[0])) for volume in there]
            self.assertEqual(lost, expected)
            self.assertFalse(scan["samples"][~there].any())

    def test_values_above_white_are_clamped(self):
        values = np.random.default_rng(6).uniform(0, 1, (40, 30, 50)).astype("<f4")
        values[3, 4, 5], values[20, 6, 7] = 20, -3
        file = self.write("b.mha", mha(values, element="MET_FLOAT"))
        board = self.board(file, **POLAR, white=1.0, black=0.0)
        said = run("export", board, "--replace", "--to", self.path("back.npz") + ",content=polar")
        self.assertIn("1 out of range and clamped", said)
        np.testing.assert_allclose(np.load(self.path("back.npz"))["samples"][0], np.clip(values, 0, 1), atol=1e-6)


class Resampled(Input):
    """Pictures and grids: a field that is linear in position survives linear interpolation."""

    def test_planes(self):
        a, step, center = 30.0, 0.4, (130.25, -60.5)
        row, column = np.indices((240, 260))
        planes = np.stack([np.uint16(20000 + 60 * column + 90 * row + 1000 * f) for f in range(4)])
        keys = {**POLAR, "layout": "planes", "white": 65535.0, "black": 0.0, "spacing_mm": [step, step],
                "center_px": list(center), "lines": 50, "samples": 120}
        scan = self.exported(self.board(self.write("p.mha", mha(planes, element="MET_USHORT")), **keys))
        theta = np.radians(scan["theta_deg"])[:, None]
        r = a + scan["range_mm"]
        at_column, at_row = center[0] + r * np.sin(theta) / step, center[1] + r * np.cos(theta) / step
        inside = (at_column > 0) & (at_column < 259) & (at_row > 0) & (at_row < 239)
        self.assertGreater(inside.mean(), 0.9)
        for f in range(4):
            expected = (20000 + 60 * at_column + 90 * at_row + 1000 * f) / 65535
            np.testing.assert_allclose(scan["samples"][0][f][inside], expected[inside], atol=1e-5)

    def test_own_planes_and_grids_come_back_as_their_sticks(self):
        """Inside a ball away from all axes. A pixel or voxel rounds the step at its surface: where slopes differ by
        the step over a distance of samples, by a quarter of it times the pixel's diagonal over that distance."""
        run("export", "sim", *BALL_SCENE, *SMOOTH, "--to", self.path("s.npz") + ",content=polar",
            "--to", self.path("s.mha") + ",spacing_mm=0.2,type=uint16",
            "--to", self.path("s.nrrd") + ",spacing_mm=0.5,type=uint16")
        scan = np.load(self.path("s.npz"))
        samples, ball = scan["samples"][0], off_ball(scan) < 0
        self.assertGreater(ball.sum(), 1500)
        self.assertGreater(samples[ball].min(), 0.5)
        self.assertGreater(np.ptp(samples[ball]), 0.1)
        # Distances where the ball lies, in mm: of samples, lines and frames.
        apart_mm = np.array([0.83, 3.1, 3.9])
        for name, diagonal_mm, apart in (("s.mha", 0.2 * 2 ** 0.5, apart_mm[:2]), ("s.nrrd", 0.5 * 3 ** 0.5, apart_mm)):
            back = self.exported(self.board(self.path(name)))
            for key in ("theta_deg", "range_mm", "motor_angle_deg"):
                np.testing.assert_allclose(back[key], scan[key], atol=1e-6)
            most = samples.max() / 4 * (diagonal_mm / apart).sum()
            self.assertLess(abs(back["samples"][0] - samples)[ball].max(), most, name)

    def test_grid_in_the_probe_frame(self):
        z, y, x = np.indices((90, 60, 80)).astype(float)
        turn = np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]) * 1.5  # rows: axes of the grid
        origin = np.array([-20.0, -70.0, 20.0])
        at = x[..., None] * turn[0] + y[..., None] * turn[1] + z[..., None] * turn[2] + origin
        values = np.float32(0.4 + at @ np.array([2e-3, -1e-3, 1e-3]))
        text = " ".join("(" + ",".join(map(str, axis)) + ")" for axis in turn)
        keys = {**POLAR, "layout": "cartesian", "black": 0.0, "white": 1.0}
        for space, flips in (("left-posterior-superior", (1, 1)), ("right-anterior-superior", (-1, -1)),
                             ("left-anterior-superior", (1, -1)), ("LAS", (1, -1))):
            ras = np.array([*flips, 1])
            text = " ".join("(" + ",".join(map(str, axis * ras)) + ")" for axis in turn)
            file = self.write("g.nrrd", nrrd(values, "float", text, space, "(%g,%g,%g)" % tuple(origin * ras)))
            scan = self.exported(self.board(file, **keys))
            where = positions(scan["theta_deg"], scan["motor_angle_deg"][0], scan["range_mm"], 30.0, 55.0)
            index = (where - origin) @ np.linalg.inv(turn)
            inside = ((index > 0) & (index < np.array([79, 59, 89]))).all(-1)
            self.assertGreater(inside.sum(), 1e4)
            expected = 0.4 + where @ np.array([2e-3, -1e-3, 1e-3])
            np.testing.assert_allclose(scan["samples"][0][inside], expected[inside], atol=1e-5)
            self.assertEqual(scan["samples"][0][~((index > -0.6).all(-1))].max(), 0)

    def test_grid_without_a_probe_shows_its_ball(self):
        z, y, x = np.indices((100, 90, 110)) * 0.8
        ball, radius = np.array([52.0, 30.0, 42.0]), 20.0
        off = np.sqrt((x - ball[0]) ** 2 + (y - ball[1]) ** 2 + (z - ball[2]) ** 2) - radius
        values = np.uint8(np.clip(110 - 60 * off, 20, 200))
        file = self.write("ball.mha", mha(values, "0.8 0.8 0.8"))
        run("export", self.board(file, layout="cartesian", dynamic_range_db=60.0), "--replace",
            "--to", self.path("ball.ply"), "--to", self.path("ball.npz"), *settings("render.ray_casting.image_size=256", "render.ray_casting.incidence_correction_mm=0", "render.ray_casting.iso_level=0.72"))
        scan = np.load(self.path("ball.npz"))
        depth = scan["found_depth_mm"]
        points = (scan["ray_origin_mm"] + depth[..., None] * scan["ray_direction"])[~np.isnan(depth)]
        # The middle of the grid's near side lies on the face, 200 mm from the centre of curvature.
        side = np.array([110, 90, 100]) * 0.8
        center = ball + 0.4 - np.array([side[0] / 2, side[1] / 2, -200])
        near = np.linalg.norm((points - center)[:, :2], axis=1) < 0.7 * radius
        self.assertGreater(near.sum(), 2000)
        self.assertLess(np.percentile(abs(np.linalg.norm(points[near] - center, axis=1) - radius), 95), 1.0)


class RealProbe(Input):
    def test_scan_conversion_is_the_published_one(self):
        step = 72 / 3640
        radius = 10 + (1000 - 0.5) * step
        sector = 23 * 150 / 95
        board = self.board(os.path.join(REAL, "lines.mha"), layout="polar", radius_mm=radius, sector_deg=sector,
                           depth_mm=800 * step, dynamic_range_db=60.0)
        # Of this grid all published pixels are points.
        run("export", board, "--to", self.path("p.mha") + ",spacing_mm=0.025")
        ours, published = (self.read(file) for file in (self.path("p.mha"), os.path.join(REAL, "scan_converted.mha")))
        with open(self.path("p.mha"), "rb") as file:
            center = np.array(re.search(rb"center_px = (.*)", file.read(4000))[1].split(), float)
        row, column = np.indices(published.shape)
        x, depth = (column + 314 - 409.5) * 0.15, (row + 208 - 87) * 0.15 + 10
        theta, r = np.degrees(np.arctan2(x, depth)), np.hypot(x, depth)
        inside = (abs(theta) < sector / 2 - 0.01) & (r > 10 + 1000.01 * step) & (r < 10 + 1798.99 * step)
        at = np.rint(np.stack([x / 0.025 + center[0], depth / 0.025 + center[1]])).astype(int)[:, inside]
        wrong = ours[at[1], at[0]].astype(int) - published[inside]
        self.assertGreater(inside.sum(), 9000)
        # Both round half grey levels up, of sums in another precision.
        self.assertLessEqual(abs(wrong).max(), 1)
        self.assertLess((wrong != 0).mean(), 0.001)

    def read(self, file):
        with open(file, "rb") as whole:
            header, data = whole.read().split(b"ElementDataFile = LOCAL\n", 1)
        size = re.search(rb"DimSize = (\d+) (\d+) 1", header)
        return np.frombuffer(data, np.uint8).reshape(int(size[2]), int(size[1]))


class Zea(Input):
    """HDF5 files as zea (tue-bmd/zea, zea/data/spec.py) has them, written by h5py."""

    def zea(self, values, coordinates=None, name="image", group="tracks/track_0/data", file="z.hdf5"):
        with h5py.File(self.path(file), "w") as out:
            out[f"{group}/{name}/values"] = values
            if coordinates is not None:
                out[f"{group}/{name}/coordinates"] = coordinates.astype(np.float32)
        return self.path(file)

    def sticks(self):
        """Positions (z, x, y, 3) of the samples of POLAR, in m, from the face's apex."""
        theta, phi = np.linspace(-33, 33, 6), np.linspace(-22, 22, 4)
        r = (np.arange(9) + 0.5) * 10
        at = positions(theta, np.repeat(phi[:, None], 6, 1), r, 30.0, 55.0) - [0, 0, 30.0]
        return at.transpose(2, 1, 0, 3) / 1000

    def test_decibels_greys_and_envelopes(self):
        db = np.random.default_rng(5).uniform(-70, 0, (2, 9, 6, 4)).astype(np.float32)
        db[0, 3, 2, 1] = -np.inf
        expected = np.maximum(0, 1 + db / 60).transpose(0, 3, 2, 1)
        scan = self.exported(self.board(self.zea(db, self.sticks()), **POLAR), "--volumes", 2)
        np.testing.assert_allclose(scan["samples"], expected, atol=1e-5)
        linear = self.zea(10 ** (db / 20) * 7, name="envelope_data", group="data")
        scan = self.exported(self.board(linear, **POLAR, white=7.0), "--volumes", 2)
        np.testing.assert_allclose(scan["samples"], expected, atol=1e-5)
        grey = np.random.default_rng(6).integers(0, 256, (1, 9, 6, 4), dtype=np.uint8)
        with h5py.File(self.path("old.h5"), "w") as out:
            out.create_dataset("data/image", data=grey, compression="gzip")
        scan = self.exported(self.board(self.path("old.h5"), **POLAR))
        np.testing.assert_allclose(scan["samples"][0], grey[0].transpose(2, 1, 0) / 255, atol=1e-6)

    def test_grid_lies_where_its_coordinates_put_it(self):
        z, x, y = np.meshgrid(np.arange(20, 140) * 1e-3, np.arange(-70, 70) * 1e-3, np.arange(-40, 45, 1.5) * 1e-3,
                              indexing="ij")
        at = np.stack([x, y, z], -1)
        ball = np.linalg.norm(at - np.array([14, -9, 90]) / 1000, axis=-1) < 0.018
        db = np.where(ball, 0, -80).astype(np.float32)[None]
        keys = {"layout": "cartesian", "radius_mm": 40.0, "wobble_radius_mm": 27.0, "sector_deg": 70.0, "fan_deg": 50.0,
                "depth_mm": 120.0, "dynamic_range_db": 60.0}
        scan = self.exported(self.board(self.zea(db, at), **keys))
        place = positions(scan["theta_deg"], scan["motor_angle_deg"][0], scan["range_mm"], 40.0, 27.0)
        found, true = scan["samples"][0] > 0.5, np.linalg.norm(place - [14, -9, 90], axis=-1) < 18
        self.assertGreater(true.sum(), 3000)
        self.assertLess((found != true).sum() / true.sum(), 0.12)
        np.testing.assert_allclose(place[found].mean(0), place[true].mean(0), atol=0.3)

    def test_planes(self):
        frames = np.random.default_rng(7).integers(0, 256, (4, 50, 60), dtype=np.uint8)
        keys = {"layout": "planes", "spacing_mm": [1.0, 1.0], "center_px": [29.5, -20.0], "radius_mm": 25.0,
                "wobble_radius_mm": 20.0, "sector_deg": 40.0, "fan_deg": 30.0, "depth_mm": 40.0, "dynamic_range_db": 60.0,
                "lines": 12, "samples": 40}
        scan = self.exported(self.board(self.zea(frames), **keys))
        again = self.exported(self.board(self.write("p.mha", mha(frames)), **keys))
        np.testing.assert_array_equal(scan["samples"], again["samples"])

    def test_refusals(self):
        db = np.full((1, 9, 6, 4), -30, np.float32)
        at = self.sticks()
        refused = self.refused
        refused("file=" + self.zea(db), "must be given with geometry=FILE.toml")
        turned = {**POLAR, "sector_deg": 50.0}
        refused(self.board(self.zea(db, at), **turned), "its coordinates lie up to", "must be within 10 mm")
        refused(self.board(self.zea(db, at), **{**POLAR, "reversed": ["frame"]}), "its coordinates lie up to")
        refused(self.board(self.zea(db, at), layout="cartesian", dynamic_range_db=60.0), "grid of equal steps")
        refused(self.board(self.zea(db, at[:-1]), **POLAR), "not those of its values")
        refused(self.board(self.zea(db[0, 0]), **POLAR), "has values of 2 axes")
        refused(self.board(self.zea(db * np.nan), **POLAR), "voxel 0 is no finite number")
        refused(self.board(self.zea(db.astype(complex)), **POLAR), "must hold numbers")
        refused(self.board(self.zea(db, name="beamformed_data"), **POLAR), "holds neither data/image nor")
        with h5py.File(self.path("lzf.h5"), "w") as out:
            out.create_dataset("data/image", data=db, compression="lzf")
        with h5py.File(self.path("huge.h5"), "w") as out:
            out.create_dataset("data/image", (1, 1000, 1000, 900), "f4", chunks=True)
        refused(self.board(self.path("huge.h5"), **POLAR), "claims 900000000 numbers, of which it stores 0 bytes")
        refused(self.board(self.path("lzf.h5"), **POLAR), "is stored by filter 32000 (lzf), which is not read; gzip is")
        refused(self.board(self.write("n.hdf5", b"no HDF5"), **POLAR), "it cannot be opened as one")
        two = self.zea(db)
        with h5py.File(two, "a") as out:
            out["tracks/track_1/data/image/values"] = db
        refused(self.board(two, **POLAR), "holds several tracks")
        with open(self.zea(db, at), "rb") as whole:
            data = whole.read()
        # Read by a program beside ours that says sizes whose product wraps to that of its values: to 0.
        wraps = struct.pack("=IQ4sQI5Q2I", 0x54524557, 4, b"data", 0, 0, 3, 2**33, 2**31, 1, 0, 0, 0x444e4557)
        reader = self.write("wobblebench-import", f"#!/bin/sh\ncat {self.write('message', wraps)} >&3\n")
        os.chmod(reader, 0o755)
        done = subprocess.run([shutil.copy(PROGRAM, self.folder), "inspect", self.zea(db, at), "--geometry",
                               self.write("g.toml", geometry_text(**POLAR))], capture_output=True, text=True, check=False, timeout=60)
        self.assertIn("z.hdf5: is damaged: its sizes differ\n", done.stderr)
        for size in (100, 2000, len(data) - 300):
            line = run("run", "--board", self.board(self.write("cut.hdf5", data[:size]), **POLAR), "--out",
                       self.path("out"), code=2)
            self.assertEqual(line.count("\n"), 1, line)


if __name__ == "__main__":
    unittest.main()
