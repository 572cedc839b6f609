"""What is lost on the way and what interfaces echo: attenuation of even tissue, what lies behind bone and behind fluid, the edge
of a shadow, time gain, and reflection by Fresnel's formula, within its lobe and off a rough face."""
import math
import unittest

import numpy

import scan
import shadow
import wobblebench
from scan import FIELD, LOSSLESS, MAIN_LOBE, MATERIALS, PRESETS, decibel, decibel_of_power

MEAN = {**FIELD, "simulation.speckle": False}  # the rung's own mean echo
BARE = {"simulation.interface_echo": False}
MHZ = PRESETS["standard"].centre_frequency * 1e-6


def power(*settings):
    """[frame, line, sample]"""
    return scan.envelope(*settings)[0] ** 2


def reflection(before, behind, angle):
    """Of a plane wave between fluids, amplitude: Kinsler, Fundamentals of Acoustics, 6.4; 1 beyond the critical angle."""
    (speed, impedance, *_), (other_speed, other_impedance, *_) = MATERIALS[before], MATERIALS[behind]
    through = numpy.sqrt(numpy.maximum(0, 1 - (other_speed / speed * numpy.sin(angle)) ** 2))
    one, other = other_impedance * numpy.cos(angle), impedance * through
    return numpy.where(through == 0, 1, (one - other) / (one + other))


def two_faces_db(before, behind):
    return 2 * decibel(1 - reflection(before, behind, 0) ** 2)


class Attenuation(scan.Worst):
    def slope(self, name, rung, seeds):
        """Of a line through the mean level from 20 to 120 mm; sticks whose apertures stay on the array."""
        plan = scan.grid(24, 30 / 23, 16, 61 / 15, 125, 400)
        mean = numpy.mean([power(scan.TISSUE, BARE, rung, plan, {"simulation.seed": seed}).mean(axis=(0, 1)) for seed in seeds], 0)
        ranges = scan.ranges_mm(125, len(mean))
        here = (ranges > 20) & (ranges < 120)
        expected = scan.Band("standard").level_db(ranges[here], 2 * MATERIALS["soft_tissue"][2] * MHZ * ranges[here] / 10)
        found, wanted = (numpy.polyfit(ranges[here] / 10, level, 1)[0] for level in (decibel_of_power(mean[here]), expected))
        self.hold(f"slope.{name}", found / wanted - 1, 0.02, f"{found:.3f} dB/cm, table {wanted:.3f}")

    def test_slope(self):
        self.slope("field_without_speckle", MEAN, (1,))
        self.slope("field", FIELD, (1, 2))
        self.slope("scatterers", MAIN_LOBE, (1, 2))

    def test_mean_slope(self):
        """The part for CI."""
        self.slope("field_without_speckle", MEAN, (1,))

    def test_levels(self):
        """Of even tissue, over the same without attenuation."""
        plan = scan.grid(16, 20 / 15, 37, 61 / 36, 160, 512)
        for name, rung, seeds in (("field", MEAN, (1,)), ("scatterers", MAIN_LOBE, range(1, 7))):
            for preset in PRESETS:
                band = scan.Band(preset)
                for material in ("brain", "soft_tissue", "uterus_wall"):
                    with_loss, without = (numpy.mean([power(scan.even(material), scan.probe(preset), BARE, rung, plan,
                                          {"simulation.seed": seed, "simulation.attenuation": lossy}).mean(axis=(0, 1)) for seed in seeds], 0)
                        for lossy in (True, False))
                    ranges = scan.ranges_mm(160, len(without))
                    for depth in (20, 30, 40, 60, 80, 100, 120, 140):
                        window = scan.near(ranges, depth, 2)
                        found = decibel_of_power(with_loss[window].mean() / without[window].mean())
                        loss = 2 * MATERIALS[material][2] * PRESETS[preset].centre_frequency * 1e-6 * depth / 10
                        self.hold(f"level.{name}.{preset}", found - float(band.level_db(depth, loss)), 0.5, f"{material} at {depth} mm")

    def behind(self, name, rung, body, material, chord, back_mm, seeds):
        """Mean power from 2 to 30 mm behind a body, over that of the same tissue without it; each stick has its own way through."""
        line_deg, frame_deg = numpy.linspace(-3, 3, 24), numpy.linspace(-3, 3, 16)
        plan = scan.grid(24, 6 / 23, 16, 6 / 15, 140, 448)
        inside = numpy.array(chord(*scan.rays(line_deg[None], frame_deg[:, None])))
        with_body, without = (numpy.array([power(scene, BARE, rung, plan, {"simulation.seed": seed}) for seed in seeds])
                              for scene in (body, scan.TISSUE))
        ranges = scan.ranges_mm(140, without.shape[-1])
        window = scan.near(ranges, back_mm + 16, 14)
        ranges = ranges[window]
        loss = 2 * MATERIALS["soft_tissue"][2] * MHZ * ranges / 10
        change = 2 * (MATERIALS[material][2] - MATERIALS["soft_tissue"][2]) * MHZ * (inside[1] - inside[0]) / 10
        band = scan.Band("standard")
        expected = band.level_db(ranges, loss + change[..., None]) - band.level_db(ranges, loss)
        share = without[..., window] * 10 ** (expected / 10)
        found, wanted = (decibel_of_power(one.sum() / without[..., window].sum()) for one in (with_body[..., window], share))
        wanted += two_faces_db("soft_tissue", material)
        self.hold(f"{name}", found - wanted, 1, f"{found:.2f} dB, expected {wanted:.2f}")

    def test_behind_bone_and_fluid(self):
        bone = {"phantom.name": "bone_plate", "phantom.thickness_mm": 3, "placement.position_mm": [0, 0, 80]}
        cyst = {"phantom.name": "cyst", "phantom.radius_mm": 20, "placement.position_mm": [0, 0, 90]}

        def plate(origin, along):
            return [(z - origin[..., 2]) / along[..., 2] for z in (80, 83)]

        def ball(origin, along):
            to_middle = numpy.array([0, 0, 90]) - origin
            middle = (to_middle * along).sum(-1)
            half = numpy.sqrt(20 ** 2 - (to_middle ** 2).sum(-1) + middle ** 2)
            return [middle - half, middle + half]

        for name, rung in (("field", FIELD), ("scatterers", MAIN_LOBE)):
            self.behind(f"bone_shadow.{name}", rung, bone, "cortical_bone", plate, 43, (1, 2))
            self.behind(f"cyst_enhancement.{name}", rung, cyst, "amniotic_fluid", ball, 70, (1, 2))

    def test_time_gain(self):
        """Two-way, by the centre frequency; samples have 256 steps of 100 dB."""
        shown = []
        for gain in (0, 0.3):
            shown.append(wobblebench.simulate(wobblebench.Scene(settings={
                **scan.TISSUE, **MEAN, **BARE, "simulation.noise_db": -200, "simulation.tgc_db_per_cm_mhz": gain, "simulation.full_scale_db": 0,
                "simulation.dynamic_range_db": 120, "simulation.low_pass": False})).samples.astype(float).mean(axis=(0, 1)))
        ranges = scan.ranges_mm(160, 512)
        here = (ranges > 10) & (ranges < 80)
        error = (shown[1] - shown[0])[here] * 120 - 2 * 0.3 * MHZ * ranges[here] / 10
        self.hold("time_gain_db", numpy.abs(error).max(), 0.5)


