"""Grey levels of the preset `clinical` against what was counted in fetal 4D volumes of a commercial scanner, on the default face."""
import unittest

import numpy

import scan
import wobblebench

SEEDS = (1, 2, 3)
SPACING_MM = 160 / 512
# Percentiles of the samples that are not zero, in 255ths: the middle of what was counted, and its range and as much again.
GREY = {5: (4.5, 3), 25: (22.5, 3), 50: (60, 12), 75: (150, 36), 95: (255, 2)}


def samples(**simulation):
    settings = {f"simulation.{key}": value for key, value in simulation.items()}
    return wobblebench.simulate(wobblebench.Scene(settings={"phantom.name": "fetal_face", **settings})).samples


def first_after_fluid(tissue):
    """By stick: the samples of fluid between wall and face, and the first of the face; none where there is no fluid, or no face."""
    ends = {}
    for at in numpy.ndindex(tissue.shape[:2]):
        inside = numpy.flatnonzero(tissue[at])
        gaps = numpy.diff(inside)
        if len(gaps) and gaps.max() * SPACING_MM > 4:
            widest = int(numpy.argmax(gaps))
            ends[at] = inside[widest], inside[widest + 1]
    return ends


class Clinical(scan.Worst):
    def test_grey_levels(self):
        """What is fluid the rung without beam and speckle says."""
        ends = first_after_fluid(samples(fidelity="geometry") > 0)
        self.assertGreater(len(ends), 300)
        volumes = {preset: [numpy.rint(255 * samples(fidelity="field", preset=preset, seed=seed)) for seed in SEEDS] for preset in ("clean", "clinical")}
        dark, full, grey = [], [], []
        for volume in volumes["clinical"]:
            fluid = numpy.concatenate([volume[at][wall + 4:face - 6] for at, (wall, face) in ends.items()])
            seen = volume[volume > 0]
            dark.append(100 * numpy.mean(fluid == 0))
            full.append(100 * numpy.mean(seen == 255))
            grey.append(numpy.percentile(seen, list(GREY)))
        self.hold("zero_in_fluid_percent", numpy.mean(dark) - 33, 8)
        self.hold("full_scale_percent", numpy.mean(full) - 11, 4)
        for percent, found in zip(GREY, numpy.mean(grey, 0)):
            self.hold(f"grey_p{percent}", found - GREY[percent][0], GREY[percent][1])
        # Of the middle of the field, read from the first skin on, and 6 mm before it.
        middle = [(at, face) for at, (_, face) in ends.items() if abs(at[0] / 36 - 0.5) * 61 < 12 and abs(at[1] / 63 - 0.5) * 77 < 12]
        skin = {preset: numpy.mean([numpy.sum(numpy.mean([volume[at][face - 19:face + 64] for at, face in middle if face + 64 < 512], 0) > 127.5)
                                    for volume in of_preset]) for preset, of_preset in volumes.items()}
        self.hold("skin_thickness_over_clean", skin["clinical"] / skin["clean"] - 2.5, 1)


if __name__ == "__main__":
    unittest.main()
