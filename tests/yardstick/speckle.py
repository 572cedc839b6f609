"""Second-order figures of speckle, from the sum over elements."""
import math

import numpy as np

import element_sum as es


class Speckle:
    """Second-order figures of fully developed speckle about a gate of a stick, by quadrature.

    The field correlation of two sticks is the integral of h1 conj(h2) over the scatterers' places. Over
    range it is taken by Parseval: the response to a place is a sum over frequencies whose terms change
    in range by exp(-2 i k range) and, within a pulse's length, by little else; so it is the sum over
    frequencies of |pulse|^2 A1 conj(A2), A being the two-way sums at the gate's own range. Across range
    the full plane, lateral by elevation, is summed on a lattice finer than the two-way aperture's
    Nyquist spacing, on which the sum of a band-limited product is its integral.
    """

    def __init__(self, probe, theta, depth, finer=1.0, wider=1.0, band=None):
        self.probe, self.theta, self.depth = probe, theta, depth
        self.band = band or es.power_band(probe)
        self.pulse_power = self.band.amplitude ** 2
        sent, got = (es.share(probe, theta, r / probe.f_number).sum() * probe.pitch
                     for r in (probe.transmit_focus, depth))
        top = probe.centre_frequency * (1 + probe.bandwidth / 2)
        reach = es.SOUND_SPEED / top * depth  # Nyquist spacing times aperture
        self.lateral_cell = probe.wavelength * depth / min(sent, got)
        self.elevation_cell = probe.wavelength * depth / probe.height
        geometric = probe.transmit_focus / probe.f_number / 2 * abs(1 - depth / probe.transmit_focus)
        long_wave = es.SOUND_SPEED / (probe.centre_frequency * (1 - probe.bandwidth / 3)) * depth
        lateral = min(8 * long_wave / got, geometric + 3.5 * long_wave / sent)
        elevation = (probe.height / 2 * abs(1 - depth / probe.elevation_focus) + 3 * long_wave / probe.height)
        self.lateral = lattice(wider * lateral, 0.85 / finer * reach / (sent + got))
        self.elevation = lattice(wider * elevation, 0.85 / finer * reach / (2 * probe.height))
        self.cell_area = np.diff(self.lateral[:2])[0] * np.diff(self.elevation[:2])[0]

    def plane(self, elevations):
        x, y = np.meshgrid(self.lateral, elevations, indexing="ij")
        return es.stick_points(self.probe, self.theta, self.depth, x.ravel(), y.ravel())

    def two_way(self, points, thetas):
        """Two-way sums of sticks of one frame: (frequencies, sticks, points)."""
        active = es.active_elements(self.probe, thetas, self.depth)
        weights = [np.stack([one(theta)[active] for theta in thetas]).transpose(2, 0, 1) for one in (
            lambda t: es.transmit(self.probe, self.band, t),
            lambda t: es.receive(self.probe, self.band, t, self.depth))]
        parts = []
        for some in np.array_split(points, 1 + len(points) // 200):
            response = np.ascontiguousarray(es.element_response(self.probe, self.band, some, active).transpose(2, 1, 0))
            parts.append((weights[0] @ response) * (weights[1] @ response))
        return np.concatenate(parts, -1)

    def power_spectrum(self):
        """Of the echo of scatterers of unit power in a cubic metre, by frequency."""
        half = self.elevation[self.elevation > 0]  # the other half mirrors it
        sums = self.two_way(self.plane(half), [self.theta])[:, 0]
        return 2 * self.pulse_power * np.sum(np.abs(sums) ** 2, -1) * self.cell_area

    def lateral_correlation(self, lags):
        """Intensity correlation of sticks that far apart, angles."""
        half = self.elevation[self.elevation > 0]
        thetas = [self.theta + s * lag / 2 for lag in lags for s in (1, -1)]
        sums = self.two_way(self.plane(half), thetas)
        return np.array([self.correlation(sums[:, 2 * i], sums[:, 2 * i + 1]) for i in range(len(lags))])

    def elevation_correlation(self, lag):
        """Intensity correlation of frames that far apart, motor angle. Turned the other way, the probe
        sees the mirror image."""
        points = es.seen_by_turned_probe(self.probe, self.plane(self.elevation), lag / 2)
        sums = self.two_way(points, [self.theta])[:, 0]
        mirrored = sums.reshape(len(self.band.f), len(self.lateral), -1)[:, :, ::-1]
        return self.correlation(sums, mirrored.reshape(sums.shape))

    def moved_correlation(self, shift):
        """Intensity correlation of a gate with the one `shift` farther, before and after the tissue has
        moved along the stick by so much: half of it to either side of this depth."""
        half = self.elevation[self.elevation > 0]
        middle, sums = self.depth, []
        for self.depth in (middle - shift / 2, middle + shift / 2):
            phase = np.exp(2j * self.band.k * self.depth)[:, None]
            sums.append(phase * self.two_way(self.plane(half), [self.theta])[:, 0])
        self.depth = middle
        return self.correlation(*sums)

    def correlation(self, one, other):
        def product(a, b):
            return np.sum(self.pulse_power[:, None] * a * np.conj(b))
        return abs(product(one, other)) ** 2 / (product(one, one) * product(other, other)).real

    def lateral_width(self):
        lags = np.linspace(0.04, 1.6, 40) * self.lateral_cell / (self.probe.radius + self.depth)
        values = self.lateral_correlation(lags)
        return 2 * half_crossing(lags, values) * (self.probe.radius + self.depth)

    def elevation_width(self):
        lever = es.motor_lever(self.probe, self.theta, self.depth)
        lag = 0.4 * self.elevation_cell / lever
        for _ in range(3):  # each step supposes a Gaussian
            value = self.elevation_correlation(lag)
            lag *= math.sqrt(math.log(2) / -math.log(value))
        return 2 * lag * lever

    def axial_width(self, spectrum=None):
        spectrum = self.power_spectrum() if spectrum is None else spectrum
        lags = np.linspace(0, 1.5 * self.probe.axial_fwhm, 301)
        field = np.abs(np.exp(2j * np.outer(lags, self.band.k)) @ spectrum) ** 2
        return 2 * half_crossing(lags, field / field[0])


def lattice(half_span, spacing):
    """Even and symmetric about 0, which it leaves out."""
    count = max(4, math.ceil(half_span / spacing))
    return (np.arange(2 * count) + 0.5 - count) * half_span / count


def half_crossing(lags, values):
    """First lag where the values fall below a half, between two as a Gaussian goes."""
    i = int(np.argmax(values < 0.5))
    if values[i] >= 0.5 or i == 0:
        raise ValueError("the correlation does not cross a half between two of the lags")
    squares, logs = lags[i - 1:i + 1] ** 2, np.log(values[i - 1:i + 1])
    return math.sqrt(np.interp(math.log(2), -logs, squares))
