#!/usr/bin/env python3
"""The yardstick against closed forms, direct sums in time and space, and its own tables."""
import csv
import dataclasses
import math
import unittest

import numpy as np

import element_sum as es
import make_tables
from point_spread import PointSpread, full_width
from speckle import Speckle

STANDARD = es.PRESETS["standard"]
FOCUS = STANDARD.transmit_focus
# As good as one frequency: what closed forms of beams are about.
TONE = dataclasses.replace(STANDARD, bandwidth=0.01)


def tone_field(depth, theta=0.0):
    return Speckle(TONE, theta, depth, finer=2, wider=2, band=es.Band(TONE, 2, 1))


class Beam(unittest.TestCase):
    def test_element_response_is_the_sum_over_its_surface(self):
        band = es.pulse_band(STANDARD, 5)
        active = np.array([10, 64, 100])
        places = [(0.02, 0, 0), (0.025, 6e-3, 7e-3), (0.075, 3e-3, 4e-3), (0.16, -5e-3, 10e-3)]
        points = np.concatenate([es.stick_points(STANDARD, 0.2, *place) for place in places])
        response = es.element_response(STANDARD, band, points, active)
        along, up = np.meshgrid((np.arange(24) + 0.5) / 24 - 0.5, (np.arange(300) + 0.5) / 300 - 0.5)
        along, up = along * STANDARD.pitch, up * STANDARD.height
        lens = np.hypot(STANDARD.elevation_focus, up) - STANDARD.elevation_focus
        for p, point in enumerate(points):
            for e, angle in enumerate(STANDARD.element_angles[active]):
                path = np.sqrt((point[0] - STANDARD.radius * math.sin(angle) - along * math.cos(angle)) ** 2
                               + (point[1] - up) ** 2
                               + (point[2] - STANDARD.radius * math.cos(angle) + along * math.sin(angle)) ** 2)
                direct = [np.mean(np.exp(-1j * k * (path - lens)) / path) for k in band.k]
                error = np.abs(response[p, e] - direct).max() / np.abs(direct).max()
                self.assertLess(error, 0.012, (p, e))

    def test_echo_is_that_of_pulses_summed_in_time(self):
        low = dataclasses.replace(STANDARD, height=1e-3)
        band = es.Band(low, 128, 3.2, lowest=0.01)
        point = es.stick_points(low, 0.3, 0.05, 1.5e-3, 1e-3)
        gates = 0.05 + np.array([-0.4e-3, -0.1e-3, 0.0, 0.15e-3, 0.4e-3])
        active = es.active_elements(low, [0.3], gates[-1])
        response = es.element_response(low, band, point, active)
        by_frequency = np.abs(es.echoes(low, band, response, active, 0.3, gates)[0])
        by_time = np.array([self.summed_in_time(low, band, point[0], 0.3, gate) for gate in gates])
        np.testing.assert_allclose(by_frequency / by_frequency.max(), by_time / by_time.max(), atol=0.006)

    def summed_in_time(self, probe, band, point, theta, gate):
        """All pairs of sub-sources; the pulse's envelope is the closed form of its spectrum."""
        paths, weights = [], []
        for aim in (probe.transmit_focus, gate):
            share = es.share(probe, theta, aim / probe.f_number)
            used = np.flatnonzero(share)
            along, up = np.meshgrid((np.arange(6) + 0.5) / 6 - 0.5, (np.arange(8) + 0.5) / 8 - 0.5)
            along, up = along.ravel() * probe.pitch, up.ravel() * probe.height
            angle = probe.element_angles[used][:, None]
            x = probe.radius * np.sin(angle) + along * np.cos(angle)
            z = probe.radius * np.cos(angle) - along * np.sin(angle)
            path = np.sqrt((point[0] - x) ** 2 + (point[1] - up) ** 2 + (point[2] - z) ** 2)
            lens = np.hypot(probe.elevation_focus, up) - probe.elevation_focus
            aimed = es.stick_points(probe, theta, aim, 0.0, 0.0)[0]
            middle = np.hypot(aimed[0] - probe.radius * np.sin(angle), aimed[2] - probe.radius * np.cos(angle))
            paths.append((path - lens - middle + aim).ravel())
            weights.append((share[used][:, None] / path).ravel())
        late = (paths[0][:, None] + paths[1] - 2 * gate) / es.SOUND_SPEED
        half_width = probe.bandwidth * probe.centre_frequency / 2
        pulse = np.exp(-(math.pi * half_width * late) ** 2 / math.log(2) - 2j * math.pi * probe.centre_frequency * late)
        return abs(weights[0] @ pulse @ weights[1])

    def test_width_at_the_focus(self):
        """0.886 lambda F of two equal apertures. Along the array the face's curve and the elements'
        directivity narrow the aperture by a few percent."""
        x = np.linspace(-3e-3, 3e-3, 201)
        field = tone_field(FOCUS)
        across = es.stick_points(TONE, 0.0, FOCUS, x, 0.0)
        above = es.stick_points(TONE, 0.0, FOCUS, 0.0, x)
        for points, f_number, excess in ((across, TONE.f_number, 0.05), (above, FOCUS / TONE.height, 0.0)):
            width = full_width(x, np.abs(field.two_way(points, [0.0])[0, 0]))
            closed_form = 0.886 * TONE.wavelength * f_number
            self.assertAlmostEqual(width / closed_form, 1 + excess, delta=0.02)

    def test_axial_width_is_the_pulse_s(self):
        self.assertAlmostEqual(STANDARD.axial_fwhm, 0.8825 * 770 / (0.6 * 3.5e6), delta=1e-7)
        self.assertAlmostEqual(PointSpread(STANDARD, 0.0, FOCUS).axial_width() / STANDARD.axial_fwhm, 1, delta=0.03)

    def test_power_through_a_plane_is_the_same_at_each_depth(self):
        powers = [self.power_through(depth) for depth in (40e-3, 75e-3, 110e-3)]
        np.testing.assert_allclose(powers, powers[0], rtol=0.03)

    def power_through(self, depth):
        """Of the transmit wave at one frequency, on the sphere about the middle of the face."""
        band = es.Band(TONE, 2, 1)
        active = es.active_elements(TONE, [0.0], FOCUS)
        x, y = np.meshgrid(np.linspace(-0.35, 0.35, 141), np.arange(0.0025, 0.25, 0.005), indexing="ij")
        x, y = x.ravel(), y.ravel()
        axial = depth * np.sqrt(1 - x ** 2 - y ** 2)
        points = es.stick_points(TONE, 0.0, axial, depth * x, depth * y)
        total = 0.0
        for some, cosine in zip(np.array_split(points, 20), np.array_split(axial / depth, 20)):
            response = es.element_response(TONE, band, some, active)[..., 0]
            field = response @ es.transmit(TONE, band, 0.0)[active, 0]
            total += np.sum(np.abs(field) ** 2 / cosine)
        return total * depth ** 2


