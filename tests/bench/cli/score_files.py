#!/usr/bin/python3
"""score_files.py PROGRAM FOLDER: `score` on files that NumPy, OpenImageIO and VTK wrote."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile

import numpy as np
import OpenImageIO as oiio
import vtk

PROGRAM, FOLDER = sys.argv[1], sys.argv[2]
CACHE = tempfile.TemporaryDirectory()  # not the user's
os.environ["XDG_CACHE_HOME"] = CACHE.name
RADIUS_MM, CENTER_MM = 20.0, np.array([7.0, -5.0, 108.0])
SCENE = ["phantom.name=sphere", "placement.position_mm=[7, -5, 108]", "acquisition.frames_per_volume=21",
         "render.ray_casting.image_size=96", "simulation.fidelity=geometry",
         "render.ray_casting.incidence_correction_mm=0"]
ASKEW = ["render.view.yaw_deg=20", "render.view.pitch_deg=10"]


def path(name):
    return os.path.join(FOLDER, name)


def command(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True)


def settings(keys):
    return [word for key in keys for word in ("--set", key)]


def score(file, *more, run="parallel"):
    """Figures of report.json; the command must have succeeded."""
    done = command("score", path(file), "--scene", path(run + "/report.json"), "--out", path("scored"), *more)
    assert done.returncode == 0, (file, more, done.stderr)
    return json.load(open(path("scored/report.json")))


def refused(file, *more, says, run="parallel"):
    done = command("score", path(file), "--scene", path(run + "/report.json"), "--out", path("refused"), *more)
    lines = [line for line in done.stderr.splitlines() if line.startswith("wobblebench: ") and "warning" not in line]
    assert done.returncode == 2 and len(lines) == 1 and says in lines[0], (file, done.returncode, done.stderr)
    assert not os.path.exists(path("refused")), file


def channel(file, name):
    image = oiio.ImageInput.open(path(file))
    return image.read_image("float")[:, :, list(image.spec().channelnames).index(name)]


def write_picture(file, values, names=("Z",), kind="float", window={}, **attributes):
    values = np.dstack([values]) if values.ndim == 2 else values
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], values.shape[2], kind)
    spec.channelnames = names
    for key, value in window.items():
        setattr(spec, key, int(value))
    for key, value in attributes.items():
        spec.attribute(key, value)
    image = oiio.ImageOutput.create(path(file))
    assert image.open(path(file), spec) and image.write_image(np.ascontiguousarray(values)) and image.close()


def same(a, b, allowed=2e-5):
    a, b = a["error"], b["error"]
    for key in ("bias_mm", "rms_mm", "median_mm", "p95_mm", "max_mm"):
        assert abs(a[key] - b[key]) < allowed, (key, a[key], b[key])
    for key in ("missed_percent", "false_percent"):
        assert abs(a[key] - b[key]) < 1e-9, (key, a[key], b[key])
    assert a["pixels"] == b["pixels"]
    assert abs(a["ssim"] - b["ssim"]) < 1e-3
    assert abs(a["distance_p95_mm"] - b["distance_p95_mm"]) < max(1e-4, allowed)
    # A file does not say which pixels were drawn beyond what was found.
    count = [sum(region["group"] != "outline" for region in error["regions"]) for error in (a, b)]
    assert count[0] == count[1]


def check_depth_maps(run):
    """The picture of `run` itself, in other formats, units and meanings, has the figures of `run`."""
    own = json.load(open(path(run + "/report.json")))
    same(own, score(run + "/depth.exr", run=run))
    z = channel(run + "/depth.exr", "Z").astype(float)
    np.save(path("f4.npy"), z.astype("<f4"))
    same(own, score("f4.npy", run=run))
    np.save(path("f8.npy"), np.asfortranarray((z / 1000).astype(">f8")))
    same(own, score("f8.npy", "--unit", "m", run=run))
    np.savez_compressed(path("arrays.npz"), Z=np.nan_to_num(z)[..., None], other=z + 9)
    same(own, score("arrays.npz", run=run))
    np.savez(path("masked.npz"), depth=np.nan_to_num(z, nan=77), seen=~np.isnan(z))
    same(own, score("masked.npz", "--channel", "depth", "--mask", "seen", run=run))
    before = z.copy()
    before[:2] = 1  # as of the wall of the womb, before the box
    np.save(path("before.npy"), before)
    inside = z.copy()
    inside[:2] = np.nan
    np.save(path("inside.npy"), inside)
    same(score("inside.npy", run=run), score("before.npy", "--clip", run=run))
    done = command("score", path("before.npy"), "--scene", path(run + "/report.json"), "--out", path("scored"))
    share = 100 * 2 * z.shape[1] / np.isfinite(before).sum()
    assert share > 5 and f"{share:.3g} % of the found pixels lie outside" in done.stderr, (share, done.stderr)
    np.save(path("far.npy"), np.nan_to_num(z, nan=1e10))
    same(own, score("far.npy", "--far", "1e10", run=run))
    refused("far.npy", says="--far 1e+10", run=run)
    write_picture("own.tif", np.nan_to_num(z).astype(np.float32))
    same(own, score("own.tif", run=run))
    write_picture("metres.exr", np.dstack([z * 0 + 1, z / 1000]).astype(np.float32), ("A", "Z"), units="m")
    same(own, score("metres.exr", run=run))
    # In steps of 0.01 mm and without a unit of its own: lengths as integers are the file's unit.
    write_picture("integers.tif", np.rint(np.nan_to_num(z)).astype(np.uint16), ("Y",), "uint16")
    figures = score("integers.tif", run=run)["error"]
    rounded = np.rint(np.nan_to_num(z))
    truth = channel(run + "/truth_depth.exr", "Z")
    errors = (rounded - truth)[(rounded > 0) & ~np.isnan(truth)]
    assert abs(figures["p95_mm"] - np.percentile(abs(errors), 95)) < 1e-3, figures
    return own, z


def check_dialects(own, z, run):
    """What other programs add to a map of depths, or leave out of it."""
    write_picture("steps.png", np.rint(100 * np.nan_to_num(z)).astype(np.uint16), ("Y",), "uint16")
    same(own, score("steps.png", "--step-mm", "0.01", run=run), 6e-3)
    refused("steps.png", says="--step-mm must say how many mm", run=run)
    refused("steps.png", "--step-mm", "0.01", "--unit", "mm", says="must not be given with --step-mm", run=run)
    for scale, order in (("-1.0", "<f4"), ("2", ">f4")):
        pfm = f"Pf\n96 96\n{scale}\n".encode() + np.flipud(np.nan_to_num(z, nan=np.inf)).astype(order).tobytes()
        open(path("map.pfm"), "wb").write(pfm)
        same(own, score("map.pfm", run=run))
    open(path("cut.pfm"), "wb").write(pfm[:-1])
    refused("cut.pfm", says="96 x 96 voxels of float32", run=run)
    rows, columns = (np.nonzero(~np.isnan(z).all(axis))[0] for axis in (1, 0))
    inside = dict(x=columns[0], y=rows[0], full_width=96, full_height=96)
    write_picture("crop.exr", z[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1].astype(np.float32), window=inside)
    same(own, score("crop.exr", run=run))
    around = dict(x=-3, y=-2, full_width=96, full_height=96)
    write_picture("over.exr", np.pad(z, ((2, 5), (3, 1)), constant_values=50).astype(np.float32), window=around)
    same(own, score("over.exr", run=run))
    np.savez(path("beside.npz"), depth=z, name="phantom", made=np.array([{}], dtype=object), K=np.eye(3))
    same(own, score("beside.npz", "--channel", "depth", run=run))
    refused("beside.npz", says="holds depth, name, made, K: --channel must name", run=run)
    refused("beside.npz", "--channel", "name", says="values of NumPy's type <U7", run=run)
    shutil.copy(path("f4.npy"), path("array.dat"))  # the name says nothing: the first bytes do
    same(own, score("array.dat", run=run))


def check_claims():
    """What a file claims is refused before memory is taken for it, by its own head."""
    z = channel("parallel/depth.exr", "Z")
    with zipfile.ZipFile(path("bomb.npz"), "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive, archive.open("Z.npy", "w") as out:
        np.lib.format.write_array_header_1_0(out, {"descr": "<f8", "fortran_order": False, "shape": (10000, 10000)})
        for _ in range(100):
            out.write(bytes(8 * 10 ** 6))
    program = subprocess.Popen([PROGRAM, "score", path("bomb.npz"), "--scene", path("parallel/report.json"), "--out", path("refused")],
                               stderr=subprocess.PIPE, text=True)
    said, (_, status, usage) = program.stderr.read(), os.wait4(program.pid, 0)
    assert os.waitstatus_to_exitcode(status) == 2 and "has 10000 x 10000 pixels; must be 96 x 96" in said, said
    assert usage.ru_maxrss < 500_000, usage
    np.savez(path("two.npz"), Z=z, b=z)
    whole = open(path("two.npz"), "rb").read()
    first, second = whole.index(b"PK\x01\x02"), whole.rindex(b"PK\x01\x02")
    # The second begins where the first does; the first reaches into the second.
    for at, number in ((second + 42, 0), (first + 20, second // 2 + 99)):
        open(path("overlap.npz"), "wb").write(whole[:at] + number.to_bytes(4, "little") + whole[at + 4:])
        refused("overlap.npz", says="arrays overlap")
    head = ("{'descr': '" + "x" * 32000 + "', 'fortran_order': False, 'shape': (96, 96), }\n").encode()
    long = b"\x93NUMPY\x02\x00" + len(head).to_bytes(4, "little") + head + bytes(96 * 96)
    open(path("long.npy"), "wb").write(long)
    refused("long.npy", says="its header has 3")
    with zipfile.ZipFile(path("long.npz"), "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Z.npy", long)
    refused("long.npz", says="its header has 3")
    for shape, says in {"(99999999999999999999, 9)": "absurd size", "(96, 96": "damaged", "(-96, 96)": "damaged"}.items():
        head = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}".encode()
        open(path("shape.npy"), "wb").write(b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head)
        refused("shape.npy", says=says)


def check_z(own, z):
    """In perspective z of the camera is less than the length of the ray."""
    camera = own["camera"]
    to_world, n = np.linalg.inv(camera["world_to_ndc"]), z.shape[0]
    middles = (2 * np.arange(n) + 1) / n - 1
    x, y = np.meshgrid(middles, -middles)
    at = np.stack([x, y, 0 * x + 0.5, 0 * x + 1], -1) @ to_world
    in_camera = np.concatenate([at[..., :3] / at[..., 3:], np.ones((n, n, 1))], -1) @ np.array(camera["world_to_camera"])
    cosine = in_camera[..., 2] / np.linalg.norm(in_camera[..., :3], axis=-1)
    np.save(path("z.npy"), z * cosine)
    same(own, score("z.npy", "--kind", "z", run="perspective"), 1e-4)
    biased = score("z.npy", run="perspective")["error"]["bias_mm"]
    assert biased < own["error"]["bias_mm"] - 0.1, biased


def ball(center, radius, around=96):
    source = vtk.vtkSphereSource()
    source.SetCenter(*center)
    source.SetRadius(radius)
    source.SetThetaResolution(2 * around)
    source.SetPhiResolution(around)
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(source.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def write_mesh(file, mesh):
    writer = {"ply": vtk.vtkPLYWriter, "stl": vtk.vtkSTLWriter, "obj": vtk.vtkOBJWriter}[file[-3:]]()
    writer.SetFileName(path(file))
    writer.SetInputData(mesh)
    writer.Write()


def check_true(report, p95_mm, missed_percent=0.0):
    error = report["error"]
    assert error["p95_mm"] < p95_mm, error["p95_mm"]
    assert error["missed_percent"] <= missed_percent, error["missed_percent"]
    assert error["pixels"] > 300


def check_meshes(run):
    """A ball of triangles where the true ball is has next to no error."""
    for file in ("ball.ply", "ball.stl", "ball.obj"):
        write_mesh(file, ball(CENTER_MM, RADIUS_MM))
        check_true(score(file, run=run), 0.03, 0.05)
    write_mesh("metres.ply", ball(CENTER_MM / 1000, RADIUS_MM / 1000))
    check_true(score("metres.ply", "--unit", "m", run=run), 0.03, 0.05)
    write_mesh("centred.stl", ball((0, 0, 0), RADIUS_MM))
    check_true(score("centred.stl", "--frame", "phantom", run=run), 0.03, 0.05)
    refused("metres.ply", says="--unit m", run=run)
    refused("ball.ply", "--unit", "m", says="--unit mm", run=run)
    refused("centred.stl", says="--frame phantom", run=run)
    # 0.5 mm too large: the near side lies half a millimetre nearer along the normal.
    write_mesh("large.ply", ball(CENTER_MM, RADIUS_MM + 0.5))
    assert -1.0 < score("large.ply", run=run)["error"]["median_mm"] < -0.5


def check_points(run):
    golden = np.pi * (3 - 5 ** 0.5) * np.arange(40000)
    height = np.linspace(-1, 1, 40000)
    around = np.sqrt(1 - height ** 2)
    at = CENTER_MM + RADIUS_MM * np.stack([around * np.cos(golden), around * np.sin(golden), height], -1)
    with open(path("cloud.ply"), "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 40000\n")
        file.write("".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n")
        np.savetxt(file, at, "%.4f")
    report = score("cloud.ply", run=run)
    check_true(report, 0.5, 0.3)
    # An organised cloud, with a point for each pixel: those that nothing was seen in have no place.
    text = open(path("cloud.ply")).read().replace("vertex 40000", "vertex 40004")
    open(path("organised.ply"), "w").write(text + "nan nan nan\n1.#IND 1.#IND -1.#QNAN\n-nan(ind) 0 inf\n-1.#INF 2 3\n")
    organised = score("organised.ply", run=run)
    assert organised["error"] == report["error"] and organised["scored"]["counts"]["points_without_place"] == 4
    numbers = np.vstack([at, np.full((9, 3), np.nan)]).astype("<f4")
    with open(path("binary.ply"), "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex 40009\nproperty float x\nproperty float y\n"
                   b"property float z\nend_header\n" + numbers.tobytes())
    assert score("binary.ply", run=run)["scored"]["counts"]["points_without_place"] == 9
    assert abs(report["error"]["bias_mm"]) < 0.1, report["error"]
    assert report["scored"]["what"] == "point cloud"


def check_imported_mesh():
    """The mesh that was scanned, by its own coordinates, which do not have their origin in the middle of its box."""
    mesh = os.path.join(os.path.dirname(__file__), "../../../docs/scenes/pebble.obj")
    done = command("run", "--out", path("pebble"), *settings(
        ["phantom.name=mesh", f"phantom.file={mesh}", "placement.rotation_deg=[10, -20, 5]"] + SCENE[1:] + ASKEW))
    assert done.returncode == 0, done.stderr
    report = score(mesh, "--frame", "file", run="pebble")
    assert report["error"]["p95_mm"] < 0.1 and abs(report["error"]["median_mm"]) < 0.02, report["error"]
    report = score(mesh, "--frame", "phantom", run="pebble")
    assert report["error"]["p95_mm"] > 0.5
    assert "the middle of the imported mesh's bounding box" in report["scored"]["taken"]["frame"]
    refused(mesh, "--frame", "file", says="phantom.name = sphere")


def check_recorded_scene():
    """The report of a recording has a scene and no picture: the truth is that of the same scene's run."""
    assert command("record", "--replace", "--out", path("recorded"), *settings(SCENE)).returncode == 0
    os.rename(path("recorded/recording.json"), path("recorded/report.json"))
    same(json.load(open(path("parallel/report.json"))), score("parallel/depth.exr", run="recorded"))


