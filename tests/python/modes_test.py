"""Mode `fast` makes the picture of mode `plain`: four phantoms from five directions, 512² rays of 512 steps. Where an edge
meets the threshold within rounding, one mode takes it and the other the next one; of 262 144 pixels that may befall a few."""
import unittest

import numpy

import wobblebench

PHANTOMS = ("fetal_face", "sphere", "plane", "speckle_block")  # curved, round, flat, and speckle without a surface
DIRECTIONS = ((0, 0), (40, 0), (-50, -35), (0, 60), (90, 0))
STEP_MM = 0.3  # of a ray, about


class Modes(unittest.TestCase):
    def test_agree(self):
        for phantom in PHANTOMS:
            scene = wobblebench.Scene(settings={"phantom.name": phantom, "render.preset": "baseline"})
            volume = wobblebench.simulate(scene)
            for yaw_deg, pitch_deg in DIRECTIONS:
                with self.subTest(phantom=phantom, yaw_deg=yaw_deg, pitch_deg=pitch_deg):
                    view = scene.replace({"render.view.yaw_deg": yaw_deg, "render.view.pitch_deg": pitch_deg})
                    self.compare(*(self.depth_mm(view, volume, mode) for mode in ("plain", "fast")))

    @staticmethod
    def depth_mm(scene, volume, mode):
        scene = scene.replace({"render.pipeline.mode": mode})
        return 1e3 * wobblebench.Renderer(scene).render(volume).depth_m.astype(float)

    def compare(self, plain, fast):
        found = numpy.isfinite(plain), numpy.isfinite(fast)
        apart = numpy.abs(plain - fast)[found[0] & found[1]]
        near = apart[apart < STEP_MM]
        self.assertLess((numpy.sum(found[0] != found[1]) + len(apart) - len(near)) / plain.size, 1e-3)
        if len(near):
            self.assertLess(numpy.sqrt(numpy.mean(near ** 2)), 0.1 * STEP_MM)


if __name__ == "__main__":
    unittest.main()
