// Mean amplitude over the ways from the aperture to each point of a frame's sticks.
#pragma once

#include <span>
#include <vector>

#include "sim/aperture/cone.h"
#include "sim/aperture/cone_kernels.h"
#include "sim/aperture/loss_table.h"
#include "sim/receive/band_loss.h"

namespace wobblebench::sim {

/// Holds the working memory of one thread.
class ConeMean {
 public:
  /// All must outlive it.
  ConeMean(const ApertureCone& cone,
           const LossGrid& grid,
           const LossTable& table,
           const BandLoss& band);

  /// The nodes of ApertureCorrection, [line][node], of a frame. The table's frames within
  /// ApertureCone::most_frames() must be finished. Returns false, and leaves both as they are, if
  /// losses are even within the cones.
  bool compute(int frame, std::span<float> log_gain, std::span<float> frequency);

 private:
  /// Ways of one part of the aperture, on each line.
  struct Ways {
    std::vector<float> relative;  ///< amplitude over the axis'
    std::vector<float> nepers;    ///< absorbed more than on the axis
  };

  /// Means over the ways of one end, transmit or receive.
  struct EndMean {
    double relative;  ///< as in Ways
    double nepers;    ///< weighted with the amplitudes
  };

  bool find_uneven(int frame);
  void follow_to(int node, int frame);
  void load_axis(int from, int frame);
  void load_rows(int elevation, int from, int to, int frame);
  void blend_frames();
  void extend(std::vector<float>& row) const;
  LossRows rows_at(int lines_aside) const;
  void step(int elevation, int from, int to);
  EndMean end_mean(int end, int node, int line) const;
  void average(int node, int frame, std::span<float> log_gain, std::span<float> frequency);
  Ways& ways(int end, int part) {
    return ways_[static_cast<std::size_t>(end * ApertureCone::kLateral + part)];
  }

  const ApertureCone& cone_;
  const LossGrid& grid_;
  const LossTable& table_;
  const BandLoss& band_;
  int elevations_;            ///< 1: there is one frame
  int margin_;                ///< lines beyond the first and the last, with their values
  std::vector<char> uneven_;  ///< whether ways differ between a node and the next
  std::vector<Ways> ways_;
  const float* planes_[4] = {};  ///< as in LossRows, [frame][line]
  std::vector<float> rows_[4];   ///< as in LossRows, with margins
  std::vector<float> axis_gain_;
  std::vector<float> axis_nepers_;
  std::vector<std::int32_t> before_;  ///< frame before a way, on each line
  std::vector<float> between_;        ///< share of the distance to the next
};

}  // namespace wobblebench::sim
