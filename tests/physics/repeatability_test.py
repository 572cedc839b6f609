"""A seed means one set of bytes, whatever the number of threads; another seed means other speckle and noise."""
import unittest

import numpy

import scan
import wobblebench

FACE = {"phantom.name": "fetal_face", "phantom.voxel_mm": 1, "acquisition.frames_per_volume": 6}
BALL = {"phantom.name": "sphere", "phantom.radius_mm": 2, "phantom.voxel_mm": 0.5, "placement.position_mm": [0, 0, 75],
        **scan.grid(4, 4 / 3, 1, 0, 80, 256)}  # few scatterers: `reference` sums over elements
MOVING = {"motion.velocity_mm_s": [4, -3, 8], "motion.breath_amplitude_mm": 3}


class Repeatability(unittest.TestCase):
    def compare(self, settings, make):
        for name, motion in (("still", {}), ("moving", {**MOVING, **({"motion.head_turn_deg": 10} if settings["phantom.name"] == "fetal_face" else {})})):
            with self.subTest(name=name):
                first, *others = (make({**settings, **motion, "simulation.seed": seed, "simulation.threads": threads})
                                  for seed, threads in ((1, 1), (1, 2), (1, 4), (1, 4), (2, 4)))
                for other in others[:-1]:
                    self.assertEqual(first.tobytes(), other.tobytes())
                changed = numpy.mean(first != others[-1])
                if settings["simulation.fidelity"] == "geometry":  # nothing is random
                    self.assertEqual(changed, 0)
                else:
                    self.assertGreater(changed, 0.5)

    @staticmethod
    def iq(settings):
        return scan.record(settings, {"simulation.noise_db": -95})

    def test_geometry(self):
        self.compare({**FACE, "simulation.fidelity": "geometry"},
                     lambda settings: wobblebench.simulate(wobblebench.Scene(settings=settings)).samples.copy())

    def test_field(self):
        self.compare({**FACE, **scan.FIELD}, self.iq)

    def test_scatterers(self):
        self.compare({**FACE, **scan.MAIN_LOBE}, self.iq)

    def test_reference(self):
        self.compare({**BALL, **scan.REFERENCE}, self.iq)


if __name__ == "__main__":
    unittest.main()