class SpeckleField(unittest.TestCase):
    def test_elevation_correlation_at_the_focus(self):
        """There the two-way response across is sinc^2, whose spectrum is a triangle: the field's
        correlation is the transform of the triangle's square."""
        u = np.linspace(0, 1, 4001)
        spacing = TONE.wavelength * FOCUS / TONE.height
        for lag in (0.3, 0.5, 0.7):
            field = np.trapz((1 - u) ** 2 * np.cos(2 * math.pi * u * lag), u) * 3
            motor = lag * spacing / es.motor_lever(TONE, 0.0, FOCUS)
            self.assertAlmostEqual(tone_field(FOCUS).elevation_correlation(motor), field ** 2, delta=0.01)

    def test_axial_width_is_the_pulse_s(self):
        """|pulse spectrum|^2 of a Gaussian gives the width of its envelope again."""
        width = Speckle(STANDARD, 0.0, FOCUS).axial_width()
        self.assertAlmostEqual(width / STANDARD.axial_fwhm, 1, delta=0.04)

    def test_power_at_the_focus_falls_as_the_square_of_frequency(self):
        """In focus the two-way beam of each frequency is the same function of place times frequency. Narrow
        elements send all frequencies alike."""
        probe = dataclasses.replace(STANDARD, elements=512, pitch=STANDARD.pitch / 4)
        band = es.Band(probe, 12, 2.0)
        field = Speckle(probe, 0.0, probe.transmit_focus, wider=1.5, band=band)
        constant = field.power_spectrum() / field.pulse_power * band.f ** 2
        np.testing.assert_allclose(constant / constant.mean(), 1, atol=0.05)

    def test_speckle_stays_where_nothing_moves_and_changes_the_more_the_farther(self):
        field = Speckle(STANDARD, 0.0, 46e-3)
        near, far = (field.moved_correlation(shift) for shift in (1e-3, 4e-3))
        self.assertAlmostEqual(field.moved_correlation(0), 1)
        self.assertLess(near, 1)
        self.assertLess(far, near - 0.02)

    def test_parseval_is_the_integral_over_range(self):
        depth, band = 60e-3, es.Band(STANDARD, 44, 2.3)
        field = Speckle(STANDARD, 0.0, depth)
        lag = 0.3 * field.elevation_cell / es.motor_lever(STANDARD, 0.0, depth)
        active = es.active_elements(STANDARD, [0.0], depth)
        points = field.plane(field.elevation)
        products = np.zeros(2, complex)
        for z in np.arange(-1.5e-3, 1.5e-3, 0.12e-3):
            moved = points + [0, 0, z]
            turned = es.seen_by_turned_probe(STANDARD, moved, lag / 2)
            one = es.echoes(STANDARD, band, es.element_response(STANDARD, band, turned, active), active,
                            0.0, [depth])[:, 0]
            other = one.reshape(len(field.lateral), -1)[:, ::-1].ravel()
            products += [np.vdot(one, other), np.vdot(one, one)]
        direct = abs(products[0] / products[1]) ** 2
        self.assertAlmostEqual(field.elevation_correlation(lag), direct, delta=0.01)


