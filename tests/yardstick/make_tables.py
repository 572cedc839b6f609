#!/usr/bin/env python3
"""Writes the tables of the yardstick beside this script: make_tables.py [--only NAME]..."""
import argparse
import dataclasses
import functools
import math
import multiprocessing
import os
import pathlib
import random

import numpy as np

import element_sum as es
import shadow
from point_spread import PointSpread, peak_of_samples
from speckle import Speckle

HERE = pathlib.Path(__file__).parent
DEPTHS_MM = (20, 30, 40, 50, 60, 75, 90, 110, 130, 150, 160)
MOVED_MM = 1.40625  # eight samples of 512 over 90 mm
FRACTIONS = {"standard": (0, 0.4, 0.78, 0.88, 1.0), "c5_2v": (0, 0.78, 0.88, 1.0),
             "curvilinear_60": (0, 0.78, 0.88, 1.0)}
PLACES = [(f, d) for f in FRACTIONS["standard"] for d in (30, 50, 75, 110, 150)]  # of the echoes
POINTS_PER_PLACE = 40


class Table:
    """A CSV file: `rows(case)` gives the rows, of numbers or text, that follow the case's own fields."""

    def __init__(self, about, keys, columns, cases, rows):
        self.about, self.keys, self.columns = about, keys, columns
        self.cases, self.rows = cases, rows

    def lines(self, case):
        return [",".join(text(value) for value in (*case, *row)) for row in self.rows(*case)]


def text(value):
    return value if isinstance(value, str) else f"{value:.5g}"


def decibel(ratio):
    return 20 * math.log10(ratio)


def stick_angle(preset, fraction):
    return fraction * es.PRESETS[preset].sector / 2


def every_stick():
    return [(preset, fraction, depth) for preset, fractions in FRACTIONS.items()
            for fraction in fractions for depth in DEPTHS_MM]


@functools.lru_cache(None)
def reference_peak(preset):
    probe = es.PRESETS[preset]
    return PointSpread(probe, 0.0, probe.transmit_focus).peak()


def point_widths(preset, fraction, depth_mm):
    theta = stick_angle(preset, fraction)
    spread = PointSpread(es.PRESETS[preset], theta, depth_mm * 1e-3)
    return [(theta / es.DEGREE, spread.lateral_width() * 1e3, spread.elevation_width() * 1e3,
             spread.axial_width() * 1e3, decibel(spread.peak() / reference_peak(preset)))]


def stick_beam(preset, fraction, depth_mm):
    theta = stick_angle(preset, fraction)
    return [(theta / es.DEGREE, PointSpread(es.PRESETS[preset], theta, depth_mm * 1e-3).beam_width() * 1e3)]


@functools.lru_cache(None)
def reference_power(preset):
    probe = es.PRESETS[preset]
    return Speckle(probe, 0.0, probe.transmit_focus).power_spectrum().sum()


def speckle(preset, fraction, depth_mm):
    theta = stick_angle(preset, fraction)
    field = Speckle(es.PRESETS[preset], theta, depth_mm * 1e-3)
    spectrum = field.power_spectrum()
    return [(theta / es.DEGREE, field.lateral_width() * 1e3, field.elevation_width() * 1e3,
             field.axial_width(spectrum) * 1e3, decibel(spectrum.sum() / reference_power(preset)) / 2)]


def neighbours(depth_mm):
    probe, depth = es.PRESETS["standard"], depth_mm * 1e-3
    line, frame = 77 * es.DEGREE / 63, 61 * es.DEGREE / 36
    field = Speckle(probe, 0.0, depth, wider=1.2)
    return [(line * (probe.radius + depth) * 1e3, field.lateral_correlation([line])[0],
             frame * es.motor_lever(probe, 0.0, depth) * 1e3, field.elevation_correlation(frame))]


def moved(depth_mm):
    scene = Speckle(es.PRESETS["standard"], 0.0, depth_mm * 1e-3)
    return [(scene.moved_correlation(MOVED_MM * 1e-3),)]


def attenuation(alpha, depth_mm):
    probe, depth = es.PRESETS["standard"], depth_mm * 1e-3
    band = es.Band(probe, 90, 3.3)  # wider than others: the echo's centre falls far

    def loss(f, r):
        return 10 ** (-2 * alpha * f * 1e-6 * r * 1e2 / 20)

    spread = PointSpread(probe, 0.0, depth, loss, band)
    active = es.active_elements(probe, [0.0], depth)
    response = es.element_response(probe, band, spread.point, active)[0]
    echo = spread.spectrum.copy()
    for weights in (es.transmit(probe, band, 0.0), es.receive(probe, band, 0.0, depth)):
        echo = echo * np.sum(response * weights[active], 0)
    power = np.abs(echo) ** 2
    return [(decibel(spread.peak() / PointSpread(probe, 0.0, depth, band=band).peak()),
             decibel(loss(probe.centre_frequency, depth)), np.sum(power * band.f) / np.sum(power) * 1e-6,
             spread.axial_width() * 1e3, spread.lateral_width() * 1e3, spread.elevation_width() * 1e3)]


