// Two-way power from all places across the beam, behind what covers parts of the aperture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/losses/beam_places.h"
#include "sim/losses/cone.h"
#include "sim/losses/cone_kernels.h"
#include "sim/losses/loss_table.h"

namespace wobblebench::sim {

/// The mean power of tissue's echoes is the sum over the places of |transmitted|^2 |received|^2,
/// each a sum of the waves of the parts, times the amplitudes of their ways to that place. The ways
/// to a place beside a stick are taken to be those to the stick there; where that lies in another
/// material, those to the stick itself: what is heard of it is not this tissue. Powers are relative
/// to those of the stick's axis. Both classes hold the working memory of one thread.
class LateralSum {
 public:
  /// All must outlive it.
  LateralSum(const ApertureCone& cone, const BeamPlaces& places, const LossGrid& grid);

  /// Mean amplitudes of a part's ways on each line, relative to the axis, for the caller to fill.
  float* ways(int end, int part) { return row(end * ApertureCone::kLateral + part) + margin_; }
  /// Power on each line by these ways, which are those to a node. `reaching`: of each line.
  const double* power(int node, const Reaching& reaching);

 private:
  static constexpr int kWays = ApertureCone::kEnds * ApertureCone::kLateral;
  static constexpr int kRows = kWays + 2;

  float* row(int number) {
    return rows_.data() +
           static_cast<std::size_t>(number) * static_cast<std::size_t>(grid_.lines + 2 * margin_);
  }
  void extend(int number);
  void weigh(float aside, const Reaching& reaching);
  void sum_waves(int end, int node, int place);
  WaveRow sum(int end);

  const ApertureCone& cone_;
  const BeamPlaces& places_;
  LossGrid grid_;
  int margin_;               ///< lines beyond the first and the last, with their values
  std::vector<float> rows_;  ///< kWays, then the two of Reaching
  std::vector<float> shares_;
  std::vector<float> weights_[3];  ///< as in PlaceRows
  std::vector<double> sums_;       ///< [end][real, imaginary][line]
  std::vector<double> power_;
};

/// The same across the image plane, for sticks of one line in neighbouring frames.
class ElevationSum {
 public:
  /// All must outlive it.
  ElevationSum(const BeamPlaces& places, const LossGrid& grid, const LossTable& table);

  /// Power on each line of a frame, over the fourth power of the mean amplitude of the frame's own
  /// parts. `parts`: sums of the amplitudes of the ways to each stick, relative to its axis,
  /// [frame] [node][part][line], of ApertureCone::kElevation parts; frames within
  /// BeamPlaces::most_frames() are read.
  const double* power_over_mean(int frame, int node, const float* parts);

 private:
  void weigh(int frame, int node, int place);
  void sum_waves(int frame, int node, int place, const float* parts);
  /// Of the parts.
  std::ptrdiff_t row(int frame, int node, int part) const {
    const auto number =
        (static_cast<std::ptrdiff_t>(frame) * grid_.nodes + node) * ApertureCone::kElevation + part;
    return number * grid_.lines;
  }
  /// Calls `run(first, count, before)` for lines that have the same frame before a place.
  template <class Run>
  void for_runs(Run run) const;

  const BeamPlaces& places_;
  LossGrid grid_;
  const LossTable& table_;
  std::vector<std::int32_t> before_;  ///< frame before a place, on each line
  std::vector<float> shares_[2];      ///< of that frame and the next
  std::vector<float> weights_[3];     ///< as in PlaceRows
  std::vector<float> whole_;          ///< 1 for each line
  std::vector<double> sums_;          ///< [real, imaginary][line]
  std::vector<double> power_;
};

}  // namespace wobblebench::sim
