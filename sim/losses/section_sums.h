// Two-way power from sample points across the beam, where parts of the aperture are covered; and
// the vectorised loops over the lines of a frame.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/losses/aperture_paths.h"
#include "sim/losses/loss_table.h"

namespace wobblebench::sim {

/// Position among the frames, for each line, of a point that lies `aside_m` across the image plane
/// of frame `frame`: the frame before it, and the fraction of the distance to the next. Positions
/// are clamped to the volume.
void locate_frames(int frame,
                   int frames,
                   float aside_m,
                   const float* frames_per_m,
                   int lines,
                   std::int32_t* before,
                   float* share);

/// For the sticks of a row at a node: one-way amplitude on the axis, and the material.
struct Reaching {
  const float* amplitude;
  const float* material;
};

/// Sums of waves at a sample point, for each line.
struct WaveRow {
  double* real;
  double* imaginary;
};

/// Mean echo power of tissue in the image plane: the sum over the sample points of |transmitted|^2
/// |received|^2, where each factor is the sum of the parts' waves times the amplitudes of their
/// paths to the point. The paths to a point beside a stick are those to the neighbouring stick
/// there, or, where that stick is in another material, those to the stick itself. Powers are
/// relative to those on the stick's axis. Holds the working memory of one thread.
class LateralSum {
 public:
  /// All must outlive it.
  LateralSum(const ApertureCone& cone, const BeamSection& section, const LossGrid& grid);

  /// Mean amplitudes of the paths from a part on each line, relative to the axis; the caller fills
  /// them.
  float* paths(int end, int part) { return row(end * ApertureCone::kLateral + part) + margin_; }
  /// Power on each line for these paths, which are the paths to `node`. `reaching`: values of each
  /// line.
  const double* power(int node, const Reaching& reaching);

 private:
  static constexpr int kPaths = ApertureCone::kEnds * ApertureCone::kLateral;
  static constexpr int kRows = kPaths + 2;

  float* row(int number) {
    return rows_.data() +
           static_cast<std::size_t>(number) * static_cast<std::size_t>(grid_.lines + 2 * margin_);
  }
  void extend(int number);
  void weigh(float aside, const Reaching& reaching);
  void sum_waves(int end, int node, int point);
  WaveRow sum(int end);

  const ApertureCone& cone_;
  const BeamSection& section_;
  LossGrid grid_;
  int margin_;               ///< lines beyond the first and the last, with their values
  std::vector<float> rows_;  ///< kPaths rows, then the two of Reaching
  std::vector<float> shares_;
  std::vector<float> weights_[3];  ///< of the two sticks beside a point, and of the stick itself
  std::vector<double> sums_;       ///< [end][real, imaginary][line]
  std::vector<double> power_;
};

/// The same across the image plane, for the sticks of one line in neighbouring frames.
class ElevationSum {
 public:
  /// All must outlive it.
  ElevationSum(const BeamSection& section, const LossGrid& grid, const LossTable& table);

  /// Power on each line of a frame, divided by the fourth power of the mean amplitude of the
  /// frame's own parts. `parts`: [frame][node][part][line] with ApertureCone::kElevation parts,
  /// one-way amplitudes that arrive on the paths from each part (ConeMean::follow()). Frames within
  /// BeamSection::most_frames() are read.
  const double* power_over_mean(int frame, int node, const float* parts);

 private:
  void weigh(int frame, int node, int point);
  void sum_waves(int frame, int node, int point, const float* parts);
  /// Index in `parts`.
  std::ptrdiff_t row(int frame, int node, int part) const {
    const auto number =
        (static_cast<std::ptrdiff_t>(frame) * grid_.nodes + node) * ApertureCone::kElevation + part;
    return number * grid_.lines;
  }
  /// Calls `run(first, count, before)` for each run of lines that have the same frame before a
  /// point.
  template <class Run>
  void for_runs(Run run) const;

  const BeamSection& section_;
  LossGrid grid_;
  const LossTable& table_;
  std::vector<std::int32_t> before_;  ///< frame before a point, on each line
  std::vector<float> shares_[2];      ///< of that frame and the next
  std::vector<float> weights_[3];     ///< of the two sticks beside a point, and of the stick itself
  std::vector<float> whole_;          ///< 1 for each line
  std::vector<double> sums_;          ///< [real, imaginary][line]
  std::vector<double> power_;
};

}  // namespace wobblebench::sim
