// What `trade` measures of one point on one scene and seed.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "bench/evaluation/evaluator.h"
#include "bench/evaluation/measures/picture_measures.h"

namespace wobblebench::bench {

/// Which measurement of a plan: the smallest piece of its work.
struct TradeUnit {
  std::size_t scene = 0;  ///< numbers of the plan
  std::size_t point = 0;
  std::size_t seed = 0;

  bool operator==(const TradeUnit&) const = default;
  bool operator<(const TradeUnit& other) const {
    return std::tie(scene, point, seed) < std::tie(other.scene, other.point, other.seed);
  }
};

/// Names of a record's measures, with their units.
const std::vector<std::string>& trade_measure_names();
/// In their order; NaN: not formed, as without a surface in view.
std::vector<double> trade_measures(const PictureMeasures& measures);
/// Position of a name. Throws std::out_of_range.
std::size_t trade_measure(const std::string& name);

struct TradeRecord {
  TradeUnit unit;
  std::string refused;  ///< the line that refused the point; empty: it was measured
  std::vector<double> measures;
  /// Medians over the repeats, and their ratios to the reference's picture, taken in turn.
  /// `volume`: all passes; `view`: passes 2 to 4.
  double volume_ms = 0, view_ms = 0, volume_ratio = 0, view_ratio = 0;
  /// Wall times of the evaluation that the measures are from: making the renderer with its first
  /// picture's shaders and sticks, the picture, the truth where it is a new view, the measures.
  EvaluationTimes evaluation;
};

}  // namespace wobblebench::bench
