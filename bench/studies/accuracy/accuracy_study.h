// Every measure for scenes, rungs, seeds and render settings: the measurements of the command
// `accuracy`.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/evaluation/bound/spacing_error.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/studies/evaluator/evaluator.h"

namespace wobblebench::bench {

/// One scene of the study. Its first setting is the one that others are compared with.
struct AccuracyScene {
  std::string name;
  struct Setting {
    std::string name;
    Scene scene;          ///< the same as of the first but for [render]
    std::string command;  ///< `run` of it, but for rung and seed
  };
  std::vector<Setting> settings;
  std::vector<sim::Rung> rungs;
  std::vector<std::uint64_t> seeds;
  /// One of a population: `name` is its stratum, which other scenes are of, too. Bounds are left
  /// out then, pictures are of the stratum's first scene, and a phantom that cannot be built is a
  /// note.
  bool drawn = false;
};

/// A row of accuracy.csv.
struct AccuracyRow {
  std::string scene;
  std::string rung;
  std::string setting;
  std::uint64_t seed = 0;
  MeasureRow measures;
  /// Time of the picture: all passes of a new volume, rendered once more; NaN in rows of regions.
  double render_ms = 0;
};

/// Statistics over the seeds of one scene, rung, setting and region.
struct AccuracySummary {
  std::string scene, rung, setting, group, region;
  std::vector<MeanInterval> means;        ///< of each of picture_measures()
  std::vector<MeanInterval> differences;  ///< to the first setting, paired; empty: it is the first
  MeanInterval render_ms, render_ratio;   ///< the ratio is to the first setting's; none of regions
};

/// What a perfect detector could reach in a scene's first view, outside the band at silhouettes
/// (docs/decisions/0030-detection-bound.md); losses along the stick are left out.
struct AccuracyBound {
  std::string scene;
  double sticks_m = 0;  ///< PictureBound::between_sticks_m
  SpacingError spacing;

  /// The yardstick of a picture's RMS error there.
  double yardstick_m() const { return std::hypot(sticks_m, spacing.rms_m); }
};

/// A picture of the first seed.
struct AccuracyPicture {
  std::string scene, rung, setting;  ///< setting "truth": the true surface, shaded alike
  Image<glm::vec3> surface;
};

struct AccuracyResults {
  std::vector<std::uint64_t> seeds;
  std::vector<AccuracyRow> rows;
  std::vector<AccuracySummary> summaries;  ///< in the order of the rows
  std::vector<AccuracyPicture> pictures;
  /// The command that makes the first seed's picture again, by scene, rung and setting.
  std::map<std::array<std::string, 3>, std::string> commands;
  std::vector<AccuracyBound> bounds;  ///< of scenes with a surface in view
  std::vector<std::string> notes;     ///< scenes without a surface in view, and why
  EvaluationTimes times;              ///< sums over all evaluations
  int evaluations = 0;
  bool of_population = false;  ///< scenes are strata, and seeds are those of their scenes
};

/// What is being evaluated, for the progress line.
using AccuracyNote = std::function<void(const std::string&)>;

/// The number of evaluations.
std::size_t accuracy_parts(const std::vector<AccuracyScene>& scenes);

/// Throws as Evaluator does.
AccuracyResults measure_accuracy(const std::vector<AccuracyScene>& scenes,
                                 render::GlContext& context,
                                 PhantomCache& cache,
                                 const PartDone& done = {},
                                 const AccuracyNote& note = {});

/// Means over seeds and paired differences.
std::vector<AccuracySummary> summarise(const std::vector<AccuracyRow>& rows,
                                       const std::string& reference);

}  // namespace wobblebench::bench
