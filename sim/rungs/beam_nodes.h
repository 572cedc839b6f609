// Surfaces near a stick relative to the beam: at each node of a track, the distance to the surface
// in units of the beam's width, and the echo power of its rough interface.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/optics/beam_profile.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::phantoms {
struct Material;
}

namespace wobblebench::sim {

struct SimulationOptions;
class StickLosses;

/// Mean power divided by the squared mean envelope, which the material table gives:
/// kPowerOfRayleighMean with speckle, 1 without.
double mean_power_gain(const SimulationOptions& options);

class BeamNodes {
 public:
  struct Node {
    float distance_sigmas = 0;  ///< distance to the surface, in standard deviations of the beam's
                                ///< power along its normal
    float interface_power = 0;  ///< peak of the mean power of the rough interface's speckle
  };

  /// Surfaces farther away than this number of standard deviations of the beam's power are ignored.
  static constexpr double kReachSigmas = 3;

  /// `reach_m`: largest distance of the surfaces in a track; the beam is narrowed where
  /// kReachSigmas exceed it.
  BeamNodes(const ProbeOptics& optics,
            const SimulationOptions& options,
            const std::vector<phantoms::Material>& materials,
            double spacing_m,
            int samples,
            double reach_m);

  /// Computes the nodes of one stick; reuses the memory of the stick before. `beam`: values at each
  /// sample.
  void compute(const StickTrack& track, const StickLosses& losses, const BeamAtSample* beam);

  /// The nodes of a layer; at least one more can be read behind them.
  const Node* of(const TrackLayer& layer) const { return nodes_.data() + layer.first_node; }

  /// A node just behind its surface. The interface's echo there has the amplitude that remains at
  /// the last sample before the surface.
  struct Front {
    int node;
    int before;  ///< sample
  };
  /// The fronts of a layer with `nodes` nodes, in ascending order.
  std::span<const Front> fronts_of(const TrackLayer& layer, int nodes) const;

 private:
  /// An interface, in the direction of propagation.
  struct Crossing {
    float impedance_before = 1;
    float impedance_behind = 1;
    float speed_ratio2 = 1;  ///< squared sound speed behind it relative to before it
    float roughness = 0;     ///< diffuse fraction of the echo; 0: no echo
  };
  friend struct NodeKernels;

  void look_up(const StickTrack& track, const StickLosses& losses, const BeamAtSample* beam);
  void find_front(const StickTrack& track, const StickLosses& losses, int node, double range_m);
  const Crossing& crossing(phantoms::MaterialIndex before, phantoms::MaterialIndex behind) const {
    return crossings_[static_cast<std::size_t>(before) * materials_ +
                      static_cast<std::size_t>(behind)];
  }

  std::size_t materials_;
  bool interface_echo_;
  double spacing_m_;
  float pulse2_;          ///< variance of the pulse's power
  float max2_;            ///< largest variance that the reach allows
  float interface_gain_;  ///< factor of an interface's power: pulse and speckle statistics
  int samples_;
  std::vector<Crossing> crossings_;  ///< [before][behind]
  std::vector<BeamAtSample> beam_;   ///< at each node
  std::vector<Crossing> crossed_;    ///< at each node
  std::vector<TrackNode> surfaces_;  ///< the track's nodes, padded
  std::vector<Front> fronts_;
  std::vector<Node> nodes_;
};

}  // namespace wobblebench::sim
