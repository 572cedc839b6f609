#include "bench/studies/validate/losses/tissue_levels.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <string_view>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/yardstick.h"
#include "phantoms/material.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr std::string_view kMaterials[] = {"brain", "soft_tissue", "uterus_wall"};
constexpr double kRanges_m[] = {20e-3, 30e-3, 40e-3, 60e-3, 80e-3, 100e-3, 120e-3, 140e-3};
constexpr double kHalfGate_m = 2e-3;
constexpr double kBar_db = 0.5;
constexpr std::uint64_t kSeeds = 6;  ///< of speckle, whose mean is compared

hw::AcquisitionPlan plan_of(hw::ProbePreset preset) {
  return {hw::probe_preset(preset).probe,
          {.depth_m = 0.16,
           .sector_rad = 20 * kDegree,
           .fan_rad = 61 * kDegree,
           .sticks_per_frame = 16,
           .samples_per_stick = 512,
           .frames_per_volume = 37}};
}

/// Adds the intensities of all sticks about each of kRanges_m.
void add_intensities(const Scan& scan, std::vector<Moments>& found) {
  const auto& a = scan.plan.acquisition();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const int first = scan.sample_at(kRanges_m[i] - kHalfGate_m);
    const int last = scan.sample_at(kRanges_m[i] + kHalfGate_m);
    for (int f = 0; f < a.frames_per_volume; ++f) {
      for (int l = 0; l < a.sticks_per_frame; ++l) {
        for (int k = first; k < last; ++k) found[i].add(scan.at(f, l, k) * scan.at(f, l, k));
      }
    }
  }
}

std::uint64_t seeds_of(sim::Rung rung) {
  return rung == sim::Rung::field ? 1 : kSeeds;  // `field` is taken without speckle
}

/// Mean intensities about each of kRanges_m, over all seeds.
std::vector<Moments> intensities(const phantoms::PlacedPhantom& subject,
                                 const hw::AcquisitionPlan& plan,
                                 sim::Rung rung,
                                 bool attenuation) {
  std::vector<Moments> found(std::size(kRanges_m));
  for (std::uint64_t seed = 1; seed <= seeds_of(rung); ++seed) {
    auto options = bare_envelope(rung, seed);
    options.speckle = rung != sim::Rung::field;
    options.attenuation = attenuation;
    add_intensities(scan(subject, plan, options), found);
  }
  return found;
}

struct Worst {
  double difference_db = 0;
  std::string where;
};

Worst worst_of(sim::Rung rung, hw::ProbePreset preset, StudyReport& report) {
  const hw::AcquisitionPlan plan = plan_of(preset);
  const double mhz = plan.probe().center_frequency_hz / kMegahertz;
  const TissueBand band(preset);
  Worst worst;
  for (const std::string_view name : kMaterials) {
    const phantoms::PlacedPhantom subject{open_tissue(std::string(name))};
    const auto with = intensities(subject, plan, rung, true);
    const auto without = intensities(subject, plan, rung, false);
    const double per_m_db =
        200 * phantoms::material(std::string(name)).attenuation_db_per_cm_mhz * mhz;
    for (std::size_t i = 0; i < std::size(kRanges_m); ++i) {
      const double found_db = 10 * std::log10(with[i].mean() / without[i].mean());
      const double expected_db =
          band.level_db(per_m_db * kRanges_m[i], plan.probe().center_frequency_hz, kRanges_m[i]);
      report.point("level " + sim::to_string(rung) + " " + std::string(table_name(preset)) + " " +
                       std::string(name),
                   {"range_mm", kRanges_m[i] * 1e3},
                   {"level_db", found_db, expected_db});
      if (std::abs(found_db - expected_db) <= worst.difference_db) continue;
      worst = {std::abs(found_db - expected_db),
               std::string(name) + " at " + significant(kRanges_m[i] * 1e3, 3) + " mm: " +
                   significant(found_db, 4) + " dB, table " + significant(expected_db, 4) + " dB"};
    }
  }
  return worst;
}

}  // namespace

void add_tissue_levels(StudyReport& report) {
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    std::vector<std::uint64_t> seeds(seeds_of(rung));
    std::iota(seeds.begin(), seeds.end(), 1);
    for (const hw::ProbePreset preset : kPresets) {
      const Worst worst = worst_of(rung, preset, report);
      report
          .check("attenuation.level." + sim::to_string(rung) + "." +
                 std::string(table_name(preset)))
          .at_most(worst.difference_db, kBar_db, "dB")
          .from("worst: " + worst.where)
          .over(static_cast<long>(std::size(kMaterials) * std::size(kRanges_m)), "levels", seeds);
    }
  }
}

}  // namespace wobblebench::bench