def short_arrays(elements, angle_deg, depth_mm):
    probe = dataclasses.replace(es.PRESETS["standard"], elements=elements)
    echo, middle = (PointSpread(probe, angle * es.DEGREE, depth_mm * 1e-3).peak() for angle in (angle_deg, 0))
    return [(decibel(echo / middle),)]


def wide_elements(pitch_mm, depth_mm):
    standard = es.PRESETS["standard"]
    elements = round(standard.elements * standard.pitch / (pitch_mm * 1e-3))
    probe = dataclasses.replace(standard, pitch=pitch_mm * 1e-3, elements=elements)
    return [(elements, PointSpread(probe, 0.0, depth_mm * 1e-3).beam_width() * 1e3)]


def tissue_band(preset, fraction, depth_mm):
    probe = es.PRESETS[preset]
    band = es.Band(probe, 72, 3.3)
    field = Speckle(probe, stick_angle(preset, fraction), depth_mm * 1e-3, wider=1.5, band=band)
    power = field.power_spectrum()
    return [(f * 1e-6, share) for f, share in zip(band.f, power / power.sum())]


def half_plane(edge, depth_mm):
    crossings = np.arange(-24, 25) * 0.5e-3
    across = {"lateral": shadow.across_lines, "elevation": shadow.across_frames}[edge]
    power = across(es.PRESETS["standard"], depth_mm * 1e-3, crossings)
    rise = shadow.rise_width(crossings, power)
    return [(x * 1e3, decibel(p) / 2, rise * 1e3) for x, p in zip(crossings, power)]


def random_points(place, lateral, elevation, draw):
    """Axial, lateral, elevation in mm and amplitude, rounded as the table has them."""
    depth = PLACES[place][1]
    draw = random.Random(f"{draw} {place}")
    return [(round(depth + draw.uniform(-1.5, 1.5), 3), round(draw.uniform(-lateral, lateral), 3),
             round(draw.uniform(-elevation, elevation), 3), round(draw.uniform(0.2, 1) * draw.choice((-1, 1)), 3))
            for _ in range(POINTS_PER_PLACE)]


def echo_points(place, fraction, depth_mm):
    return random_points(place, 6, 5, "yardstick")


def main_lobe_points(place, fraction, depth_mm):
    """In the rectangle within the ellipse whose half axes are 0.8 of the ways to the first zeros of the
    focused beam, range times wavelength over aperture."""
    probe = es.PRESETS["standard"]
    inside = 0.8 / math.sqrt(2) * probe.wavelength * 1e3
    return random_points(place, inside * probe.f_number, inside * depth_mm * 1e-3 / probe.height, "main lobe")


def echo_envelope(points_of, place, fraction, depth_mm):
    probe = es.PRESETS["standard"]
    theta, depth = stick_angle("standard", fraction), depth_mm * 1e-3
    axial, lateral, elevation, amplitude = np.array(points_of(place, fraction, depth_mm)).T
    points = es.stick_points(probe, theta, axial * 1e-3, lateral * 1e-3, elevation * 1e-3)
    band = es.pulse_band(probe, 80)
    gates = depth + np.linspace(-2.5e-3, 2.5e-3, 64)
    active = es.active_elements(probe, [theta], gates[-1])
    response = es.element_response(probe, band, points, active)
    envelope = np.abs(amplitude @ es.echoes(probe, band, response, active, theta, gates))
    one = PointSpread(probe, 0.0, depth, band=band).peak()
    return [(f"{g * 1e3:.4f}", e / one) for g, e in zip(gates, envelope)]


def echo_point_table(which, points_of):
    return Table(f"Standard probe: {which}, in their stick's coordinates: axial: range from the face "
        "along the stick, lateral: across it towards larger stick angles, elevation: towards +y of the "
        "probe frame (smaller motor angles), straight lengths; amplitude: echo factor of a point",
        ("place", "sector_fraction", "depth_mm"), ("axial_mm", "lateral_mm", "elevation_mm", "amplitude"),
        [(i, *place) for i, place in enumerate(PLACES)], points_of)


def echo_table(points_of):
    return Table("Standard probe: envelope of the summed echo of a place's points on the stick at sector_fraction x "
        "38.5 deg, motor at rest, re the envelope's peak for one point of amplitude 1 on the middle "
        "stick's axis at depth_mm", ("place", "sector_fraction", "depth_mm"), ("range_mm", "envelope"),
        [(i, *place) for i, place in enumerate(PLACES)], functools.partial(echo_envelope, points_of))


