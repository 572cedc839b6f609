// The samples of the preset `clinical` against figures of real fetal volumes.
#pragma once

#include <array>
#include <cstdint>

#include "bench/studies/validate/common/study_report.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// What is counted in the samples of one volume of the default face, as grey levels of 8 bits.
struct GreyStatistics {
  static constexpr std::array<double, 5> kPercent{5, 25, 50, 75, 95};

  double zero_in_fluid_percent = 0;  ///< of the samples between the uterine wall and the face
  double full_percent = 0;           ///< of the samples that are not zero: those at full scale
  std::array<double, 5> grey{};      ///< percentiles of the samples that are not zero
  /// Length along the sticks of the skin's bright band: where the mean of the sticks in the middle
  /// of the field, each read from its first skin on, is above half of full scale.
  double skin_m = 0;
  long fluid_samples = 0;
  long samples = 0;  ///< that are not zero
};

/// Counted where the phantom's own materials say what a sample is of.
GreyStatistics measure_grey(const sim::SimulationOptions& options);

StudyReport clinical_report();

}  // namespace wobblebench::bench
