"""What the tests of physics share: scans by `record --iq`, the tables of tests/yardstick, and measures of both."""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

YARDSTICK = pathlib.Path(__file__).parent.parent / "yardstick"
sys.path.insert(0, str(YARDSTICK))
from element_sum import DEGREE, PRESETS, motor_lever  # noqa: E402
from point_spread import full_width  # noqa: E402

PROGRAM = os.environ["WOBBLEBENCH_PROGRAM"]
CACHE = tempfile.TemporaryDirectory()  # not the user's
os.environ["XDG_CACHE_HOME"] = CACHE.name
PROBES = {"standard": "default", "c5_2v": "c5-2v", "curvilinear_60": "curvilinear-60"}  # by the yardstick's names
RAYLEIGH = numpy.sqrt(numpy.pi / (4 - numpy.pi))  # mean over standard deviation of its envelope
LOSSLESS = {"simulation.attenuation": False, "simulation.transmission_loss": False, "simulation.interface_echo": False}
# By docs/references.md: speed in m/s, impedance in MRayl, attenuation in dB/cm/MHz, and echo in dB against a mirror.
MATERIALS = {"water": (1480, 1.48, 0.0022, -200), "amniotic_fluid": (1530, 1.51, 0.005, -200), "soft_tissue": (1540, 1.63, 0.5, -45),
             "cortical_bone": (3432, 6.5, 5.0, -40), "brain": (1540, 1.58, 0.4, -50), "uterus_wall": (1540, 1.66, 0.83, -43)}
# Variants of the rungs that sum scatterers.
MAIN_LOBE = {"simulation.fidelity": "scatterers"}
SIDE_LOBES = {"simulation.fidelity": "scatterers", "simulation.side_lobes": True}
REFERENCE = {"simulation.fidelity": "reference"}
FIELD = {"simulation.fidelity": "field"}
# Soft tissue wherever it is scanned: the cyst lies behind the probe's face.
TISSUE = {"phantom.name": "cyst", "phantom.radius_mm": 1, "placement.position_mm": [0, 0, 0]}


def record(*settings):
    """IQ samples [volume, frame, line, sample] of a receiver without noise; 1 is a perfect mirror's echo."""
    merged = {"simulation.noise_db": -200, "simulation.low_pass": False}
    for some in settings:
        merged.update(some)
    with tempfile.TemporaryDirectory() as folder:
        words = [word for key, value in merged.items() for word in ("--set", f"{key}={json.dumps(value)}")]
        volumes = str(merged.get("acquisition.volumes", 1))
        done = subprocess.run([PROGRAM, "record", "--iq", *words, "--volumes", volumes, "--out", folder + "/scan"],
                              capture_output=True, text=True)
        if done.returncode:
            raise AssertionError(f"{' '.join(words)}: {done.stderr}")
        return numpy.load(folder + "/scan/iq.npy")


def envelope(*settings):
    return abs(record(*settings)).astype(float)


def grid(lines, line_step_deg, frames, frame_step_deg, depth_mm, samples):
    """An acquisition of sticks whose steps are given."""
    return {"acquisition.sticks_per_frame": lines, "acquisition.sector_deg": max(0.1, (lines - 1) * line_step_deg),
            "acquisition.frames_per_volume": frames, "acquisition.fan_deg": max(0.1, (frames - 1) * frame_step_deg),
            "acquisition.depth_mm": depth_mm, "acquisition.samples_per_stick": samples}


def ranges_mm(depth_mm, samples):
    return (numpy.arange(samples) + 0.5) * depth_mm / samples


def near(ranges, middle, half):
    """Samples within `half` of a range."""
    return slice(*numpy.searchsorted(ranges, (middle - half, middle + half)))


def probe(preset):
    return {"probe.preset": PROBES[preset]}


def half_sector_deg(preset):
    return PRESETS[preset].sector / DEGREE / 2


def scatterers(points):
    """Settings of a scene of nothing but points: rows of x, y, z in mm, and amplitude."""
    rows = "".join(",".join(f"{value:.9g}" for value in point) + "\n" for point in points)
    with tempfile.NamedTemporaryFile("w", suffix=".csv", dir=CACHE.name, delete=False) as file:
        file.write("x_mm,y_mm,z_mm,amplitude\n" + rows)
    return {"phantom.name": "sphere", "phantom.radius_mm": 1, "placement.position_mm": [0, 0, 0], "phantom.scatterers": file.name}


def table(name, **where):
    """Rows of a table of tests/yardstick, as dicts of numbers; `where`: the columns that they have."""
    with open(YARDSTICK / f"{name}.csv") as file:
        rows = list(csv.DictReader(line for line in file if line[0] != "#"))
    number = [{key: value if key in ("preset", "edge") else float(value) for key, value in row.items()} for row in rows]
    found = [row for row in number if all(row[key] == value for key, value in where.items())]
    if not found:
        raise LookupError(f"{name}: no row of {where}")
    return found