def check_refusals():
    z = channel("parallel/depth.exr", "Z")
    np.save(path("small.npy"), z[::2, ::2])
    refused("small.npy", says="has 48 x 48 pixels; must be 96 x 96")
    np.save(path("none.npy"), z * np.nan)
    refused("none.npy", says="holds no surface")
    np.save(path("metres.npy"), z / 1000)
    refused("metres.npy", says="--unit m")
    np.save(path("complex.npy"), z.astype(complex))
    refused("complex.npy", says="<c16")
    np.save(path("cube.npy"), np.zeros((3, 4, 5)))
    refused("cube.npy", says="3 x 4 x 5")
    refused("parallel/depth.exr", says="another view", run="perspective")
    refused("parallel/depth.exr", "--unit", "m", says="says mm")
    refused("parallel/depth.exr", "--channel", "W", says="Z, Z_filtered")
    np.savez(path("two.npz"), a=z, b=z)
    refused("two.npz", says="--channel must name")
    for file in ("f4.npy", "arrays.npz", "own.tif", "parallel/depth.exr", "ball.ply", "ball.stl"):
        whole, kind = open(path(file), "rb").read(), file[-4:]
        for rest in (0.5, 0.97):
            open(path("cut" + kind), "wb").write(whole[: int(rest * len(whole))])
            refused("cut" + kind, says="cut" + kind)
        open(path("noise" + kind), "wb").write(bytes(range(256)) * 40)
        refused("noise" + kind, says="noise" + kind)
    open(path("text.txt"), "w").write("1")
    refused("text.txt", says="must be a depth map")
    done = command("score", path("f4.npy"), "--scene", path("scored/report.html"), "--out", path("refused"))
    assert done.returncode == 2, done.stderr
    done = command("score", path("parallel/depth.exr"), "--scene", path("parallel/report.json"), "--out", path("limited"),
                   "--limit", "p95_mm<=1e-3", "--limit", "missed_percent<=100")
    assert done.returncode == 1 and "--limit p95_mm<=0.001: p95_mm is" in done.stderr, done.stderr


for view, keys in {"parallel": [], "perspective": ASKEW + ["render.view.projection=perspective"]}.items():
    done = command("run", "--out", path(view), *settings(SCENE + keys))
    assert done.returncode == 0, done.stderr
    own, z = check_depth_maps(view)
    check_dialects(own, z, view)
    if view == "perspective":
        check_z(own, z)
    check_meshes(view)
    check_points(view)
check_imported_mesh()
check_claims()
check_recorded_scene()
check_refusals()
