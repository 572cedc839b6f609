// What the ways from the aperture to each point of a frame's sticks lose, against the axis.
#pragma once

#include <span>
#include <vector>

#include "sim/losses/band_loss.h"
#include "sim/losses/cone.h"
#include "sim/losses/cone_kernels.h"
#include "sim/losses/loss_table.h"
#include "sim/losses/place_sums.h"

namespace wobblebench::sim {

/// Computes the nodes of ApertureCorrection in two steps: the second needs the first of
/// neighbouring frames. Holds the working memory of one thread.
class ConeMean {
 public:
  /// All must outlive it.
  ConeMean(const ApertureCone& cone,
           const BeamPlaces& places,
           const LossGrid& grid,
           const LossTable& table,
           const BandLoss& band);

  /// Floats of a frame's elevation parts, [node][part][line].
  static std::size_t parts_size(const LossGrid& grid);

  /// Of a frame, [line][node], what ways and places in the image plane change; and for each
  /// part across it the sum of its ways' amplitudes over the axis', by their shares on the array.
  /// All frames that a way passes must be finished. Nodes before which sticks lose the same keep 0.
  void follow(int frame,
              std::span<float> log_gain,
              std::span<float> frequency,
              std::span<float> parts);
  /// Adds what places across the image plane change. `parts`: of all frames; those within
  /// BeamPlaces::most_frames() must have been followed.
  void add_elevation(int frame, std::span<const float> parts, std::span<float> log_gain);

  /// Whether anything in reach of a frame's ways and places differs.
  bool uneven(int frame) const { return first_uneven(frame) < grid_.nodes; }

 private:
  /// Ways of a part of the aperture, on each line.
  struct Ways {
    std::vector<float> relative;  ///< amplitude over the axis'
    std::vector<float> nepers;    ///< absorbed more than on the axis
  };

  int first_uneven(int frame) const;
  void find_uneven(int frame);
  void follow_to(int node, int frame);
  void load_axis(int from, int frame);
  void load_rows(int elevation, int from, int to, int frame);
  void blend_frames();
  void extend(std::vector<float>& row) const;
  LossRows rows_at(int lines_aside) const;
  void step(int elevation, int from, int to);
  double nepers_aside(int end, int node, int line) const;
  void average(int node, int frame, std::span<float> log_gain, std::span<float> frequency);
  void average_parts(int node, float* parts) const;
  void load_lateral();
  std::size_t way(int end, int lateral, int elevation) const {
    return static_cast<std::size_t>((end * ApertureCone::kLateral + lateral) * elevations_ +
                                    elevation);
  }

  const ApertureCone& cone_;
  const BeamPlaces& places_;
  const LossGrid& grid_;
  const LossTable& table_;
  const BandLoss& band_;
  int elevations_;            ///< 1: there is one frame
  int margin_;                ///< lines beyond the first and the last, with their values
  std::vector<char> uneven_;  ///< whether ways differ between a node and the next
  std::vector<Ways> ways_;    ///< [end][lateral][elevation]
  LateralSum lateral_;
  ElevationSum elevation_;
  const float* planes_[4] = {};  ///< as in LossRows, [frame][line]
  std::vector<float> rows_[4];   ///< as in LossRows, with margins
  std::vector<float> axis_gain_;
  std::vector<float> axis_nepers_;
  std::vector<std::int32_t> before_;  ///< frame before a way, on each line
  std::vector<float> between_;        ///< share of the distance to the next
};

}  // namespace wobblebench::sim