def over_middle(name, preset):
    """The same of a preset, with levels over the middle stick's at the same depth, to which the rungs are normalised."""
    rows = table(name, preset=preset)
    middle = {row["depth_mm"]: row["level_db"] for row in rows if row["sector_fraction"] == 0}
    return [{**row, "level_db": row["level_db"] - middle[row["depth_mm"]]} for row in rows]


class Band:
    """What is left of even tissue's mean power on the middle stick, where the centre frequency loses `loss_db`: each frequency
    loses by itself. tests/yardstick/tissue_band.csv."""

    def __init__(self, preset):
        rows = table("tissue_band", preset=preset, sector_fraction=0)
        self.depths = numpy.unique([row["depth_mm"] for row in rows])
        self.share, mhz = (numpy.array([row[key] for row in rows]).reshape(len(self.depths), -1) for key in ("share", "mhz"))
        self.relative = mhz * 1e6 / PRESETS[preset].centre_frequency

    def level_db(self, depth_mm, loss_db):
        depth_mm, loss_db = numpy.broadcast_arrays(depth_mm, loss_db)
        left = [decibel_of_power(10 ** (-loss_db[..., None] * relative / 10) @ share) for share, relative in zip(self.share, self.relative)]
        behind = numpy.clip(numpy.searchsorted(self.depths, depth_mm), 1, len(self.depths) - 1)
        part = (depth_mm - self.depths[behind - 1]) / (self.depths[behind] - self.depths[behind - 1])
        before, after = (numpy.choose(at, left) for at in (behind - 1, behind))
        return before + part * (after - before)


def peak(envelope):
    """Maximum of each row between its samples, through the logarithms of the highest and its neighbours."""
    at = numpy.clip(envelope.argmax(-1), 1, envelope.shape[-1] - 2)[..., None]
    left, middle, right = (numpy.log(numpy.take_along_axis(envelope, at + step, -1)[..., 0] + 1e-12) for step in (-1, 0, 1))
    bend = numpy.minimum(left - 2 * middle + right, -1e-3)
    return numpy.minimum(numpy.exp(middle - (left - right) ** 2 / 8 / bend), 1.2 * envelope.max(-1))  # of noise, its samples


def box(half_x, half_y, thickness, material, background, front=(0, 0, 0), tilt_deg=(0, 0)):
    """A slab in mm, the middle of whose front lies at `front` of the probe's frame, tilted about x or y."""
    corners = [(a * half_x, b * half_y, c * thickness / 2) for c in (-1, 1) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    faces = ((1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
    with tempfile.NamedTemporaryFile("w", suffix=".obj", dir=CACHE.name, delete=False) as file:
        file.writelines(f"v {a} {b} {c}\n" for a, b, c in corners)
        file.writelines(f"f {' '.join(map(str, face))}\n" for face in faces)
    x, y = numpy.radians(tilt_deg)
    inwards = numpy.array([numpy.sin(y), -numpy.sin(x), numpy.cos(x) * numpy.cos(y)])
    return {"phantom.name": "mesh", "phantom.file": file.name, "phantom.unit_mm": 1, "phantom.materials": [material],
            "phantom.background": background, "placement.position_mm": (numpy.array(front) + thickness / 2 * inwards).tolist(),
            "placement.rotation_deg": [*tilt_deg, 0]}


def even(material):
    """A material wherever it is scanned: the box lies behind the probe's face, and its middle in the probe's origin."""
    return box(2, 2, 2, "amniotic_fluid" if material != "amniotic_fluid" else "water", material, (0, 0, -1))


def rays(theta_deg, phi_deg, radius_mm=40, axis_mm=13):
    """Origins on the face and directions of sticks, by docs/units.md, of the standard probe."""
    theta, phi = numpy.broadcast_arrays(numpy.radians(theta_deg), numpy.radians(phi_deg))
    none = 0 * theta
    along = numpy.stack([numpy.sin(theta), -numpy.cos(theta) * numpy.sin(phi), numpy.cos(theta) * numpy.cos(phi)], -1)
    return radius_mm * along + axis_mm * numpy.stack([none, numpy.sin(phi), 1 - numpy.cos(phi)], -1), along


def decibel(amplitude):
    return 20 * numpy.log10(amplitude)


def decibel_of_power(power):
    return 10 * numpy.log10(power)


class Worst(unittest.TestCase):
    """Collects figures by name, keeps the largest of each, and holds it to its bar at the end of a test."""

    def setUp(self):
        self.figures = {}

    def hold(self, name, figure, bar, where=""):
        before = self.figures.get(name)
        if before is None or not abs(before[0]) >= abs(figure):
            self.figures[name] = (figure, bar, where)

    def tearDown(self):
        for name, (figure, bar, where) in self.figures.items():
            print(f"{self.id().split('.', 1)[1]}: {name} {figure:.4g}, at most {bar} {where}", flush=True)
        for name, (figure, bar, where) in self.figures.items():
            with self.subTest(figure=name, where=where):
                self.assertLessEqual(abs(figure), bar)
