// Mean echo power along a stick, as the beam averages it: what lies within the beam's width and the
// pulse's length echoes together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/beam/beam_nodes.h"
#include "sim/receive/losses.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// A surface close to the axis is taken as flat across the beam. The share of the beam that lies
/// inside it is then the Gaussian's distribution function of its distance over the beam's width
/// along the normal, in closed form; also where the axis passes the surface by.
class MeanPower {
 public:
  /// `reach_m`: as for BeamNodes.
  MeanPower(const hw::AcquisitionPlan& plan,
            const SimulationOptions& options,
            const std::vector<phantoms::Material>& materials,
            double spacing_m,
            int samples,
            double reach_m);

  /// Mean power at each sample of `losses.left()`, zero beyond. With speckle, that of its Rayleigh
  /// envelope, whose mean is the material's backscatter; without, the backscatter squared. False:
  /// nothing echoes, and all are zero.
  bool compute(const StickTrack& track, const StickLosses& losses, std::span<float> power);

  /// Longest distance at which a surface within the field touches the beam: three of the power's
  /// sigma, where the beam is widest, but at most 4 mm.
  static double reach_m(const hw::AcquisitionPlan& plan);

  /// The nodes before and behind a sample.
  struct Between {
    BeamNodes::Node near;
    BeamNodes::Node far;
  };

 private:
  /// A piece of the track, and its samples.
  struct Section {
    const TrackPiece* piece;
    std::size_t first;
    std::size_t count;

    /// Clear of surfaces, and no shorter than what a wide loop spills over a section's end.
    bool clear() const;
  };

  void find_pieces(const StickTrack& track, const StickLosses& losses);
  float base_power(const Section& section) const {
    return material_power_[static_cast<std::size_t>(section.piece->base)];
  }
  void begin(const StickTrack& track, const Section& section);
  void set_layer(const StickTrack& track, const Section& section, int layer);
  void paint_first_layers();
  void blend(std::size_t first, std::size_t count);
  void paint_over(const StickTrack& track, const Section& section, int layer);

  double spacing_m_;
  BeamNodes nodes_;
  std::vector<float> material_power_;
  std::vector<Section> sections_;
  // Of each sample.
  std::vector<std::int32_t> node_;
  std::vector<float> share_;  ///< of the way to the next node
  std::vector<Between> between_;
  std::vector<float> inside_;  ///< power of the tissue behind the surface
  std::vector<float> tissue_;
  std::vector<float> sheet_;
};

}  // namespace wobblebench::sim
