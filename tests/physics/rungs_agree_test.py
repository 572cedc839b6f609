"""The summed echo of 40 points in a few millimetres, by each rung that sums scatterers, against the sum over the probe's
elements of the same points: tests/yardstick/echoes.csv. A wrong phase, sign or weight of the beam shows here."""
import unittest

import numpy

import scan
from element_sum import stick_points
from scan import DEGREE, PRESETS, decibel

DEPTH_MM, SAMPLES = 160, 4096
HALF_DEG = 38.5
QUIETER = 0.1  # a scene's amplitudes are at most 1


def axis_level_db(depth_mm):
    """Of a point on the middle stick, which the rungs' amplitudes leave out and the table has."""
    rows = scan.table("point_widths", preset="standard", sector_fraction=0)
    return numpy.interp(depth_mm, [row["depth_mm"] for row in rows], [row["level_db"] for row in rows])


def points_of(rows, fraction):
    number = {key: numpy.array([row[key] for row in rows]) for key in rows[0]}
    relative = 10 ** ((axis_level_db(number["axial_mm"]) - axis_level_db(number["depth_mm"])) / 20)
    at = 1e3 * stick_points(PRESETS["standard"], fraction * HALF_DEG * DEGREE,
                            *(number[key] * 1e-3 for key in ("axial_mm", "lateral_mm", "elevation_mm")))
    return numpy.column_stack([at, QUIETER * number["amplitude"] * relative])


class Echoes(scan.Worst):
    def compare(self, name, rung, points_table, echoes_table, least):
        powers = {}
        for fraction in (0, 0.4, 0.78, 0.88, 1):
            points = points_of(scan.table(points_table, sector_fraction=fraction), fraction)
            part = "axis" if fraction == 0 else "edge"
            stick = scan.envelope(rung, scan.LOSSLESS, scan.scatterers(points),
                                  scan.grid(101, HALF_DEG / 50, 1, 0, DEPTH_MM, SAMPLES))[0, 0, 50 + round(50 * fraction)]
            for depth in (50, 75, 110, 150, 30):
                rows = scan.table(echoes_table, sector_fraction=fraction, depth_mm=depth)
                wanted = numpy.array([row["envelope"] for row in rows])
                found = numpy.interp([row["range_mm"] for row in rows], scan.ranges_mm(DEPTH_MM, SAMPLES), stick / QUIETER)
                where = f"at {depth} mm, {fraction} of the half sector"
                self.hold(f"{name}.{part}.lack_of_correlation", 1 - numpy.corrcoef(found, wanted)[0, 1], 1 - least, where)
                powers.setdefault((part, depth), []).append(numpy.mean(found ** 2) / numpy.mean(wanted ** 2))
        for (part, depth), values in powers.items():  # one place hears few parts of the beam
            self.hold(f"{name}.{part}.level_db", 0.5 * decibel(numpy.mean(values)), 0.5, f"at {depth} mm")

    def test_main_lobe(self):
        self.compare("main_lobe", scan.MAIN_LOBE, "main_lobe_points", "main_lobe_echoes", 0.95)

    def test_side_lobes(self):
        self.compare("side_lobes", scan.SIDE_LOBES, "echo_points", "echoes", 0.945)

    def test_reference(self):
        self.compare("reference", scan.REFERENCE, "echo_points", "echoes", 0.99)


if __name__ == "__main__":
    unittest.main()