class ShadowEdge(scan.Worst):
    """Behind a thin half plane of bone, 60 mm from the face, against the element sum of tests/yardstick/shadow.py."""
    PLANE_MM, THICKNESS_MM = 60, 2
    CROSSINGS_MM = numpy.arange(-16, 17)

    def edge(self, across, levels_of):
        middle = (40, 0, 40 + self.PLANE_MM) if across == "lateral" else (0, 40, 40 + self.PLANE_MM)
        bone = scan.box(40, 40, self.THICKNESS_MM, "cortical_bone", "soft_tissue", middle)
        few, many = (9, 6 / 8), (120, (30 if across == "lateral" else 34) / 119)
        plan = scan.grid(*(many + few if across == "lateral" else few + many), 135, 864)
        lossless = {"simulation.attenuation": True, **BARE}
        sticks = [power(scene, lossless, MEAN, plan) for scene in (bone, scan.TISSUE)]
        change = sticks[0] / sticks[1]
        change = change[4] if across == "lateral" else change[:, 4]
        degrees = (numpy.arange(120) - 59.5) * many[1]
        origin, along = scan.rays(degrees, 0) if across == "lateral" else scan.rays(0, degrees)
        at = origin + along * ((40 + self.PLANE_MM - origin[:, 2]) / along[:, 2])[:, None]
        place = at[:, 0] if across == "lateral" else at[:, 1]
        order = numpy.argsort(place)
        ranges = scan.ranges_mm(135, change.shape[-1])
        own = 2 * MATERIALS["soft_tissue"][2] * MHZ
        for depth in (80, 100, 130):
            level = decibel_of_power(change[:, scan.near(ranges, depth, 1)].mean(-1))
            found = numpy.interp(self.CROSSINGS_MM, place[order], level[order])
            band = scan.Band("standard")
            through = two_faces_db("soft_tissue", "cortical_bone") + float(
                band.level_db(depth, own * depth / 10 + 2 * (5 - 0.5) * MHZ * self.THICKNESS_MM / 10) - band.level_db(depth, own * depth / 10))
            shadow.TRANSPARENCY = 10 ** (through / 40)
            wanted = levels_of(PRESETS["standard"], depth * 1e-3, self.CROSSINGS_MM * 1e-3)
            rises = [shadow.rise_width(self.CROSSINGS_MM, one) for one in (10 ** (found / 10), wanted)]
            self.hold(f"shadow.{across}.rise", rises[0] / rises[1] - 1, 0.2, f"at {depth} mm: {rises[0]:.2f} mm, table {rises[1]:.2f}")
            self.hold(f"shadow.{across}.level", numpy.abs(found - decibel_of_power(wanted)).mean(), 1, f"at {depth} mm")

    def test_across_lines(self):
        self.edge("lateral", shadow.across_lines)

    def test_across_frames(self):
        self.edge("elevation", shadow.across_frames)


