"""Where a point is seen, how wide, and how loud: by sticks that turn past it, by frames that turn past it, and along the
stick, against the sum over elements of tests/yardstick/point_widths.csv, at every depth, angle and preset of it."""
import unittest

import numpy

import scan
import make_tables
from scan import DEGREE, PRESETS, decibel, full_width, peak

DEPTH_MM, SAMPLES = 170, 4096
AMPLITUDE = 0.1
LINES_OF_HALF_SECTOR = 400  # so that sticks lie at the table's angles
BEYOND_DEG, FRAMES, FRAME_STEP_DEG = 4, 301, 0.1


def middle_of_probe(preset, theta, depth_mm, amplitude):
    radius = PRESETS[preset].radius * 1e3 + depth_mm
    return radius * numpy.sin(theta), 0, radius * numpy.cos(theta), amplitude


class Points(scan.Worst):
    def scan_fraction(self, name, preset, rung, fraction, rows, around=None, level_bar_db=0.5):
        """Points at each of the rows' depths; `around`: attenuating tissue in which they lie, of 45 dB less echo."""
        theta = fraction * PRESETS[preset].sector / 2
        amplitude = 1 if around else AMPLITUDE
        points = scan.scatterers(middle_of_probe(preset, theta, row["depth_mm"], amplitude) for row in rows)
        step = scan.half_sector_deg(preset) / LINES_OF_HALF_SECTOR
        at = round(fraction * LINES_OF_HALF_SECTOR)
        beyond = int(BEYOND_DEG / step)
        scene = (scan.probe(preset), rung, points, {**scan.LOSSLESS, **(around or {})})
        lines = scan.envelope(*scene, scan.grid(2 * (at + beyond) + 1, step, 1, 0, DEPTH_MM, SAMPLES))[0, 0]
        turned = scan.grid(2 if at else 1, 2 * at * step, FRAMES, FRAME_STEP_DEG, DEPTH_MM, SAMPLES)
        frames = scan.envelope(*scene, turned)[0, :, -1]
        lines = lines[2 * at:]  # the others are on the other side, or far from the point
        ranges, coarse = scan.ranges_mm(DEPTH_MM, lines.shape[-1]), scan.ranges_mm(DEPTH_MM, frames.shape[-1])
        for row in rows:
            depth = row["depth_mm"]
            window, coarse_window = scan.near(ranges, depth, 2.5), scan.near(coarse, depth, 2.5)
            across = peak(lines[:, window])
            stick = lines[beyond, window]
            radius = PRESETS[preset].radius * 1e3 + depth
            lever = scan.motor_lever(PRESETS[preset], theta, depth * 1e-3) * 1e3
            widths = {"lateral": full_width(numpy.arange(len(across)) * step * DEGREE * radius, across),
                "elevation": full_width(numpy.arange(FRAMES) * FRAME_STEP_DEG * DEGREE * lever, peak(frames[:, coarse_window])),
                "axial": full_width(ranges[window], stick)}
            part = "axis" if at == 0 else "edge"
            where = f"at {depth:g} mm, {fraction:g} of the half sector"
            for direction, width in widths.items():
                bar = 0.1 if at or around else self.axis_bar(direction, rung)
                self.hold(f"{name}.{direction}.{part}", width / row[f"{direction}_mm"] - 1, bar, where)
            level = decibel(peak(stick) / amplitude)
            self.hold(f"{name}.level.{part}", level - row["level_db"], level_bar_db, where)
            self.hold(f"{name}.range_mm", ranges[window][numpy.argmax(stick)] - depth, 0.2, where)
            if at == 0:
                self.hold(f"{name}.line", (numpy.argmax(across) - beyond) * step, 0.1, where)

    @staticmethod
    def axis_bar(direction, rung):
        """The beam's table has cells, across frames as steps in a point's profile: where frames fall on them is 3 % of its width."""
        return 0.08 if direction == "elevation" and rung is not scan.REFERENCE else 0.05

    def scan_preset(self, name, preset, rung, fractions=None):
        rows = [row for row in scan.over_middle("point_widths", preset) if 30 <= row["depth_mm"] <= 160]
        for fraction in sorted({row["sector_fraction"] for row in rows}):
            if fractions is None or fraction in fractions:
                self.scan_fraction(f"{name}.{preset}", preset, rung, fraction, [row for row in rows if row["sector_fraction"] == fraction])

    def test_scatterers(self):
        for preset in PRESETS:
            self.scan_preset("scatterers", preset, scan.MAIN_LOBE)

    def test_scatterers_side_lobes(self):
        for preset in PRESETS:
            self.scan_preset("scatterers_side_lobes", preset, scan.SIDE_LOBES)

    def test_reference(self):
        for preset in PRESETS:
            self.scan_preset("reference", preset, scan.REFERENCE)

    def test_in_attenuating_tissue(self):
        """Each frequency attenuated by itself: of soft tissue tests/yardstick/attenuation.csv, of brain its sum made here."""
        for material, alpha in (("soft_tissue", 0.5), ("brain", 0.4)):
            rows = []
            for depth in (30, 40, 50, 60, 75, 90, 110, 130, 150, 160):
                level, _, _, axial, lateral, elevation = make_tables.attenuation(alpha, depth)[0]
                rows.append({"depth_mm": depth, "level_db": level, "axial_mm": axial, "lateral_mm": lateral, "elevation_mm": elevation})
            even = {**scan.even(material), "simulation.attenuation": True}
            self.scan_fraction(f"attenuated.{alpha}", "standard", scan.MAIN_LOBE, 0, rows, even, 1)

    def test_middle_and_last_stick(self):
        """The part for CI."""
        self.scan_preset("scatterers", "standard", scan.MAIN_LOBE, (0, 1))


if __name__ == "__main__":
    unittest.main()