class Tables(unittest.TestCase):
    SAMPLE = {"point_widths": [("standard", 0, 75), ("c5_2v", 0.88, 60)],
              "speckle": [("standard", 0.88, 75), ("curvilinear_60", 0, 60)],
              "neighbours": [(75,)], "moved": [(62,)], "attenuation": [(0.5, 75)],
              "short_arrays": [(16, 6, 75)], "wide_elements": [(2, 140)],
              "tissue_band": [("standard", 0, 60), ("c5_2v", 1, 30)], "shadow": [("lateral", 130)],
              "stick_beam": [("standard", 1.0, 30)], "echo_points": [(7, 0.4, 75)], "echoes": [(7, 0.4, 75)],
              "main_lobe_points": [(7, 0.4, 75)], "main_lobe_echoes": [(7, 0.4, 75)]}

    def test_rows_are_remade_equal(self):
        self.assertEqual(self.SAMPLE.keys(), make_tables.TABLES.keys())
        for name, cases in self.SAMPLE.items():
            for case in cases:
                with self.subTest(table=name, case=case):
                    self.assert_remade(name, case)

    def assert_remade(self, name, case):
        key = [make_tables.text(value) for value in case]
        with open(make_tables.HERE / f"{name}.csv", encoding="utf-8") as file:
            kept = [row for row in csv.reader(file) if row[:len(key)] == key]
        made = [line.split(",") for line in make_tables.TABLES[name].lines(case)]
        numbers = [[[float(value) for value in row[len(key):]] for row in rows] for rows in (kept, made)]
        np.testing.assert_allclose(*numbers, rtol=2e-4, atol=1e-6)

    def test_every_case_is_kept(self):
        for name, table in make_tables.TABLES.items():
            with open(make_tables.HERE / f"{name}.csv", encoding="utf-8") as file:
                about, head, *rows = csv.reader(file)
            self.assertTrue(about[0].startswith("# tests/yardstick/make_tables.py"), name)
            self.assertEqual(tuple(head), table.keys + table.columns)
            kept = {tuple(row[:len(table.keys)]) for row in rows}
            self.assertEqual(kept, {tuple(map(make_tables.text, case)) for case in table.cases}, name)


if __name__ == "__main__":
    unittest.main()
