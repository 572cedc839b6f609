// Cases at the ends of what options and samples may be, one row each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wobblebench::bench {

/// Where a case's sticks come from: a ball in closed form (test_volumes.h), the simulated probe, or
/// nowhere, where the settings must be refused.
enum class StickSource { ball, simulated };

/// What is done to the samples of a ball: all of them, or the one in the middle of its near side.
enum class SampleChange {
  none,
  all_zero,
  all_one,
  one_nan,
  one_infinity,
  one_minus_infinity,
  one_denormal,
  one_1e30,
};

/// `either`: the settings may be refused before any work, or rendered within the bounds.
enum class MustHappen { render, refuse, either };

struct ExtremeCase {
  std::string name;
  std::vector<std::string> settings;  ///< section.key=value, beside base_settings()
  MustHappen must = MustHappen::render;
  StickSource sticks = StickSource::ball;
  SampleChange change = SampleChange::none;
  bool compared = true;  ///< with the double-precision reference; too slow for large pictures
};

/// What makes scan and picture small, before a case's own settings.
const std::vector<std::string>& base_settings();

/// The cases of every run; those that take long besides.
std::vector<ExtremeCase> extreme_cases();
std::vector<ExtremeCase> long_extreme_cases();

/// Cases whose options are each, with a chance of three in ten, at an end of their range. Numbers
/// that a picture's cost grows with end where base_settings() has them.
std::vector<ExtremeCase> random_extreme_cases(std::uint64_t seed, int count);

}  // namespace wobblebench::bench
