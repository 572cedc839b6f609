"""Mean echo power behind a thin absorbing half plane, for rays that go straight."""
import math

import numpy as np

import element_sum as es
from speckle import Speckle

PLANE_DEPTH = 60e-3
TRANSPARENCY = 0.1  # amplitude, each way


def attenuated(place, footprint):
    """Factor of a ray bundle `footprint` wide that crosses the plane at `place`: the half plane lies at
    positive places."""
    return 1 - (1 - TRANSPARENCY) * np.clip(place / footprint + 0.5, 0, 1)


def across_lines(probe, depth, crossings):
    """Power, relative to no plane, for sticks of frame 0 whose axes cross the plane at `crossings`,
    lateral lengths from the edge. The face is a circle: instead of the stick, the plane turns about the
    face's centre, so that one response serves all."""
    scene = Speckle(probe, 0.0, depth)
    points = scene.plane(scene.elevation[scene.elevation > 0])
    active = es.active_elements(probe, [0.0], depth)
    response = np.concatenate([es.element_response(probe, scene.band, some, active)
                               for some in np.array_split(points, 1 + len(points) // 200)])
    angles = probe.element_angles[active]
    face = probe.radius * np.stack([np.sin(angles), 0 * angles, np.cos(angles)], -1)
    plane_z = probe.radius + PLANE_DEPTH
    powers = [power(scene, response, active)]
    for crossing in crossings:
        turn = math.atan(crossing / plane_z)
        x, z = turned(points[:, 0], points[:, 2], turn)
        face_x, face_z = turned(face[:, 0], face[:, 2], turn)
        behind = (z[:, None] - plane_z) / (z[:, None] - face_z)  # share of the ray beyond the plane
        place = x[:, None] + (face_x - x[:, None]) * behind
        mask = attenuated(place, probe.pitch * behind)
        powers.append(power(scene, response * mask[..., None], active))
    return np.array(powers[1:]) / powers[0]


def across_frames(probe, depth, crossings):
    """The same for sticks of the middle line whose frames cross the plane at `crossings`, elevations
    from the edge."""
    scene = Speckle(probe, 0.0, depth)
    points = scene.plane(scene.elevation)
    active = es.active_elements(probe, [0.0], depth)
    bare = summed(scene, points, active)
    return np.array([summed(scene, points, active, crossing) for crossing in crossings]) / bare


def summed(scene, points, active, crossing=None):
    total = 0.0
    for some in np.array_split(points, 1 + len(points) // 200):
        mask = None if crossing is None else height_mask(scene, some, crossing)
        response = es.element_response(scene.probe, scene.band, some, active, transparency=mask)
        total += power(scene, response, active)
    return total


def height_mask(scene, points, crossing):
    """Factor of the ray from each height to each point. The face's sagitta along the array, 1 mm of 60,
    is left out of where a ray crosses the plane."""
    probe = scene.probe
    places = es.heights(probe, scene.band)
    z_axis = probe.radius - probe.wobble_radius
    lever = probe.wobble_radius + PLANE_DEPTH
    turn = math.atan(crossing / lever)
    y, z = turned(points[:, 1], points[:, 2] - z_axis, turn)
    face_y, face_z = turned(places, probe.wobble_radius, turn)
    behind = (z[:, None] - lever) / (z[:, None] - face_z)
    place = y[:, None] + (face_y - y[:, None]) * behind
    return attenuated(place, probe.height / len(places) * behind)[:, None, :]


def turned(across, along, angle):
    return (across * math.cos(angle) + along * math.sin(angle), along * math.cos(angle) - across * math.sin(angle))


def power(scene, response, active):
    sums = [np.einsum("pef,ef->pf", response, weights[active]) for weights in (
        es.transmit(scene.probe, scene.band, 0.0), es.receive(scene.probe, scene.band, 0.0, scene.depth))]
    return float(np.sum(np.abs(sums[0] * sums[1]) ** 2 * scene.pulse_power))


def rise_width(crossings, relative_power):
    """10 to 90 % of the amplitude between the two ends, first crossings from the dark end."""
    order = np.argsort(-crossings)
    x, amplitude = crossings[order], np.sqrt(relative_power[order])
    share = (amplitude - amplitude[0]) / (amplitude[-1] - amplitude[0])
    ends = []
    for level in (0.1, 0.9):
        i = int(np.argmax(share >= level))
        ends.append(np.interp(level, share[i - 1:i + 1], x[i - 1:i + 1]))
    return abs(ends[1] - ends[0])
