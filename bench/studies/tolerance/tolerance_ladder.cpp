#include "bench/studies/tolerance/tolerance_ladder.h"

namespace wobblebench::bench {

const ToleranceLadder& tolerance_ladder() {
  static const ToleranceLadder ladder{{"render.reconstruction.sticks",
                                       "render.reconstruction.spacing_mm",
                                       "render.scan_conversion.slice_size",
                                       "render.ray_casting.steps",
                                       "render.ray_casting.detector",
                                       "render.ray_casting.incidence_correction_mm"},
                                      {{"\"plain\"", "1", "128", "128", "\"iso\"", "1.2"},
                                       {"\"plain\"", "1", "256", "256", "\"iso\"", "1.2"},
                                       {"\"plain\"", "1", "512", "512", "\"iso\"", "1.2"},
                                       {"\"aligned\"", "4", "256", "256", "\"iso\"", "1.2"},
                                       {"\"aligned\"", "2.5", "256", "256", "\"iso\"", "1.2"},
                                       {"\"aligned\"", "1.5", "384", "256", "\"iso\"", "1.2"},
                                       {"\"aligned\"", "1", "512", "512", "\"iso\"", "1.2"},
                                       {"\"aligned\"", "0.7", "512", "1024", "\"iso\"", "1.2"}}};
  return ladder;
}

}  // namespace wobblebench::bench
