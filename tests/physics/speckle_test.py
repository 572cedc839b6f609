"""Speckle of even soft tissue without losses: Rayleigh's statistics, its level, the number of scatterers, its size across
lines, across frames and along the stick, neighbours in the default scan, and that it goes where the tissue goes."""
import math
import unittest

import numpy

import scan
from scan import DEGREE, PRESETS, RAYLEIGH, decibel_of_power

DEPTH_MM = 165
VARIANTS = {"field": scan.FIELD, "scatterers": scan.MAIN_LOBE, "scatterers_side_lobes": scan.SIDE_LOBES}
ECHO_DB = scan.MATERIALS["soft_tissue"][3]


def tissue(seed, *settings):
    """Intensities [frame, line, sample]."""
    iq = scan.record(scan.TISSUE, scan.LOSSLESS, {"simulation.seed": seed}, *settings)[0]
    return (iq.real ** 2 + iq.imag ** 2).astype(float)


def level_db(intensity):
    """Mean power over that of the material, whose echo is a mean amplitude: of Rayleigh's, pi / 4 of the mean power is its square."""
    return decibel_of_power(math.pi / 4 * numpy.mean(intensity)) - ECHO_DB


def level_bar_db(name, preset, edge):
    """`field` takes a stick's level at angles about a degree apart: of curvilinear_60 it falls by 3 dB within one near the last."""
    return 1.5 if (name, preset, edge) == ("field", "curvilinear_60", True) else 0.5


def snr(values):
    return numpy.mean(values) / numpy.std(values)


def over_mean(intensity, ranges, from_mm, to_mm):
    """Intensities one millimetre apart, which speckle is about as long as, over the mean of their line and 10 mm of range."""
    step = math.ceil(1 / (ranges[1] - ranges[0]))
    parts = []
    for start in range(from_mm, to_mm, 10):
        part = intensity[:, :, scan.near(ranges, start + 5, 5)][:, :, ::step]
        parts.append((part / part.mean(axis=(0, 2), keepdims=True)).ravel())
    return numpy.concatenate(parts)


class Statistics(scan.Worst):
    SAMPLES, STEPS, BEYOND, FRAMES = 1500, 32, 5, 80  # steps of half the sector

    def measure(self, name, preset, seeds=(1, 2)):
        """Three lines about the middle of the sector, and about the last stick on either side."""
        step = scan.half_sector_deg(preset) / self.STEPS
        plan = scan.grid(2 * (self.STEPS + self.BEYOND) + 1, step, self.FRAMES, 1.25, DEPTH_MM, self.SAMPLES)
        volumes = [tissue(seed, scan.probe(preset), VARIANTS[name], plan) for seed in seeds]
        ranges = scan.ranges_mm(DEPTH_MM, self.SAMPLES)
        for part, middles in (("axis", (self.STEPS + self.BEYOND,)), ("edge", (self.BEYOND, 2 * self.STEPS + self.BEYOND))):
            values = numpy.concatenate([over_mean(volume[:, at - 1:at + 2], ranges, 30, 150) for volume in volumes for at in middles])
            figure = f"{name}.{preset}.{part}"
            self.hold(f"{figure}.mean_over_sigma", snr(numpy.sqrt(values)) - RAYLEIGH, 0.03)
            for row in scan.over_middle("speckle", preset):
                if row["sector_fraction"] == (part == "edge") and 30 <= row["depth_mm"] <= 150:
                    window = scan.near(ranges, row["depth_mm"], 2.5)
                    found = level_db([volume[:, at, window] for volume in volumes for at in middles])
                    self.hold(f"{figure}.level", found - row["level_db"], level_bar_db(name, preset, part == "edge"), f"at {row['depth_mm']:g} mm")

    def test_every_preset(self):
        for preset in PRESETS:
            for name in VARIANTS:
                self.measure(name, preset)

    def test_field(self):
        """The part for CI."""
        self.measure("field", "standard", (1,))

    def test_density(self):
        """Intensity of N scatterers at Poisson's random has 1 / sqrt(1 + 1 / N); of a Gaussian beam N is 1.064 cubed times the
        number in the product of the three -6 dB widths. Many make Rayleigh's envelope."""
        plan = scan.grid(3, 1.2, self.FRAMES, 1.25, DEPTH_MM, self.SAMPLES)
        ranges = scan.ranges_mm(DEPTH_MM, self.SAMPLES)
        for per_cell in (1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30):
            values = numpy.concatenate([
                over_mean(tissue(seed, scan.MAIN_LOBE, {"simulation.scatterers_per_cell": per_cell}, plan), ranges, 60, 90)
                for seed in (1, 2)])
            effective = per_cell * (math.sqrt(2 * math.pi) / math.sqrt(8 * math.log(2))) ** 3
            self.hold("density.intensity", snr(values) - 1 / math.sqrt(1 + 1 / effective), 0.04, f"at {per_cell} in a cell")
        self.hold("density.envelope_at_most", snr(numpy.sqrt(values)) - RAYLEIGH, 0.03)


