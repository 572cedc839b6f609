#include "bench/studies/validate/common/scan.h"

#include <algorithm>
#include <cmath>

#include "phantoms/grids.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

phantoms::Phantom open_tissue(const std::string& material) {
  return {"open_tissue",
          phantoms::material_table(),
          phantoms::material_index(material),
          {},
          {glm::dvec3(-1), glm::dvec3(1)},
          glm::dvec3(0),
          std::make_shared<phantoms::Grids>()};
}

phantoms::Phantom block(const glm::dvec3& half_m, double voxel_m) {
  const double reach_m = std::max({half_m.x, half_m.y, half_m.z});
  const double room = reach_m + 2 * phantoms::kHalfWidthVoxels * voxel_m;
  auto grids = std::make_shared<phantoms::Grids>();
  grids->signed_distance = {phantoms::build_level_set(
      "block",
      [=](const glm::dvec3& p) { return phantoms::box_distance(p, half_m); },
      {glm::dvec3(-room), glm::dvec3(room)},
      voxel_m,
      phantoms::Distances::exact)};
  return {"block",
          phantoms::material_table(),
          phantoms::material_index("amniotic_fluid"),
          {{"block", phantoms::material_index("soft_tissue"), true}},
          {glm::dvec3(-reach_m), glm::dvec3(reach_m)},
          glm::dvec3(0),
          grids};
}

sim::ScannedTissue scanned(const phantoms::Phantom& phantom, int threads) {
  constexpr double kReach_m = 1e-3;
  return {std::make_shared<const sim::TissueMap>(phantom, kReach_m, threads),
          phantom.materials(),
          {},
          {}};
}

hw::AcquisitionPlan preset_plan(hw::ProbePreset preset,
                                hw::AcquisitionOptions acquisition,
                                int beyond) {
  const hw::ProbePresetData& data = hw::probe_preset(preset);
  const int steps = acquisition.sticks_per_frame - 1;
  acquisition.sector_rad = data.sector_rad * (steps + 2 * beyond) / steps;
  acquisition.sticks_per_frame += 2 * beyond;
  return {data.probe, acquisition};
}

int first_sample_at(double range_m, double spacing_m, int samples) {
  const int index = static_cast<int>(std::ceil(range_m / spacing_m - 0.5 - 1e-9));
  return std::clamp(index, 0, samples);
}

std::vector<double> Scan::stick(int frame, int line) const {
  std::vector<double> values;
  for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
    values.push_back(at(frame, line, k));
  }
  return values;
}

int Scan::sample_at(double range_m) const {
  return first_sample_at(range_m, plan.sample_spacing_m(), plan.acquisition().samples_per_stick);
}

sim::SimulationOptions bare_envelope(sim::Rung rung, std::uint64_t seed) {
  sim::SimulationOptions options;
  options.fidelity = rung;
  options.seed = seed;
  options.tgc_db_per_cm_mhz = 0;
  options.noise_db = sim::kZeroAmplitude_db;
  options.full_scale_db = 0;
  options.low_pass = false;
  options.output = hw::SampleScale::linear_envelope;
  return options;
}

sim::SimulationOptions lossless_envelope(sim::Rung rung, std::uint64_t seed) {
  auto options = bare_envelope(rung, seed);
  options.attenuation = false;
  options.transmission_loss = false;
  options.interface_echo = false;
  return options;
}

Scan scan(const phantoms::PlacedPhantom& subject,
          const hw::AcquisitionPlan& plan,
          const sim::SimulationOptions& options,
          std::uint32_t volume) {
  return {plan, sim::ProbeSimulator(subject, plan, options).volume(volume)};
}

}  // namespace wobblebench::bench