TABLES = {"point_widths": Table(
        "A point on a stick's axis: -6 dB full widths of the peak envelope as sticks (lateral) and frames "
        "(elevation) turn past it, and of the echo along the stick (axial), each between the first places "
        "on either side of the maximum; level of its echo on that stick re the preset's axis at 75 mm; "
        "no frequency below 0.2 of the centre's", ("preset", "sector_fraction", "depth_mm"),
        ("theta_deg", "lateral_mm", "elevation_mm", "axial_mm", "level_db"), every_stick(), point_widths),
    "stick_beam": Table(
        "Width of a stick's own beam: -6 dB full width of the peak envelope of points at offsets across a "
        "stick that stays where it is. It is that of point_widths.csv where neighbouring sticks have the same "
        "aperture, and narrower towards the array's end, where each stick has another",
        ("preset", "sector_fraction", "depth_mm"), ("theta_deg", "lateral_mm"), every_stick(), stick_beam),
    "speckle": Table(
        "Fully developed speckle: full width at half maximum of the intensity autocovariance across lines, "
        "frames and range; mean echo power re the preset's axis at 75 mm; no frequency below "
        "0.2 of the centre's: matters to curvilinear_60, whose widths depend on it by a tenth",
        ("preset", "sector_fraction", "depth_mm"),
        ("theta_deg", "lateral_mm", "elevation_mm", "axial_mm", "level_db"), every_stick(), speckle),
    "neighbours": Table(
        "Speckle of the default scan, middle stick, standard probe: intensity correlation of neighbouring "
        "lines (77 deg / 63 apart) and frames (61 deg / 36)",
        ("depth_mm",), ("line_spacing_mm", "line_correlation", "frame_spacing_mm", "frame_correlation"),
        [(depth,) for depth in DEPTHS_MM], neighbours), "moved": Table(
        "Standard probe, middle stick: intensity correlation of tissue's speckle before and after it has "
        f"moved {MOVED_MM} mm along the stick",
        ("depth_mm",), ("correlation",), [(depth,) for depth in range(46, 85, 4)], moved), "attenuation": Table(
        "Standard probe, axis, all tissue attenuating: echo of a point re none, closed form of the loss at "
        "3.5 MHz alone, centroid of the echo's power spectrum, -6 dB widths as in point_widths.csv",
        ("alpha_db_cm_mhz", "depth_mm"),
        ("level_db", "centre_frequency_loss_db", "centre_mhz", "axial_mm", "lateral_mm", "elevation_mm"),
        [(alpha, depth) for alpha in (0, 0.3, 0.5, 1.0) for depth in DEPTHS_MM], attenuation), "short_arrays": Table(
        "Standard probe with fewer elements, an array shorter than the aperture that the F-number asks for: echo "
        "of a point on the axis of the stick at an angle re the middle stick's at the same depth. All elements "
        "within that length about the stick are used", ("elements", "angle_deg", "depth_mm"), ("level_db",),
        [(elements, angle, depth) for elements in (1, 16, 32) for angle in (2, 6) for depth in (75, 110, 150)],
        short_arrays), "wide_elements": Table(
        "Standard probe with wider and fewer elements: width of the middle stick's own beam, as in stick_beam.csv",
        ("pitch_mm", "depth_mm"), ("elements", "lateral_mm"),
        [(pitch, depth) for pitch in (0.84, 1.3, 2) for depth in (60, 100, 140)], wide_elements), "tissue_band": Table(
        "Even tissue without losses: the share of each of 72 evenly spaced frequencies in the mean echo power of "
        "a stick. Losses that grow with frequency multiply each share by its own; their sum is the power that "
        "is left. No frequency below 0.2 of the centre's", ("preset", "sector_fraction", "depth_mm"), ("mhz", "share"),
        [(preset, fraction, depth) for preset in es.PRESETS
         for fraction, depths in ((0, (20, 30, 40, 60, 80, 100, 120, 140)), (1, (30, 60, 100, 140))) for depth in depths],
        tissue_band), "shadow": Table(
        "Standard probe: mean echo power of even tissue re no plane, behind a half plane at 60 mm that "
        "passes 0.1 of the amplitude each way and lies at lateral > 0 (or elevation > 0); crossing: where "
        "the stick's axis meets the plane, from its edge; rise: 10-90 % of amplitude, same for the block",
        ("edge", "depth_mm"), ("crossing_mm", "power_db", "rise_mm"),
        [(edge, depth) for edge in ("lateral", "elevation") for depth in (65, 75, 80, 100, 130)], half_plane),
    "echo_points": echo_point_table(
        "points of echoes.csv, within 6 mm across the stick and 5 mm across the image plane", echo_points),
    "echoes": echo_table(echo_points), "main_lobe_points": echo_point_table(
        "points of main_lobe_echoes.csv, within 0.57 of the ways to the first zeros of the focused beam",
        main_lobe_points), "main_lobe_echoes": echo_table(main_lobe_points)}


def lines_of(job):
    name, case = job
    return TABLES[name].lines(case)


def write(name, pool):
    table = TABLES[name]
    parts = pool.map(lines_of, [(name, case) for case in table.cases], chunksize=1)
    head = [f"# tests/yardstick/make_tables.py: {table.about}.", ",".join(table.keys + table.columns)]
    (HERE / f"{name}.csv").write_text("\n".join(head + sum(parts, [])) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", action="append", choices=sorted(TABLES), metavar="NAME",
                        help="one of " + ", ".join(TABLES))
    names = parser.parse_args().only or list(TABLES)
    with multiprocessing.Pool(os.cpu_count()) as pool:
        for name in names:
            write(name, pool)


if __name__ == "__main__":
    main()
