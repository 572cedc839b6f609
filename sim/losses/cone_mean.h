// Losses on the ray paths from the aperture to each point of a frame's sticks, relative to the
// axis.
#pragma once

#include <span>
#include <vector>

#include "sim/losses/aperture_paths.h"
#include "sim/losses/loss_table.h"
#include "sim/losses/losses.h"
#include "sim/losses/section_sums.h"

namespace wobblebench::sim {

/// row[i] = (1 - share[i]) * near[i] + share[i] * far[i]. It never rounds to 0
/// where both values are positive.
void interpolate(const float* near, const float* far, const float* share, int count, float* row);

/// Rows of a LossTable at a node and the next one.
struct LossRows {
  const float* near_transmitted;
  const float* near_absorbed;
  const float* far_transmitted;
  const float* far_absorbed;
};

/// Continues paths by one step: multiplies `relative`, the amplitude of a path relative to that of
/// the axis, and adds to `nepers`, the absorption of a path minus that of the axis. The path lies
/// between entries i and i + 1 of `rows`, at the fraction `share`.
void step_paths(const LossRows& rows,
                float share,
                const float* axis_gain,
                const float* axis_nepers,
                int lines,
                float* relative,
                float* nepers);

/// Computes the nodes of ApertureCorrection in two steps: follow() for the image plane,
/// add_elevation() across it, which needs the results of follow() for neighbouring frames. Holds
/// the working memory of one thread.
class ConeMean {
 public:
  /// All must outlive it.
  ConeMean(const ApertureCone& cone,
           const BeamSection& section,
           const LossGrid& grid,
           const LossTable& table,
           const BandLoss& band);

  /// Number of floats of a frame's elevation parts, [node][part][line].
  static std::size_t parts_size(const LossGrid& grid);

  /// Computes the corrections [line][node] of a frame for the paths and sample points in the image
  /// plane, and for each part across the image plane the one-way amplitude that arrives on its
  /// paths, averaged over the beam in the image plane. The LossTable must be finished for all
  /// frames that a path crosses. Nodes before the losses first differ between sticks stay 0.
  void follow(int frame,
              std::span<float> log_gain,
              std::span<float> frequency,
              std::span<float> parts);
  /// Adds the correction for the sample points across the image plane. `parts`: results of follow()
  /// for all frames; follow() must have computed those within BeamSection::most_frames().
  void add_elevation(int frame, std::span<const float> parts, std::span<float> log_gain);

  /// Limits how far a stick lies below both neighbours of its frame, as results of add_elevation()
  /// have them, where all three were in one material on the step to a node.
  void lift_lone_sticks(int frame, std::span<float> log_gain) const;

  /// True if the losses differ anywhere within reach of a frame's paths and sample points.
  bool differs(int frame) const { return first_differing(frame) < grid_.nodes; }

 private:
  /// Paths from a part of the aperture, on each line.
  struct RayPaths {
    std::vector<float> relative;  ///< amplitude relative to the axis
    std::vector<float> nepers;    ///< absorption minus that of the axis
  };

  int first_differing(int frame) const;
  bool share_material(int node, int frame, int line) const;
  void find_differing(int frame);
  void follow_to(int node, int frame);
  void load_axis(int from, int frame);
  void load_rows(int elevation, int from, int to, int frame);
  void blend_frames();
  void extend(std::vector<float>& row) const;
  LossRows rows_at(int lines_aside) const;
  void step(int elevation, int from, int to);
  double nepers_aside(int end, int node, int line) const;
  /// Returns the power of each line relative to that on its axis.
  const double* average(int node, int frame, std::span<float> log_gain, std::span<float> frequency);
  /// `power`: result of average(); null where it is 1.
  void average_parts(int node, int frame, const double* power, float* parts) const;
  void load_lateral();
  std::size_t path(int end, int lateral, int elevation) const {
    return static_cast<std::size_t>((end * ApertureCone::kLateral + lateral) * elevations_ +
                                    elevation);
  }

  const ApertureCone& cone_;
  const BeamSection& section_;
  const LossGrid& grid_;
  const LossTable& table_;
  const BandLoss& band_;
  int elevations_;               ///< 1 where there is only one frame
  int margin_;                   ///< lines beyond the first and the last, with their values
  std::vector<char> differs_;    ///< whether losses differ between a node and the next
  std::vector<RayPaths> paths_;  ///< [end][lateral][elevation]
  LateralSum lateral_;
  ElevationSum elevation_;
  const float* planes_[4] = {};  ///< as in LossRows, [frame][line]
  std::vector<float> rows_[4];   ///< as in LossRows, with margins
  std::vector<float> axis_gain_;
  std::vector<float> axis_nepers_;
  std::vector<std::int32_t> before_;  ///< frame before a path, on each line
  std::vector<float> between_;        ///< share of the distance to the next
};

}  // namespace wobblebench::sim
