#include "sim/options.h"

namespace wobblebench::sim {

SimulationOptions simulation_preset(ScanPreset preset) {
  SimulationOptions options;
  options.preset = preset;
  if (preset == ScanPreset::clean) return options;
  // Chosen so that the samples of the default face have the statistics of real fetal volumes
  // (docs/decisions/0049-clinical.md).
  options.tgc_db_per_cm_mhz = 0;
  options.full_scale_db = -64;
  options.dynamic_range_db = 32.5;
  ClutterOptions& clutter = options.clutter;
  clutter.probe_reflection = 0.5;
  clutter.haze_db = -32;
  clutter.haze_unevenness_db = 10;
  clutter.particles_per_cm3 = 0.5;
  clutter.tissue_unevenness_db = 14;
  clutter.tissue_grain_m = 8e-3;
  clutter.even_skin_m = 3e-3;
  options.display.line_filter = 0.4;
  options.display.grey_bits = 8;
  return options;
}

}  // namespace wobblebench::sim
