// Mean echo power along a stick, averaged over the beam's width and the pulse's length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/losses/tissue_gain.h"
#include "sim/rungs/beam_nodes.h"

namespace wobblebench::sim {

/// A surface close to the axis is treated as flat across the beam. The fraction of the beam's power
/// inside it is then the Gaussian distribution function of its distance in units of the beam's
/// width along the normal. This closed form also holds where the axis does not cross the surface.
class MeanPower {
 public:
  /// `reach_m`: as for BeamNodes.
  MeanPower(const ProbeOptics& optics,
            const SimulationOptions& options,
            const std::vector<phantoms::Material>& materials,
            double spacing_m,
            int samples,
            double reach_m);

  /// Computes the mean power at each sample of `losses.remaining()`, 0 beyond. With speckle it is
  /// the power of a Rayleigh envelope whose mean is the material's backscatter; without speckle it
  /// is the squared backscatter. `theta_rad`: angle of the stick. Returns false if there are no
  /// echoes, and `power` is all 0.
  bool compute(const StickTrack& track,
               const StickLosses& losses,
               double theta_rad,
               std::span<float> power);

  /// Largest distance at which a surface affects the beam: three standard deviations of the beam's
  /// power where it is widest, at most 4 mm.
  static double reach_m(const hw::AcquisitionPlan& plan);

  /// The nodes before and behind a sample.
  struct NodePair {
    BeamNodes::Node near;
    BeamNodes::Node far;
  };

 private:
  /// A piece of the track, and its samples.
  struct Section {
    const TrackPiece* piece;
    std::size_t first;
    std::size_t count;

    /// True if the section has no surfaces and is at least as long as the padding that vectorised
    /// loops write behind the section before it.
    bool clear() const;
  };

  void find_sections(const StickTrack& track, const StickLosses& losses);
  float base_power(const Section& section) const {
    return material_power_[static_cast<std::size_t>(section.piece->base)];
  }
  void begin_section(const StickTrack& track, const Section& section);
  void load_layer(const StickTrack& track, const Section& section, int layer);
  void restore_fronts(const TrackLayer& surface, const Section& section);
  void blend_first_layers();
  void blend_layer(const StickTrack& track, const Section& section, int layer);
  void blend(std::size_t first, std::size_t count);

  double spacing_m_;
  BeamAtSamples beam_;
  TissueGain gain_;
  BeamNodes nodes_;
  std::vector<float> material_power_;
  std::vector<Section> sections_;
  // One element per sample.
  std::vector<float> remaining_;     ///< of the echo of tissue, of the current stick
  std::vector<std::int32_t> node_;   ///< node before the sample
  std::vector<float> node_share_;    ///< fraction of the distance to the next node
  std::vector<NodePair> node_pair_;  ///< of the current layer
  std::vector<float> inside_;        ///< power of the tissue inside its surface
  std::vector<float> tissue_;        ///< power of the tissue so far
  std::vector<float> interface_;     ///< power of rough interfaces so far
};

}  // namespace wobblebench::sim
