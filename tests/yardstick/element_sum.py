"""Echoes of point scatterers by a direct sum over a convex probe's elements, frequency by frequency.

Linear acoustics as in textbooks (Field II's principle): every place of the face sends a spherical wave, a
scatterer sends one back, and transmit and receive sums multiply at each frequency. Written apart from the
simulator that it judges: it shares no code and no formula with it.

Frames: the probe's own is that of docs/units.md (origin at the centre of curvature, x along the array, z
into the body). A stick's coordinates are axial (range from the face), lateral (towards larger stick
angles) and elevation (probe's +y). Lengths in m, frequencies in Hz, angles in rad.

What is assumed: elements as wide as the pitch, without obliquity factor; apertures are arc lengths of the
face, unapodised, an element counts by its share within them; the lens adds to each height the path that
focuses it; points see one element's width from afar (a plane wave), everything else exactly.
"""
import dataclasses
import math

import numpy as np

SOUND_SPEED = 1540.0
DEGREE = math.pi / 180


@dataclasses.dataclass(frozen=True)
class Probe:
    radius: float = 40e-3
    wobble_radius: float = 27e-3
    centre_frequency: float = 3.5e6
    bandwidth: float = 0.6  # -6 dB of the two-way amplitude spectrum, over the centre frequency
    f_number: float = 4.0
    transmit_focus: float = 75e-3
    elements: int = 128
    pitch: float = 0.42e-3
    height: float = 13.5e-3
    elevation_focus: float = 75e-3
    sector: float = 77 * DEGREE

    @property
    def wavelength(self):
        return SOUND_SPEED / self.centre_frequency

    @property
    def axial_fwhm(self):
        """Full width at half maximum of the pulse's envelope, in range: closed form of a Gaussian."""
        return SOUND_SPEED / 2 * 4 * math.log(2) / math.pi / (self.bandwidth * self.centre_frequency)

    @property
    def element_angles(self):
        return (np.arange(self.elements) - (self.elements - 1) / 2) * self.pitch / self.radius


def with_own_sector(**fields):
    probe = Probe(**fields)
    return dataclasses.replace(probe, sector=(probe.elements - 1) * probe.pitch / probe.radius)


PRESETS = {"standard": Probe(),
    "c5_2v": with_own_sector(radius=49.57e-3, centre_frequency=3.57e6, bandwidth=0.79, pitch=0.508e-3,
                             elevation_focus=60e-3),
    "curvilinear_60": with_own_sector(radius=60e-3, centre_frequency=3.0e6, bandwidth=1.0,
                                      pitch=0.477e-3, height=14e-3, elevation_focus=50e-3)}


class Band:
    """Evenly spaced frequencies and the pulse's amplitude there."""

    def __init__(self, probe, count, reach, lowest=0.2):
        """`reach`: half the band, in units of the half width at half amplitude.

        No probe passes frequencies near 0 as its Gaussian would, and there beams are so wide that they
        would rule speckle: none below `lowest` centre frequencies. That is -43 dB of the standard probe's
        pulse, but -15 dB of curvilinear_60's.
        """
        half_width = probe.bandwidth * probe.centre_frequency / 2
        low = max(probe.centre_frequency - reach * half_width, lowest * probe.centre_frequency)
        high = probe.centre_frequency + reach * half_width
        self.f = low + (np.arange(count) + 0.5) * (high - low) / count
        self.amplitude = np.exp(-math.log(2) * ((self.f - probe.centre_frequency) / half_width) ** 2)
        self.k = 2 * math.pi * self.f / SOUND_SPEED

    def phases(self, path):
        """exp(-i k path) for each frequency, which comes last. By multiplication: k is even."""
        step = np.exp(-1j * (self.k[1] - self.k[0]) * path)
        out = np.empty(path.shape + self.k.shape, complex)
        out[..., 0] = np.exp(-1j * self.k[0] * path)
        for i in range(1, len(self.k)):
            np.multiply(out[..., i - 1], step, out=out[..., i])
        return out


def pulse_band(probe, count=64):
    return Band(probe, count, 2.6)  # to 2 ** -6.8, -41 dB


def power_band(probe, count=16):
    """For integrals of the power spectrum, which is narrower and leaves no range to alias."""
    return Band(probe, count, 2.3)  # to -64 dB of power


def stick_points(probe, theta, axial, lateral, elevation):
    """Probe frame of places in the coordinates of the stick at `theta`; shape (points, 3)."""
    axial, lateral, elevation = np.broadcast_arrays(axial, lateral, elevation)
    r = probe.radius + axial
    return np.stack([r * math.sin(theta) + lateral * math.cos(theta), elevation,
                     r * math.cos(theta) - lateral * math.sin(theta)], -1).reshape(-1, 3)


def seen_by_turned_probe(probe, points, phi):
    """Points of the probe frame at rest, in that of the probe turned about the motor axis by `phi`."""
    z_axis = probe.radius - probe.wobble_radius
    y, z = points[:, 1], points[:, 2] - z_axis
    return np.stack([points[:, 0], y * math.cos(phi) + z * math.sin(phi),
                     z_axis + z * math.cos(phi) - y * math.sin(phi)], -1)


def motor_lever(probe, theta, axial):
    """How far a place on the stick's axis moves in elevation for a radian of the motor."""
    return (probe.radius + axial) * math.cos(theta) - (probe.radius - probe.wobble_radius)


