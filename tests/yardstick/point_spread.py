"""-6 dB widths and peak of a point's echo, from the sum over elements."""
import math

import numpy as np

import element_sum as es


class Wider(Exception):
    """The curve does not fall to its level within its span."""


def full_width(x, y, level=0.5):
    """Distance between the first places on either side of the maximum where y falls to `level` of it."""
    peak = int(np.argmax(y))
    target = level * y[peak]
    ends = []
    for step in (-1, 1):
        i = peak
        while y[i] > target:
            i += step
            if i < 0 or i >= len(y):
                raise Wider
        ends.append(x[i] + (target - y[i]) * (x[i - step] - x[i]) / (y[i - step] - y[i]))
    return abs(ends[1] - ends[0])


def peak_of_samples(envelope):
    """Maximum of each row, through the logarithms of the highest sample and its neighbours."""
    at = np.clip(envelope.argmax(-1), 1, envelope.shape[-1] - 2)[..., None]
    left, mid, right = (np.log(np.take_along_axis(envelope, at + d, -1)[..., 0] + 1e-300) for d in (-1, 0, 1))
    bend = np.minimum(left - 2 * mid + right, -1e-12)
    inside = mid > np.maximum(left, right)  # not where the window ends, or nothing echoes
    return np.where(inside, np.exp(mid - inside * (left - right) ** 2 / 8 / bend), envelope.max(-1))



class PointSpread:
    """A point on a stick's axis, as sticks and frames that turn past it show it."""

    def __init__(self, probe, theta, depth, loss=None, band=None):
        """`loss(f, depth)`: two-way amplitude factor of the path, 1 where none is given."""
        self.probe, self.theta, self.depth = probe, theta, depth
        self.band = band or es.pulse_band(probe)
        self.spectrum = self.band.amplitude * (1 if loss is None else loss(self.band.f, depth))
        self.point = es.stick_points(probe, theta, depth, 0.0, 0.0)
        reach = 2.4e-3 if depth < 55e-3 else 1.5e-3  # near the face the transmit wave comes spread
        count = 2 * math.ceil(reach / (probe.axial_fwhm / 4)) + 1
        self.gates = depth + (np.arange(count) - count // 2) * probe.axial_fwhm / 4

    def echo(self, points, theta, gates):
        active = es.active_elements(self.probe, [theta], gates[-1])
        if not len(active):  # the stick lies beyond the array by more than half its aperture
            return np.zeros((len(points), len(gates)))
        response = es.element_response(self.probe, self.band, points, active)
        return np.abs(es.echoes(self.probe, self.band, response, active, theta, gates, self.spectrum))

    def axial_width(self):
        step = self.probe.axial_fwhm / 20
        gates = self.depth + np.arange(-2.4e-3, 2.4e-3, step)
        return full_width(gates, self.echo(self.point, self.theta, gates)[0])

    def peak(self):
        return float(peak_of_samples(self.echo(self.point, self.theta, self.gates))[0])

    def lateral_curve(self, offsets):
        """Peak echo as sticks pass the point at `offsets`, lengths at its range."""
        turns = offsets / (self.probe.radius + self.depth)
        return np.array([peak_of_samples(self.echo(self.point, self.theta + t, self.gates))[0] for t in turns])

    def beam_curve(self, offsets):
        """Peak echo of points at `offsets` across the stick, which stays where it is."""
        points = es.stick_points(self.probe, self.theta, self.depth, offsets, 0.0)
        return peak_of_samples(self.echo(points, self.theta, self.gates))

    def elevation_curve(self, offsets):
        """Peak echo as frames pass the point at `offsets`."""
        lever = es.motor_lever(self.probe, self.theta, self.depth)
        points = np.concatenate([es.seen_by_turned_probe(self.probe, self.point, o / lever) for o in offsets])
        return peak_of_samples(self.echo(points, self.theta, self.gates))

    def lateral_width(self):
        return width_of(self.lateral_curve, self.lateral_span())

    def beam_width(self):
        return width_of(self.beam_curve, self.lateral_span())

    def lateral_span(self):
        used = es.share(self.probe, self.theta, self.probe.transmit_focus / self.probe.f_number).sum()
        cell = self.probe.wavelength * max(self.depth, 40e-3) / (used * self.probe.pitch)
        return 1.5 * cell + 1.5e-3

    def elevation_width(self):
        probe = self.probe
        spread = probe.height / 2 * abs(1 - self.depth / probe.elevation_focus)
        return width_of(self.elevation_curve, probe.wavelength * self.depth / probe.height + spread)


def width_of(curve, half_span, count=49):
    """-6 dB width of a curve, over a span that grows until it holds the width and fits it."""
    for _ in range(6):
        offsets = np.linspace(-half_span, half_span, count)
        try:
            width = full_width(offsets, curve(offsets))
        except Wider:
            half_span *= 1.6
            continue
        if width > 0.4 * half_span:
            return width
        half_span = width
    raise ValueError("no width found")
