#!/usr/bin/python3
"""figures_of_files.py PROGRAM FOLDER: the figures of report.json, and the pixel of a known point,
from the files of `run` by numpy and OpenImageIO, without any code of the program."""
import json
import os
import subprocess
import sys
import tempfile

import numpy
import OpenImageIO as oiio

CACHE = tempfile.TemporaryDirectory()  # not the user's
os.environ["XDG_CACHE_HOME"] = CACHE.name
RADIUS_MM, CENTER_MM = 20.0, numpy.array([7.0, -5.0, 108.0])
SMALL = ["render.ray_casting.image_size=128", "acquisition.frames_per_volume=21"]
BALL = ["phantom.name=sphere", "placement.position_mm=[7, -5, 108]"]
ASKEW = ["render.view.yaw_deg=25", "render.view.pitch_deg=-15", "render.view.roll_deg=10"]
SCENES = {"face": [], "other seed": ["simulation.seed=7", "render.view.flip=true"],
    "low threshold": BALL + ["acquisition.fan_deg=14", "render.view.pitch_deg=50", "render.ray_casting.iso_level=0.4"],
    "askew": BALL + ASKEW, "perspective": BALL + ASKEW + ["render.view.projection=perspective"]}


def channels(path):
    file = oiio.ImageInput.open(path)
    values = file.read_image(0, 0, 0, file.spec().nchannels, "float")
    return {name: values[:, :, i] for i, name in enumerate(file.spec().channelnames)}, file.spec()


def check_figures(found, truth, error):
    reason, has = truth["truth_reason"], ~numpy.isnan(found["Z"])
    seen = reason == 1
    p95 = numpy.percentile(abs(found["Z"] - truth["Z"])[seen & has], 95)
    missed_percent = 100 * numpy.mean(seen & ~has)
    false_percent = 100 * numpy.mean((reason == 0) & has)
    assert abs(p95 - error["p95_mm"]) < 2e-5, (p95, error["p95_mm"])  # float32 of 100 mm
    assert abs(missed_percent - error["missed_percent"]) < 1e-9, (missed_percent, error)
    assert abs(false_percent - error["false_percent"]) < 1e-9, (false_percent, error)
    return p95, missed_percent, false_percent


def check_point(truth, spec, camera):
    """A point of the ball's near side lies at the pixel, and at the depth, where the truth is."""
    size = spec.width
    to_camera = numpy.array(camera["world_to_camera"])
    to_ndc = numpy.array(camera["world_to_ndc"])
    for name, matrix in (("worldToCamera", to_camera), ("worldToNDC", to_ndc)):
        in_file = numpy.array(spec.getattribute(name)).reshape(4, 4)
        assert numpy.allclose(in_file, matrix, rtol=1e-6, atol=1e-5), name
    for offset in ([0.3, 0.2], [-0.4, 0.1], [0.0, -0.5]):  # across the line of sight
        right, down, forward = to_camera[:3, 0], to_camera[:3, 1], to_camera[:3, 2]
        back = -numpy.sqrt(1 - numpy.dot(offset, offset))
        point = CENTER_MM + RADIUS_MM * (offset[0] * right + offset[1] * down + back * forward)
        x, y, _, w = numpy.append(point, 1) @ to_ndc
        column, row = ((x / w + 1) * size - 1) / 2, ((1 - y / w) * size - 1) / 2
        in_camera = (numpy.append(point, 1) @ to_camera)[:3]
        is_parallel = camera["projection"] == "parallel"
        depth = in_camera[2] if is_parallel else numpy.linalg.norm(in_camera)
        # Between the four pixels around it.
        c, r = int(column), int(row)
        across, along = column - c, row - r
        near = truth["Z_crossing"][r:r + 2, c:c + 2]
        z = [1 - along, along] @ near @ [1 - across, across]
        assert abs(z - depth) < 0.05, (offset, column, row, z, depth)


def check(program, folder, name, settings):
    out = folder + "/" + name.replace(" ", "_")
    words = [w for s in SMALL + settings for w in ("--set", s)]
    subprocess.run([program, "run", "--out", out] + words, check=True, capture_output=True)
    report = json.load(open(out + "/report.json"))
    found, _ = channels(out + "/depth.exr")
    truth, spec = channels(out + "/truth_depth.exr")
    figures = check_figures(found, truth, report["error"])
    if "phantom.name=sphere" in settings:
        check_point(truth, spec, report["camera"])
    print(name, "P95 %.4f mm, missed %.4f %%, false %.4f %%" % figures)


for scene, keys in SCENES.items():
    check(sys.argv[1], sys.argv[2], scene, keys)