def height_response(probe, band, rho, y, transparency=None):
    """Mean over an element's height of exp(-i k (path - rho)) / path, lens included.

    rho: in-plane distances, shape (points, nodes); y: elevations (points). Exact for any element: the
    height's contribution depends on the element through rho alone. `transparency`, of shape
    broadcastable to (points, nodes, heights), multiplies each ray. Returns (points, nodes, frequencies).
    """
    places = heights(probe, band)
    lens = np.hypot(probe.elevation_focus, places) - probe.elevation_focus
    path = np.hypot(rho[..., None], y[:, None, None] - places)
    step = np.exp(-1j * (band.k[1] - band.k[0]) * (path - rho[..., None] - lens))
    ray = np.exp(-1j * band.k[0] * (path - rho[..., None] - lens)) / path
    if transparency is not None:
        ray = ray * transparency
    out = np.empty(rho.shape + band.k.shape, complex)
    for i in range(len(band.k)):
        out[..., i] = ray.mean(-1)
        ray *= step
    return out


def heights(probe, band):
    """Middles of strips of an element's height, half the shortest wavelength high at most."""
    count = math.ceil(probe.height / (SOUND_SPEED / band.f[-1] / 2))
    return ((np.arange(count) + 0.5) / count - 0.5) * probe.height


def lagrange(nodes, x):
    """Weights that interpolate from Chebyshev `nodes` (points, K) to x (points, E): (points, E, K)."""
    count = nodes.shape[1]
    signs = (-1.0) ** np.arange(count) * np.sin((2 * np.arange(count) + 1) * math.pi / (2 * count))
    gap = x[:, :, None] - nodes[:, None, :]
    gap[gap == 0] = 1e-30
    weights = signs / gap
    return weights / weights.sum(-1, keepdims=True)


def element_response(probe, band, points, active, nodes=None, transparency=None):
    """One-way response of each active element at each point: (points, elements, frequencies).

    The sum over heights is smooth in the in-plane distance: it is taken at Chebyshev nodes and
    interpolated (the phase of that distance itself is exact).
    """
    angles = probe.element_angles[active]
    x = points[:, 0, None] - probe.radius * np.sin(angles)
    z = points[:, 2, None] - probe.radius * np.cos(angles)
    rho = np.hypot(x, z)
    low, high = rho.min(1) * 0.9999, rho.max(1) * 1.0001
    nodes = nodes or node_count(probe, band, points[:, 1], low, high)
    unit = np.cos((2 * np.arange(nodes) + 1) * math.pi / (2 * nodes))
    at = (low + high)[:, None] / 2 + (high - low)[:, None] / 2 * unit
    tall = height_response(probe, band, at, points[:, 1], transparency)
    packed = lagrange(at, rho) @ tall.view(float)
    response = band.phases(rho) * packed.view(complex)
    sine = (x * np.cos(angles) - z * np.sin(angles)) / rho
    response *= directivity(probe, band, sine)
    return response


def node_count(probe, band, y, low, high):
    """Enough for the phase that the outermost ray's curvature gains between the nearest and furthest."""
    reach = np.abs(y) + probe.height / 2
    swing = band.k[-1] * ((np.hypot(low, reach) - low) - (np.hypot(high, reach) - high)).max()
    return int(6 + 0.6 * swing)


def directivity(probe, band, sine):
    """Mean over sub-sources along an element's width of the phase that each adds."""
    count = max(6, 2 * math.ceil(probe.pitch / (SOUND_SPEED / band.f[-1] / 2) / 2))
    places = ((np.arange(count // 2) + 0.5) / count) * probe.pitch  # the other half mirrors them
    out = np.zeros(sine.shape + band.k.shape)
    for place in places:
        out += np.cos((place * sine)[..., None] * band.k)
    return out / len(places)


def share(probe, theta, width):
    """Share of each element within an aperture of the given arc length about the stick."""
    place = (probe.element_angles - theta) * probe.radius
    low = np.maximum(place - probe.pitch / 2, -width / 2)
    high = np.minimum(place + probe.pitch / 2, width / 2)
    return np.clip(high - low, 0, None) / probe.pitch


def focus(probe, band, theta, focus_range, width):
    """Weights (elements, frequencies) that focus the stick at `focus_range` from the face."""
    x, z = math.sin(theta), math.cos(theta)
    r = probe.radius + focus_range
    angles = probe.element_angles
    path = np.hypot(r * x - probe.radius * np.sin(angles), r * z - probe.radius * np.cos(angles))
    return share(probe, theta, width)[:, None] * band.phases(focus_range - path)


def transmit(probe, band, theta):
    return focus(probe, band, theta, probe.transmit_focus, probe.transmit_focus / probe.f_number)


def receive(probe, band, theta, gate):
    return focus(probe, band, theta, gate, gate / probe.f_number)


def active_elements(probe, thetas, deepest):
    """Elements that any of the sticks uses."""
    width = max(probe.transmit_focus, deepest) / probe.f_number
    return np.flatnonzero(sum(share(probe, theta, width) for theta in thetas))


def echoes(probe, band, response, active, theta, gates, spectrum=None):
    """IQ of each point of `response` at the stick's gates: (points, gates)."""
    spectrum = band.amplitude if spectrum is None else spectrum
    sent = np.einsum("pef,ef->pf", response, transmit(probe, band, theta)[active]) * spectrum
    out = np.empty((len(response), len(gates)), complex)
    for i, gate in enumerate(gates):
        weights = receive(probe, band, theta, gate)[active] * np.exp(2j * band.k * gate)
        out[:, i] = np.einsum("pf,pf->p", np.einsum("pef,ef->pf", response, weights), sent)
    return out / np.sum(band.amplitude)