class Reflection(scan.Worst):
    ONLY_FACES = {"simulation.attenuation": False, "simulation.transmission_loss": False}

    def largest(self, materials, angle_deg, number, lobe_deg):
        """Echo of the stick on the axis from a smooth plane 70 mm before it, tilted about x and y in turn; none has backscatter."""
        slab = scan.box(80, 80, 30, *materials, (0, 0, 110), (angle_deg, 0) if number % 2 == 0 else (0, -angle_deg))
        return float(scan.peak(scan.envelope(slab, self.ONLY_FACES, FIELD, scan.grid(1, 0, 1, 0, 90, 900),
                                             {"simulation.specular_width_deg": lobe_deg})[0, 0, 0]))

    @staticmethod
    def lobe(angle_deg, width_deg):
        """A Gaussian that is 3 dB down at half its width."""
        return 2 ** (-0.5 * (2 * angle_deg / width_deg) ** 2)

    def test_lobe(self):
        straight = abs(float(reflection("amniotic_fluid", "water", 0)))
        for number, angle in enumerate((0, 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6)):
            wanted = abs(float(reflection("amniotic_fluid", "water", math.radians(angle)))) * self.lobe(angle, 3)
            self.hold("lobe", self.largest(("water", "amniotic_fluid"), angle, number, 3) / straight - wanted / straight, 0.02, f"at {angle} deg")

    def test_fresnel(self):
        """From water to a faster fluid: seven times as much at 60 degrees, and all beyond 75."""
        for number, angle in enumerate((0, 10, 20, 30, 40, 50, 60, 65, 70, 77)):
            found = self.largest(("amniotic_fluid", "water"), angle, number, 90) / self.lobe(angle, 90)
            wanted = abs(float(reflection("water", "amniotic_fluid", math.radians(angle))))
            self.hold("fresnel", found / wanted - 1, 0.03, f"at {angle} deg: {found:.4f}, formula {wanted:.4f}")

    def test_rough_bone(self):
        """Off its lobe the face of bone, whose roughness is 0.4, echoes 0.4 |R| cos i, of which speckle is made: mean power 4 / pi of
        its square, over the length of a pulse."""
        slab = scan.box(80, 80, 60, "cortical_bone", "amniotic_fluid", (0, 0, 110))
        lines, frames, depth = 48, 32, 105
        origin, along = scan.rays(numpy.linspace(-15, 15, lines)[None], numpy.linspace(-45, 45, frames)[:, None])
        angle = numpy.degrees(numpy.arccos(along[..., 2]))
        range_mm = (110 - origin[..., 2]) / along[..., 2]
        length = math.sqrt(math.pi) * PRESETS["standard"].axial_fwhm * 1e3 / math.sqrt(8 * math.log(2))
        variants = [(rung_name + kind, rung, losses) for rung_name, rung in (("field", FIELD), ("scatterers", MAIN_LOBE))
                    for kind, losses in (("", self.ONLY_FACES), (".lossy", {}))]  # what bone takes is missing behind its face, not from it
        for name, rung, losses in variants:
            energies = []
            for echo in (True, False):  # less what the bone behind its face echoes
                scene = {"simulation.interface_echo": echo}
                plan = scan.grid(lines, 30 / (lines - 1), frames, 90 / (frames - 1), depth, 1050)
                volumes = [power(slab, losses, rung, plan, scene, {"simulation.seed": seed}) for seed in (1, 2, 3)]
                energies.append(numpy.mean(volumes, 0).sum(-1) * depth / volumes[0].shape[-1] / length)
            energy = energies[0] - energies[1]
            for low in (8, 11, 14, 17, 20):
                here = (angle >= low) & (angle < low + 3) & (range_mm < depth - 5)
                wanted = 0.4 * abs(reflection("amniotic_fluid", "cortical_bone", numpy.radians(angle[here]))) * along[here, 2]
                error = decibel_of_power(energy[here].mean() / numpy.mean(4 / math.pi * wanted ** 2))
                self.hold(f"diffuse.{name}", error, 1, f"at {low} to {low + 3} deg, {here.sum()} sticks")


if __name__ == "__main__":
    unittest.main()
