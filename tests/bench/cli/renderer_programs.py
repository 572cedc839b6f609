#!/usr/bin/python3
"""renderer_programs.py PROGRAM FOLDER EXAMPLES: renderers in processes of their own, good and bad."""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

PROGRAM, FOLDER, EXAMPLES = sys.argv[1:4]
SMALL = ["phantom.name=sphere", "placement.position_mm=[7, -5, 108]", "acquisition.frames_per_volume=21",
         "render.ray_casting.image_size=64", "simulation.fidelity=field", "render.program=other",
         "render.program_voxel_mm=1"]
CACHE = tempfile.TemporaryDirectory()  # not in the folder that must be empty at the end
os.environ["XDG_CACHE_HOME"] = CACHE.name
os.makedirs(os.path.join(FOLDER, "tmp"), exist_ok=True)
os.environ["TMPDIR"] = os.path.join(FOLDER, "tmp")


def run(program, *more, out="out", command="run"):
    words = [PROGRAM, command, "--renderer", "other=" + program, "--out", os.path.join(FOLDER, out)]
    words += [word for key in SMALL + list(more) for word in ("--set", key)]
    return subprocess.run(words, capture_output=True, text=True)


def answering(body):
    """A program that makes `depth` of each request, and writes it."""
    file = os.path.join(FOLDER, "program.py")
    with open(file, "w") as program:
        program.write("import json, sys\nimport numpy as np\nfor line in sys.stdin:\n"
                      "    request = json.load(open(line.strip()))\n    n = request['camera']['image_size']\n"
                      + "".join("    " + row + "\n" for row in body.splitlines()))
    return "/usr/bin/python3 " + file


def check_example(name, p95_mm):
    done = run(f"/usr/bin/python3 {EXAMPLES}/{name}", out=name)
    assert done.returncode == 0, done.stderr
    report = json.load(open(os.path.join(FOLDER, name, "report.json")))
    error = report["error"]
    assert error["p95_mm"] < p95_mm and error["missed_percent"] < 2, error["p95_mm"]
    passes = [one["name"] for one in report["timing"]["render"]["passes"]]
    assert passes == ["exchange", "program"], passes
    assert "with the exchange of files" in report["provenance"]["gl_renderer"]


def check_request():
    """The request's two volumes hold the same samples at the places that its numbers say."""
    done = run(answering("json.dump(request, open(%r, 'w'))\n" "for name in ('polar', 'cartesian'):\n"
                         "    np.save(%r + name, np.load(request[name]['file']))\n"
                         "np.save(request['depth'], np.full((n, n), 50.0))\n"
                         "print('done', flush=True)" % (os.path.join(FOLDER, "request.json"), FOLDER + "/")),
               "simulation.fidelity=geometry")  # without speckle, which changes from sample to sample
    assert done.returncode == 0, done.stderr
    request = json.load(open(os.path.join(FOLDER, "request.json")))
    polar, grid = (np.load(os.path.join(FOLDER, name + ".npy")) for name in ("polar", "cartesian"))
    at, box = request["polar"], request["box"]
    assert polar.shape == (21, len(at["line_angles_deg"]), 512) and len(at["motor_angles_deg"]) == 21
    first, step = np.array(request["cartesian"]["first_mm"]), request["cartesian"]["spacing_mm"]
    last = first + step * (np.array(grid.shape[::-1]) - 1)
    assert (first - box["low_mm"] < step).all() and (box["high_mm"] - last < step).all()
    # docs/units.md, "Geometry of a stick"
    frame, line, sample = np.meshgrid(range(2, 19), range(5, 59, 3), range(240, 330, 3), indexing="ij")
    theta = np.radians(np.array(at["line_angles_deg"])[line])
    phi = np.radians(np.array(at["motor_angles_deg"])[frame, line])
    r = at["radius_mm"] + at["first_range_mm"] + at["range_step_mm"] * sample
    b = at["radius_mm"] - at["wobble_radius_mm"]
    x, y = r * np.sin(theta), -(r * np.cos(theta) - b) * np.sin(phi)
    z = b * (1 - np.cos(phi)) + r * np.cos(theta) * np.cos(phi)
    voxel = np.rint((np.stack([x, y, z], -1) - first) / step).astype(int)
    inside = ((voxel >= 0) & (voxel < grid.shape[::-1])).all(-1)
    voxel = voxel[inside]
    near = grid[voxel[:, 2], voxel[:, 1], voxel[:, 0]]
    samples = polar[frame, line, sample][inside]
    agree = np.corrcoef(near[np.isfinite(near)], samples[np.isfinite(near)])[0, 1]
    assert inside.sum() > 1000 and agree > 0.97, (inside.sum(), agree)


def check_bad(program, says, code=1, more=()):
    done = run(program, *more, out="bad")
    lines = [line for line in done.stderr.splitlines() if line.startswith("wobblebench: ") and "warning" not in line]
    assert done.returncode == code and len(lines) == 1 and says in lines[0], (program, done.returncode, done.stderr)
    assert not os.path.exists(os.path.join(FOLDER, "bad")), program


check_example("renderer.py", 4)
check_example("renderer_vtk.py", 4)
check_request()
check_bad("exit 3", "ended with exit code 3 before it answered")
check_bad("kill -SEGV $$", "before it answered")
check_bad("no_such_program_here", "its command was not found")
check_bad("sleep 60", "gave no answer in time", more=["render.program_timeout_s=0.5"])
check_bad("cat", "answered")
check_bad("yes | tr -d '\\n'", "more than a line")
check_bad("read line; echo done", "wrote no file")
check_bad("read line; echo 'error: no licence'", "said: no licence")
check_bad(answering("np.save(request['depth'], np.zeros((n, n + 1)))\nprint('done', flush=True)"), "64 x 65; must be 64 x 64")
check_bad(answering("open(request['depth'], 'w').write('no array')\nprint('done', flush=True)"), "is no readable NumPy file")
check_bad(answering("np.save(request['depth'], np.zeros((n, n), complex))\nprint('done', flush=True)"), "<c16")
check_bad(answering("np.save(request['depth'], np.full((n, n), 0.1))\nprint('done', flush=True)"), "lie in the view's box")
check_bad("", "must be NAME=COMMAND", code=2)
check_bad("true", "without effect: nothing sets render.program = other", code=2, more=["render.program="])
SMALL.remove("render.program=other")  # the only renderer is the one that is meant
check_bad("exit 3", "render.program = other: ended with exit code 3 before it answered")
assert not os.listdir(os.environ["TMPDIR"])