def correlation(intensity, frames=0, samples=0, other=None):
    """Of intensities [frame, sample] with those of another line, or farther on; each with its own mean."""
    other = intensity if other is None else other
    one = intensity[:len(intensity) - frames, :intensity.shape[1] - samples]
    other = other[frames:, samples:]
    return numpy.mean(one * other) - one.mean() * other.mean(), one.std() * other.std()


def full_width(of_lag, lag_mm):
    """Of an autocovariance that falls as a Gaussian does between two lags."""
    before = 0
    for lag in range(1, 80):
        here = -math.log(max(of_lag(lag), 1e-3))
        if here >= math.log(2):
            return 2 * lag_mm * math.sqrt((lag - 1) ** 2 + (math.log(2) - before) / (here - before) * (2 * lag - 1))
        before = here
    raise AssertionError("the autocovariance does not fall to half")


class Size(scan.Worst):
    """Widths of the intensity's autocovariance against the integral over scatterers of tests/yardstick/speckle.csv."""
    SEEDS = (1, 2, 3, 4)
    LINES_OF_HALF, BEYOND_DEG, LINES_FRAMES = 150, 6, 64  # so that sticks lie at the table's angles
    FRAMES, FRAME_STEP_DEG = 320, 0.19

    def lateral(self, name, preset, rows, seeds):
        """And level."""
        samples = 1500
        step = scan.half_sector_deg(preset) / self.LINES_OF_HALF
        middle = self.LINES_OF_HALF + round(self.BEYOND_DEG / step)  # the scan's end is not seen
        plan = scan.grid(2 * middle + 1, step, self.LINES_FRAMES, 1.27, DEPTH_MM, samples)
        ranges, widths, levels = scan.ranges_mm(DEPTH_MM, samples), {}, {}
        for seed in seeds:
            volume = tissue(seed, scan.probe(preset), VARIANTS[name], plan)
            for number, row in enumerate(rows):
                part = volume[:, :, scan.near(ranges, row["depth_mm"], 2.5)]
                radius = PRESETS[preset].radius * 1e3 + row["depth_mm"]
                for at in {middle + round(side * row["sector_fraction"] * self.LINES_OF_HALF) for side in (1, -1)}:
                    def of_lag(lag):
                        first = [at + offset - lag // 2 for offset in (-1, 0, 1)]
                        pairs = [correlation(part[:, i], other=part[:, i + lag]) for i in first if 0 <= i and i + lag < part.shape[1]]
                        return sum(pair[0] for pair in pairs) / sum(pair[1] for pair in pairs)
                    widths.setdefault(number, []).append(full_width(of_lag, step * DEGREE * radius))
                    levels.setdefault(number, []).append(part[:, at].mean())
        return widths, {number: [level_db(values)] for number, values in levels.items()}

    def turned(self, name, preset, rows, seeds):
        """Elevation and axial width."""
        samples = 4096
        ranges, elevation, axial = scan.ranges_mm(DEPTH_MM, samples), {}, {}
        for fraction in sorted({row["sector_fraction"] for row in rows}):
            theta = fraction * PRESETS[preset].sector / 2
            plan = scan.grid(2, 2 * max(theta / DEGREE, 1.2), self.FRAMES, self.FRAME_STEP_DEG, DEPTH_MM, samples)
            for seed in seeds:
                volume = tissue(seed, scan.probe(preset), VARIANTS[name], plan)
                for number, row in enumerate(rows):
                    if row["sector_fraction"] != fraction:
                        continue
                    part = volume[:, :, scan.near(ranges, row["depth_mm"], 2.5)]

                    def of_lag(**lag):
                        pairs = [correlation(part[:, line], **lag) for line in (0, 1)]
                        return sum(pair[0] for pair in pairs) / sum(pair[1] for pair in pairs)
                    lever = scan.motor_lever(PRESETS[preset], theta, row["depth_mm"] * 1e-3) * 1e3
                    elevation.setdefault(number, []).append(
                        full_width(lambda lag: of_lag(frames=lag), self.FRAME_STEP_DEG * DEGREE * lever))
                    axial.setdefault(number, []).append(full_width(lambda lag: of_lag(samples=lag), DEPTH_MM / samples))
        return elevation, axial

    def measure(self, name, presets=tuple(PRESETS), seeds=SEEDS, fractions=None, widths=True):
        for preset in presets:
            rows = [row for row in scan.over_middle("speckle", preset)
                    if 20 <= row["depth_mm"] <= 150 and (fractions is None or row["sector_fraction"] in fractions)]
            lateral, level = self.lateral(name, preset, rows, seeds)
            found = {"level": level}
            if widths:
                found.update(zip(("lateral", "elevation", "axial"), (lateral, *self.turned(name, preset, rows, seeds))))
            for what, values in found.items():
                for number, row in enumerate(rows):
                    mean = numpy.mean(values[number])
                    part = "edge" if row["sector_fraction"] else "axis"
                    error, bar = mean / row.get(f"{what}_mm", 1) - 1, 0.1
                    if what == "level":
                        error, bar = mean - row["level_db"], level_bar_db(name, preset, part == "edge")
                    self.hold(f"{name}.{preset}.{what}.{part}", error, bar,
                              f"at {row['depth_mm']:g} mm, {row['sector_fraction']:g} of the half sector")

    def test_field(self):
        self.measure("field")

    def test_scatterers_side_lobes(self):
        self.measure("scatterers_side_lobes")

    def test_scatterers(self):
        """The main lobe alone has finer speckle, of which there is no table."""
        self.measure("scatterers", widths=False)

    def test_neighbours_of_the_default_scan(self):
        ranges = scan.ranges_mm(DEPTH_MM, 1500)
        for name, rung in VARIANTS.items():
            volumes = [tissue(seed, rung, {"acquisition.depth_mm": DEPTH_MM, "acquisition.samples_per_stick": 1500}) for seed in (1, 2, 3)]
            for row in scan.table("neighbours"):
                lines, frames = [], []
                for volume in volumes:
                    part = volume[:, 24:40, scan.near(ranges, row["depth_mm"], 3)]
                    lines += [correlation(part[:, i], other=part[:, i + 1]) for i in range(15)]
                    frames += [correlation(part[:, i], frames=1) for i in range(16)]
                for what, pairs in (("line", lines), ("frame", frames)):
                    found = sum(pair[0] for pair in pairs) / sum(pair[1] for pair in pairs)
                    self.hold(f"{name}.neighbouring_{what}s", found - row[f"{what}_correlation"], 0.05, f"at {row['depth_mm']:g} mm")


class Moving(scan.Worst):
    """Tissue moves so that in the second volume each stick sees what it, or its neighbour, saw in the first: along the axis by
    whole samples, in the image plane by one stick, across image planes by one frame."""
    DEPTH_MM, SAMPLES, DEAD_TIME_US = 90, 512, 1000
    STICK_S = DEAD_TIME_US * 1e-6 + 2 * DEPTH_MM * 1e-3 / 1540

    def compare(self, name, lines, frames, sector_deg, fan_deg, motion, shift):
        plan = {"acquisition.volumes": 2, "acquisition.dead_time_us": self.DEAD_TIME_US,
                **scan.grid(lines, sector_deg / max(1, lines - 1), frames, fan_deg / max(1, frames - 1), self.DEPTH_MM, self.SAMPLES)}
        for rung, settings in (("scatterers", scan.MAIN_LOBE), ("field", scan.FIELD)):
            first, second = scan.envelope(scan.TISSUE, scan.LOSSLESS, settings, plan, motion)
            oversampling = first.shape[-1] // self.SAMPLES
            ranges = scan.ranges_mm(self.DEPTH_MM, first.shape[-1])
            window = scan.near(ranges, 65, 20)
            stayed = numpy.corrcoef(first[..., window].ravel(), second[..., window].ravel())[0, 1]
            line, frame, sample = shift[0], shift[1], shift[2] * oversampling
            now = second[frame:, line:, window]
            before = first[:frames - frame, :lines - line, window.start - sample:window.stop - sample]
            followed = numpy.corrcoef(now.ravel(), before.ravel())[0, 1]
            if rung == "scatterers":
                self.hold(f"scatterers.{name}.lost", 1 - followed, 0.05)
                self.hold(f"scatterers.{name}.stays", stayed, 0.5)
            else:  # its speckle belongs to the probe's grid
                self.hold(f"field.{name}.leaves", 1 - stayed, 1e-3)

    def test_along_the_axis(self):
        shift_mm = 8 * self.DEPTH_MM / self.SAMPLES
        self.compare("axial", 3, 3, 4, 4, {"motion.velocity_mm_s": [0, 0, shift_mm / (9 * self.STICK_S)]}, (0, 0, 8))

    def test_in_the_image_plane(self):
        step = 60 / 47
        self.compare("in_the_image_plane", 48, 1, 60, 0, {"motion.turn_rate_deg_s": [0, step / (49 * self.STICK_S), 0]}, (1, 0, 0))

    def test_across_image_planes(self):
        step = 61 / 23
        motion = {"motion.turn_rate_deg_s": [step / (25 * self.STICK_S), 0, 0], "placement.position_mm": [0, 0, 13]}
        self.compare("across_image_planes", 1, 24, 0, 61, motion, (0, 1, 0))


if __name__ == "__main__":
    unittest.main()
