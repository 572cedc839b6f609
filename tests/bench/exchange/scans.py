"""Scans in the formats of other programs, written without ours, and a case that hands them to --board file=."""
import os
import struct

import numpy as np

from support import InFolder, run, twice


def geometry_text(**keys):
    def value(v):
        if isinstance(v, bool):
            return str(v).lower()
        if isinstance(v, (list, tuple)):
            return "[" + ", ".join(value(one) for one in v) + "]"
        return f'"{v}"' if isinstance(v, str) else repr(v)
    return "[geometry]\n" + "".join(f"{key} = {value(v)}\n" for key, v in keys.items())


def mha(array, spacing=None, element="MET_UCHAR", more=""):
    size = " ".join(map(str, array.shape[::-1]))
    step = f"ElementSpacing = {spacing}\n" if spacing else ""
    return (f"ObjectType = Image\nNDims = {array.ndim}\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
            f"CompressedData = False\nDimSize = {size}\n{step}ElementType = {element}\n{more}"
            "ElementDataFile = LOCAL\n").encode() + array.tobytes()


def nrrd(array, type_name, directions="(0.5,0,0) (0,0.5,0) (0,0,0.5)", space="left-posterior-superior",
         origin="(0,0,0)", more="", endian="little"):
    size = " ".join(map(str, array.shape[::-1]))
    placed = f"space: {space}\nspace directions: {directions}\nspace origin: {origin}\n" if directions else ""
    return (f"NRRD0004\ntype: {type_name}\ndimension: {array.ndim}\nsizes: {size}\n{placed}endian: {endian}\n"
            f"encoding: raw\n{more}\n").encode() + array.tobytes()


def fields_of_planes(equals):
    """What `export` writes of planes besides their sizes and spacing."""
    fields = {"content": "planes", "radius_mm": 40, "wobble_radius_mm": 27, "sector_deg": 77, "fan_deg": 61,
              "depth_mm": 160, "dynamic_range_db": 60, "center_px": "16 -4"}
    return "".join(f"wobblebench_{key}{equals}{value}\n" for key, value in fields.items())


def kretz(voxels, resolution_m=0.0005, first=100.0, axis=60.0, sector=1.2, fan=1.0, tag=0xD000):
    """As SlicerHeart's reader decodes it: axis > 0 lies behind the centre of curvature."""
    frames, lines, samples = voxels.shape

    def item(group, element, data):
        return struct.pack("<HHI", group, element, len(data)) + data
    middle = np.pi / 2
    return (b"KRETZFILE 1.0   " + item(0x0010, 0x0002, b"somebody") +
            item(0xC000, 1, struct.pack("<H", samples)) + item(0xC000, 2, struct.pack("<H", lines)) +
            item(0xC000, 3, struct.pack("<H", frames)) + item(0xC100, 1, struct.pack("<d", resolution_m)) +
            item(0xC200, 1, struct.pack("<d", first)) + item(0xC200, 2, struct.pack("<d", axis)) +
            item(0xC300, 1, (middle + np.linspace(-fan / 2, fan / 2, frames)).tobytes()) +
            item(0xC300, 2, (middle + np.linspace(-sector / 2, sector / 2, lines)).tobytes()) +
            item(tag, 1, voxels.tobytes()))


class Input(InFolder):
    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data if isinstance(data, bytes) else data.encode())
        return self.path(name)

    def board(self, file, **keys):
        text = "file=" + file
        return text + ",geometry=" + self.write("geometry.toml", geometry_text(**keys)) if keys else text

    def exported(self, board, *more):
        run("export", board, "--replace", "--to", self.path("back.npz") + ",content=polar", *more)
        scan = np.load(self.path("back.npz"))
        self.assertEqual(scan["source"].tolist(), ["recording of hardware"])
        return scan

    def most(self):
        good = geometry_text(**POLAR, element="uint8", sizes=[9, 4, 3])
        return twice("inspect", self.write("good.raw", bytes(108)), "--geometry", self.write("good.toml", good))

    def refused(self, board, *says):
        """One line, exit code 2, nothing written, in twice the memory in which a good scan is read."""
        line = run("run", "--board", board, "--out", self.path("out"), code=2, most=self.most())
        self.assertEqual(line.count("\n"), 1, line)
        for text in says:
            self.assertIn(text, line)
        self.assertFalse(os.path.exists(self.path("out")))


POLAR = {"layout": "polar", "radius_mm": 30.0, "wobble_radius_mm": 55.0, "sector_deg": 66.0, "fan_deg": 44.0,
         "depth_mm": 90.0, "dynamic_range_db": 60.0}
