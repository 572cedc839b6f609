#!/usr/bin/env python3
"""Bad scans in files of other programs: each is refused by one line, and nothing is written."""
import os
import random
import struct
import unittest

import h5py
import numpy as np

from scans import Input, POLAR, fields_of_planes, geometry_text, kretz, mha, nrrd
from support import attempt


class Bad(Input):
    def test_meta_image(self):
        good = mha(np.zeros((3, 4, 8), np.uint8))
        cases = {"has 5": good[:-3] + b"", "is no MetaImage": good[:60], "must be MET_UCHAR": good.replace(b"UCHAR", b"OTHER"),
                 "voxels cannot be decompressed": good.replace(b"CompressedData = False", b"CompressedData = True"),
                 "must be one file that is there": good.replace(b"LOCAL", b"a.raw"), "at most 10^11": good.replace(b"= 8 4 3", b"= 999999 999999 999999"),
                 "must be 1 to 4 whole numbers": good.replace(b"= 8 4 3", b"= 8 0 3"), "DimSize has": good.replace(b"NDims = 3", b"NDims = 2"),
                 "need": good.replace(b"UCHAR", b"USHORT")}
        for says, data in cases.items():
            self.refused(self.board(self.write("b.mha", data), **POLAR), "" if says == "has 5" else says)
        nan = np.full((3, 4, 8), 0.5, np.float32)
        nan[1, 2, 3] = np.nan
        self.refused(self.board(self.write("n.mha", mha(nan, element="MET_FLOAT")), **POLAR, black=0.0, white=1.0),
                     "voxel 51 is no finite number")
        self.refused("file=" + self.write("p.mha", mha(np.zeros((2, 32, 32), np.uint8), more=fields_of_planes(" = "))),
                     "has no spacing: ElementSpacing is missing; must be given as geometry.spacing_mm")
        flat = self.board(self.write("p.mha", mha(np.zeros((32, 32), np.uint8), "1 1")), layout="cartesian", dynamic_range_db=60.0)
        self.refused(flat, "axis 2 has no direction in space")

    def test_nrrd(self):
        grid = np.zeros((5, 6, 7), np.uint8)
        keys = {"layout": "cartesian", "dynamic_range_db": 60.0}
        cases = {"is no NRRD": b"NRRX" + nrrd(grid, "uint8")[4:], "voxels cannot be decompressed": nrrd(grid, "uint8").replace(b"raw", b"gzip"),
                 "need": nrrd(grid, "uint16"), "must be \"mm\"": nrrd(grid, "uint8", more='space units: "m" "m" "m"\n'),
                 "has no spacing": nrrd(grid, "uint8", None), "in one plane": nrrd(grid, "uint8", "(1,0,0) (1,0,0) (0,0,1)"),
                 "one an axis": nrrd(grid, "uint8", "(1,0,0) (0,1,0)"), "space = scanner-xyz": nrrd(grid, "uint8", space="scanner-xyz"),
                 "must be 3 numbers": nrrd(grid, "uint8", "(1,0) (0,1,0) (0,0,1)"), "has no end": nrrd(grid, "uint8")[:50],
                 "spacings = 1 2: must be 3 numbers": nrrd(grid, "uint8", None, more="spacings: 1 2\n"),
                 "endian = middle": nrrd(np.zeros((5, 6, 7), np.uint16), "uint16", endian="middle")}
        for says, data in cases.items():
            self.refused(self.board(self.write("b.nrrd", data), **keys), says)
        planes = nrrd(np.zeros((2, 32, 32), np.uint8), "uint8", "none none none", more=fields_of_planes(":="))
        self.refused("file=" + self.write("p.nrrd", planes), "axis 0 has no direction in space")

    def test_raw_and_geometry(self):
        file = self.write("b.raw", bytes(3 * 4 * 8))
        raw = {**POLAR, "element": "uint8", "sizes": [8, 4, 3]}
        self.refused("file=" + file, "raw voxels need a geometry file")
        cases = [({"depth_mm": None}, "geometry.depth_mm: is missing"), ({"layout": None}, "geometry.layout: is missing"),
                 ({"element": None}, "geometry.element: is missing"), ({"sizes": [8, 4, 4]}, "has 96 bytes"),
                 ({"element": "uint16"}, "geometry.big_endian: is missing"), ({"dynamic_range_db": None, "values": "linear"}, "is missing; must say how many dB"),
                 ({"dynamic_range_db": None, "full_scale_db": -15.0}, "is missing; must say how many dB"),
                 ({"full_scale_db": -15.0, "tgc_db_per_cm_mhz": 0.2}, "geometry.center_frequency_mhz: is missing"),
                 ({"radius_mm": 3000.0}, "must be within 1 and 200"), ({"radius": 3.0}, "no such key; did you mean radius_mm"),
                 ({"sizes": [8, 4, 3.5]}, "whole numbers"), ({"axes": ["line", "line", "frame"]}, "must name its 3 axes"),
                 ({"motor_angles_deg": [1.0]}, "must not be given with fan_deg"), ({"fan_deg": None, "motor_angles_deg": [1.0]}, "must have 3"),
                 ({"center_px": [1.0, 2.0]}, "acts with layout"), ({"black": 300.0}, "must be more than black"),
                 ({"reversed": ["depth"]}, "must be of sample, line, frame"), ({"frames_per_volume": 2}, "must divide 3")]
        for change, says in cases:
            keys = {key: value for key, value in {**raw, **change}.items() if value is not None}
            self.refused(self.board(file, **keys), says)
        planes = {**raw, "layout": "planes", "sizes": [8, 4, 3], "spacing_mm": [0.1, 0.1], "center_px": [4.0, -300.0]}
        self.refused(self.board(file, **planes), "% of the sector lies outside the picture")
        self.refused(self.board(file, **raw) + ",start_volume=1", "start_volume = 1")
        self.refused(self.board(file, **raw)[:-5] + ".tml", "no such file")
        self.refused("file=" + self.path("none.nrrd"), "none.nrrd")

    def test_kretz(self):
        voxels = np.zeros((4, 5, 6), np.uint8)
        good = kretz(voxels)
        cases = {"is no KRETZFILE": b"X" + good[1:], "compression": kretz(voxels, tag=0xD600), "ends before its last voxel": good[:-1],
                 "the distance of samples is out of range": kretz(voxels, resolution_m=-1.0),
                 "radius_mm": kretz(voxels, first=1e5), "does not say the number of lines": good.replace(struct.pack("<HHI", 0xC000, 2, 2), struct.pack("<HHI", 0xC0F0, 2, 2))}
        for says, data in cases.items():
            self.refused(self.board(self.write("b.vol", data), dynamic_range_db=60.0), says)
        self.refused(self.board(self.write("b.vol", good), dynamic_range_db=60.0, radius_mm=40.0), "says it itself")

    def zea_bytes(self, grid):
        with h5py.File(self.path("whole.hdf5"), "w") as out:
            out["data/image/values"] = grid.transpose(2, 1, 0)[None]
        with open(self.path("whole.hdf5"), "rb") as whole:
            return whole.read()

    def test_damaged_files_crash_nothing(self):
        """Bytes that were changed and files that were cut: read, or refused with one line."""
        rng = random.Random(20261126)
        grid = np.random.default_rng(1).integers(0, 256, (3, 4, 9), dtype=np.uint8)
        files = {"z.mha": (mha(grid, "1 1 1"), POLAR), "z.nrrd": (nrrd(grid, "uint8"), {"layout": "cartesian", "dynamic_range_db": 60.0}),
                 "z.vol": (kretz(grid), {"dynamic_range_db": 60.0}), "z.hdf5": (self.zea_bytes(grid), POLAR),
                 "z.toml": (geometry_text(**POLAR, element="uint8", sizes=[9, 4, 3]).encode(), None)}
        for name, (data, keys) in files.items():
            for turn in range(int(os.environ.get("WOBBLEBENCH_DAMAGED", "20"))):
                damaged = bytearray(data)
                header = max(1, len(data) - grid.size)
                for _ in range(rng.choice([0, 1, 1, 2, 5])):
                    damaged[rng.randrange(header)] = rng.randrange(256)
                if rng.random() < 0.3:
                    del damaged[rng.randrange(len(damaged)):]
                file = self.write(name, bytes(damaged))
                arguments = [file]
                if keys is not None:
                    arguments += ["--geometry", self.write("g.toml", geometry_text(**keys))]
                else:
                    arguments = [self.write("z.raw", grid.tobytes()), "--geometry", file]
                done = attempt("inspect", *arguments, most=self.most())
                self.assertIn(done.returncode, (0, 1, 2), (name, turn, bytes(damaged)))
                if done.returncode != 0:
                    self.assertEqual(done.stderr.count("\n"), 1, (name, turn, done.stderr))
                    self.assertEqual(done.returncode, 2, (name, turn, done.stderr))


if __name__ == "__main__":
    unittest.main()
