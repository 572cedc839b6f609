// Two-way losses along a stick.
#pragma once

#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/losses/losses.h"
#include "sim/options.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// Correction of a stick's losses for the ray paths beside its axis, at equidistant nodes of true
/// range, the first at the face. From one node to the next it changes as the stick's own loss does:
/// behind a total reflection it has at once the value of the next node. Empty: no correction.
struct ApertureCorrection {
  double step_m = 0;
  std::span<const float> log_gain;   ///< natural logarithm of the factor on the two-way amplitude
  std::span<const float> frequency;  ///< added to frequency_ratio()

  bool empty() const { return log_gain.empty(); }
};

/// The samples just behind an interface that loses much, where the beam still hears what lies
/// before it: parts of the same interface beside the axis, which are farther away.
struct InterfaceFront {
  phantoms::MaterialIndex before;
  phantoms::MaterialIndex behind;
  int first;  ///< samples
  int end;
  float remaining;  ///< two-way amplitude before the interface
};

/// The last of the fronts of such an interface that contains a sample; null: none.
const InterfaceFront* front_at(std::span<const InterfaceFront> fronts,
                               phantoms::MaterialIndex before,
                               phantoms::MaterialIndex behind,
                               int sample);

/// The amplitude that remains along a stick, and the apparent ranges: the ranges that the scanner
/// computes from the time of flight with one assumed sound speed. Samples lie at the apparent
/// ranges (i + 1/2) * spacing_m. Holds the working memory of one thread.
class StickLosses {
 public:
  /// remaining() extends this far behind the last visible interface, because the beam's footprint
  /// spreads the interface's echo over this range.
  static constexpr double kBehindInterface_m = 4e-3;
  /// Upper bound of the one-way loss at the centre frequency: 600 dB.
  static constexpr double kMostNepers = 69;

  /// `materials` must outlive it.
  StickLosses(const hw::AcquisitionPlan& plan,
              const SimulationOptions& options,
              const std::vector<phantoms::Material>& materials,
              double spacing_m,
              int samples);

  /// Computes one stick; reuses the memory of the stick before.
  void compute(const StickTrack& track, const ApertureCorrection& correction = {});

  /// Two-way amplitude that remains of a mirror's echo at each sample, after the transmission
  /// 1 - R^2 of each interface and the absorption of the pulse's band (BandLoss). Ends where an
  /// echo is invisible, but not within kBehindInterface_m of a visible interface; never 0.
  const std::vector<float>& remaining() const { return remaining_; }
  /// Number of samples up to the last visible one.
  int visible_samples() const { return visible_samples_; }
  /// BandLoss::frequency_ratio() at each sample of remaining(); empty where no material absorbs.
  const std::vector<float>& frequency_ratio() const { return frequency_ratio_; }
  /// Two-way amplitude that remains at each interface of the track; 0 beyond the last sample.
  const std::vector<double>& at_interface() const { return at_interface_; }
  /// The fronts within remaining(), nearest first.
  const std::vector<InterfaceFront>& fronts() const { return fronts_; }
  /// Apparent minus true range at each sample of remaining(); empty where sound has one speed.
  const std::vector<float>& delay_m() const { return delay_m_; }
  /// Apparent range of a true range.
  double apparent_m(const StickTrack& track, double true_m) const;
  /// Number of samples that lie before an apparent range.
  int samples_before(double range_m) const;

 private:
  struct LevelLine;
  /// Propagation from the face to the near end of a stretch.
  struct PathState {
    double apparent_m = 0;
    double transmitted = 1;
    double reflected = 0;  ///< the same in nepers
    double nepers = 0;     ///< absorbed
    bool lost = false;     ///< behind a total reflection
  };

  double speed_ratio(phantoms::MaterialIndex material) const {
    return speed_ratio_[static_cast<std::size_t>(material)];
  }
  void find_losses_at_nodes(const StickTrack& track);
  /// Share of the loss from a node to the next that lies before a range; `passed`: nepers lost up
  /// to there.
  double share_passed(std::size_t node, double true_m, double passed) const;
  double level(const PathState& path, double true_m) const;
  void cross(const StickTrack& track, std::size_t interface, PathState& path);
  void append(const PathState& path, const Stretch& stretch, int end);
  /// Fill the samples from `first` on, by the losses on the axis or with the correction.
  void fill_on_axis(const LevelLine& line, double amplitude, int first);
  void fill_corrected(const LevelLine& line, double true_m, double true_step_m, int first);
  /// Adds a correction, given at its nodes, to `values`; the first is at true_m.
  void add_correction(const LevelLine& line,
                      std::span<const float> nodes,
                      double true_m,
                      double true_step_m,
                      std::span<float> values) const;
  void append_delays(const Stretch& stretch, double from_m);
  bool is_visible(float amplitude) const { return static_cast<double>(amplitude) > visible_; }
  void end_where_invisible(int first);
  void trim();

  SimulationOptions options_;
  TissueLosses tissue_;
  BandLoss band_;
  std::vector<double> speed_ratio_;  ///< of each material: assumed sound speed over its own
  bool absorbs_ = false;             ///< true if a material absorbs
  double spacing_m_;
  int samples_;
  double visible_;
  ApertureCorrection correction_;  ///< of the current stick
  std::vector<double> at_node_;    ///< nepers lost on the axis up to each node of the correction
  int keep_ = 0;                   ///< number of samples that are kept even if invisible
  int visible_samples_ = 0;
  std::vector<float> remaining_;
  std::vector<float> frequency_ratio_;
  std::vector<double> at_interface_;
  std::vector<InterfaceFront> fronts_;
  std::vector<float> delay_m_;
  std::vector<double> apparent_from_m_;  ///< of each stretch
};

}  // namespace wobblebench::sim
