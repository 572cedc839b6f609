#include "render/presets.h"

#include <optional>

namespace wobblebench::render {

RenderOptions render_preset(RenderPreset preset) {
  RenderOptions options;
  if (preset == RenderPreset::baseline) return options;
  options.reconstruction.sticks = Sticks::aligned;
  options.reconstruction.spacing_m = 1.5e-3;
  options.ray_casting.steps = 256;
  options.ray_casting.detector = Detector::iso;
  options.ray_casting.iso_level = std::nullopt;
  options.ray_casting.caps = true;
  options.ray_casting.incidence_correction_m = std::nullopt;
  options.ray_casting.outline_m = 3.5e-3;
  options.ray_casting.smallest_piece_m2 = 10 * kMillimetre * kMillimetre;
  return options;
}

}  // namespace wobblebench::render
