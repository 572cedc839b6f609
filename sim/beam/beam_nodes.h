// The surfaces around a stick as the beam meets them: at each node of a track, how deep in the beam
// a surface lies, and what its rough interface sends back.
#pragma once

#include <span>
#include <vector>

#include "sim/receive/losses.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// Sigma of the power under an amplitude response of this width.
double power_sigma(double amplitude_fwhm);
/// Mean power over the square of the mean envelope that the material table gives: with speckle,
/// that of a Rayleigh envelope.
double mean_power_gain(const SimulationOptions& options);

class BeamNodes {
 public:
  struct Node {
    float depth = 0;  ///< distance to the surface over the beam's width along its normal
    float sheet = 0;  ///< mean power of the rough interface's speckle, at its peak
  };

  /// A surface farther away than this many sigmas of the beam's power is not asked for.
  static constexpr double kReachSigmas = 3;

  /// `reach_m`: distances to surfaces are known this far; where the beam is wider than they allow,
  /// it is narrowed to it.
  BeamNodes(const hw::AcquisitionPlan& plan,
            const SimulationOptions& options,
            const std::vector<phantoms::Material>& materials,
            double spacing_m,
            int samples,
            double reach_m);

  /// For one stick; reuses what the last one needed.
  void compute(const StickTrack& track, const StickLosses& losses);

  /// The nodes of a layer, and at least one more.
  const Node* of(const TrackLayer& layer) const { return nodes_.data() + layer.first_node; }

 private:
  struct Widths {
    float lateral2 = 0;  ///< squared sigma of the two-way power
    float elevation2 = 0;
  };
  /// An interface, from the side that sound comes from.
  struct Crossing {
    float impedance_before = 1;
    float impedance_behind = 1;
    float speed_ratio2 = 1;  ///< behind over before, squared
    float roughness = 0;     ///< 0: no interface
  };
  /// A node just behind its surface. The sheet is reached with what is left before it; what is left
  /// at the node has lost its transmission.
  struct Front {
    std::size_t node;
    double range_m;
  };
  friend struct NodeKernels;

  void look_up(const StickTrack& track);
  const Crossing& crossing(phantoms::MaterialIndex before, phantoms::MaterialIndex behind) const {
    return crossings_[static_cast<std::size_t>(before) * materials_ +
                      static_cast<std::size_t>(behind)];
  }
  void restore_fronts(const StickTrack& track, const StickLosses& losses);

  std::size_t materials_;
  bool interface_echo_;
  double spacing_m_;
  float pulse2_;                     ///< squared sigma of the pulse's power
  float most2_;                      ///< squared sigma that the reach allows
  float sheet_gain_;                 ///< of a sheet's power, by the pulse and its statistics
  std::vector<Widths> widths_;       ///< at each sample
  std::vector<Crossing> crossings_;  ///< [before][behind]
  std::vector<Widths> beam_;         ///< at each node
  std::vector<Crossing> crossed_;    ///< at each node
  std::vector<TissueMap::LineNode> surfaces_;  ///< the track's nodes, and some more
  std::vector<Front> fronts_;
  std::vector<Node> nodes_;
};

}  // namespace wobblebench::sim
