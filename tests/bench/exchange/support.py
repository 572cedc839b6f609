"""Runs the program under test, and reads what it wrote with programs that are not ours."""
import functools
import os
import resource
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

PROGRAM = os.environ["WOBBLEBENCH"]
# Of this script: a phantom is made once, and the user's cache is left alone.
CACHE = tempfile.TemporaryDirectory()
os.environ["XDG_CACHE_HOME"] = CACHE.name

SMALL_SCAN = [f"acquisition.{key}" for key in ("sticks_per_frame=40", "samples_per_stick=192", "frames_per_volume=21")]


def settings(*keys):
    return [word for key in keys for word in ("--set", key)]


# Away from all axes and from the middle of the depth, so that no axis can be exchanged or mirrored unseen.
BALL, RADIUS = np.array([14.0, -9.0, 106.0]), 18.0
BALL_SCENE = settings("phantom.name=sphere", f"phantom.radius_mm={RADIUS}",
                      f"placement.position_mm={BALL.tolist()}", *SMALL_SCAN)
# Each volume is then the same, and samples vary as the beam lets them.
SMOOTH = settings("simulation.speckle=false", "simulation.noise_db=-200")


@functools.cache
def twice(*arguments):
    """A bound for bad input: twice the address space that the program takes for this honest one, in bytes."""
    child, most_kb = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.DEVNULL), 0
    while child.poll() is None:
        with open(f"/proc/{child.pid}/status", encoding="ascii") as status:
            most_kb = max([most_kb, *(int(line.split()[1]) for line in status if line.startswith("VmPeak"))])
    assert child.returncode == 0
    return 2 * 1024 * most_kb


def attempt(*arguments, most=resource.RLIM_INFINITY):
    """`most`: bytes of address space."""
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (most, most)))


def run(*arguments, code=0, **limit):
    """stdout and stderr; the exit code must be the expected one."""
    done = attempt(*arguments, **limit)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}, not {code}: {done.stderr}")
    return done.stdout + done.stderr


class InFolder(unittest.TestCase):
    """Each class has a folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)


def positions(theta_deg, motor_deg, range_mm, radius_mm, wobble_radius_mm):
    """Positions [frame, line, sample, 3] in mm, by rotations: a point of the image plane at rest is
    turned about the axis that is parallel to x and lies `wobble_radius_mm` behind the face."""
    theta = np.radians(theta_deg)[None, :, None]
    r = radius_mm + range_mm[None, None, :]
    plane = np.stack(np.broadcast_arrays(r * np.sin(theta), 0 * r * theta, r * np.cos(theta)), -1)
    axis = np.array([0, 0, radius_mm - wobble_radius_mm])
    turned = np.empty((len(motor_deg),) + plane.shape[1:])
    for f, angles in enumerate(np.radians(motor_deg)):
        for l, angle in enumerate(angles):
            turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
            turned[f, l] = (plane[0, l] - axis) @ turn.T + axis
    return turned


def off_ball(scan):
    """Of a file's first volume, how far each sample lies outside the ball, in mm; by closed forms."""
    at = positions(scan["theta_deg"], scan["motor_angle_deg"][0], scan["range_mm"],
                   float(scan["radius_mm"]), float(scan["wobble_radius_mm"]))
    return np.linalg.norm(at - BALL, axis=-1) - RADIUS
