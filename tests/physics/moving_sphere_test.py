"""A sphere that moves while it is scanned is sheared: each stick meets it where it is at the stick's own time. Its front, in the
first sample that is not fluid, against a line and a ball whose centre the motion's formula gives; times and motor angles are those
of docs/units.md."""
import unittest

import numpy

import scan
import wobblebench

LINES, FRAMES, SAMPLES, DEPTH_MM, RADIUS_MM = 64, 37, 4096, 160, 20
CENTER_MM = numpy.array([0, 0, 110])
STICK_S = 2 * DEPTH_MM * 1e-3 / 1540


def along_path(time_s):
    return time_s[..., None] * numpy.array([6, -8, 10])


def breathing(time_s):
    return numpy.stack([0 * time_s, 5 * numpy.sin(2 * numpy.pi * time_s / 0.7), 0 * time_s], -1)


def front_mm(origin, along, middle):
    """NaN where the stick misses the ball, or meets it at more than 60 degrees."""
    to_middle = middle - origin
    nearest = (to_middle * along).sum(-1)
    aside = (to_middle ** 2).sum(-1) - nearest ** 2
    return nearest - numpy.sqrt(numpy.where(aside < 0.75 * RADIUS_MM ** 2, RADIUS_MM ** 2 - aside, numpy.nan))


class Shear(scan.Worst):
    def compare(self, name, motor, volume, motion, displacement_mm):
        scene = wobblebench.Scene(settings={
            "phantom.name": "sphere", "phantom.radius_mm": RADIUS_MM, "placement.position_mm": CENTER_MM.tolist(),
            "simulation.fidelity": "geometry", "acquisition.samples_per_stick": SAMPLES, "acquisition.motor": motor,
            "acquisition.volumes": volume + 1, **motion})
        samples = list(wobblebench.Board("sim", scene))[volume].samples
        frame, line = numpy.mgrid[:FRAMES, :LINES]
        turn = FRAMES - 1 - frame if motor == "alternating" and volume % 2 else frame
        time_s = ((volume * FRAMES + turn) * LINES + line) * STICK_S
        share = (line + 0.5) / LINES - 0.5  # of a frame's step, within it
        within = 0 if motor == "stepped" else share if turn is frame else -share
        origin, along = scan.rays((line / (LINES - 1) - 0.5) * 77, ((frame + within) / (FRAMES - 1) - 0.5) * 61)
        expected = front_mm(origin, along, CENTER_MM + displacement_mm(time_s))
        still = front_mm(origin, along, CENTER_MM + 0 * along)
        found = numpy.argmax(samples > 0, -1) * DEPTH_MM / SAMPLES  # the nearer end of the first sample
        meets = numpy.isfinite(expected)
        self.assertGreater(meets.sum(), 100)
        # Half a sample, and the rounding of the ball's distance on its voxels.
        self.hold(name, numpy.abs(found - expected)[meets].max(), 0.5 * DEPTH_MM / SAMPLES + 0.005, f"{meets.sum()} sticks")
        self.assertGreater(numpy.nanmax(numpy.abs(still - expected)), 20 * 0.5 * DEPTH_MM / SAMPLES)

    def test_path(self):
        self.compare("path_mm", "stepped", 0, {"motion.velocity_mm_s": [6, -8, 10]}, along_path)

    def test_path_sweeping_back(self):
        self.compare("path_sweeping_back_mm", "alternating", 1, {"motion.velocity_mm_s": [6, -8, 10]}, along_path)

    def test_breath(self):
        self.compare("breath_mm", "continuous", 0, {"motion.breath_amplitude_mm": 5, "motion.breath_period_s": 0.7}, breathing)


if __name__ == "__main__":
    unittest.main()
