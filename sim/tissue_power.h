// Mean echo power along a stick, as the beam averages it: what lies within the beam's width and the
// pulse's length echoes together.
#pragma once

#include <span>
#include <vector>

#include "sim/losses.h"
#include "sim/stick_track.h"

namespace wobblebench::sim {

/// A surface close to the axis is taken as flat across the beam. The share of the beam that lies
/// inside it is then the Gaussian's distribution function of its distance over the beam's width
/// along the normal, in closed form; also where the axis passes the surface by.
class TissuePower {
 public:
  /// `reach_m`: distances to surfaces are known this far; where the beam is wider than that
  /// (a third of it is one sigma), it is narrowed to it.
  TissuePower(const hw::AcquisitionPlan& plan,
              const SimulationOptions& options,
              const std::vector<phantoms::Material>& materials,
              double spacing_m,
              int samples,
              double reach_m);

  /// Mean power at each sample of `losses.left()`, zero beyond. With speckle, that of its Rayleigh
  /// envelope, whose mean is the material's backscatter; without, the backscatter squared.
  void compute(const StickTrack& track, const StickLosses& losses, std::span<float> power);

  /// Longest distance at which a surface within the field touches the beam: three of the power's
  /// sigma, where the beam is widest, but at most 4 mm.
  static double reach_m(const hw::AcquisitionPlan& plan);

 private:
  struct Widths {
    float lateral2 = 0;  ///< squared sigma of the two-way power
    float elevation2 = 0;
  };
  /// One surface at the nodes of a piece.
  struct Layer {
    std::vector<float> depth;  ///< distance over the beam's width along the normal
    std::vector<float> sheet;  ///< power of the rough interface at its peak
    float power = 0;           ///< of the tissue inside
    enum { beside, around, partly } cover = partly;
  };

  /// The first of samples [first, end) that does not lie before a range.
  int first_beyond(double range_m, int first, int end) const;
  float material_power(phantoms::MaterialIndex material) const;
  void fill_clear(const TrackPiece& piece, int first, int last, std::span<float> power) const;
  void prepare(const StickTrack& track,
               const StickLosses& losses,
               const TrackPiece& piece,
               int layer,
               Layer& prepared) const;
  float sheet_power(const StickTrack& track,
                    const StickLosses& losses,
                    const TrackPiece& piece,
                    int layer,
                    int node,
                    float width) const;
  /// A sheet is reached with what is left before it; a place behind it has lost its transmission.
  double front_gain(const StickTrack& track,
                    const StickLosses& losses,
                    const TissueMap::LineNode& node,
                    double range_m) const;
  void blend(const TrackPiece& piece,
             const StickLosses& losses,
             int first,
             int last,
             std::span<float> power);

  const std::vector<phantoms::Material>* materials_;
  SimulationOptions options_;
  double spacing_m_;
  float pulse2_;                     ///< squared sigma of the pulse's power
  float most2_;                      ///< squared sigma that the reach allows
  std::vector<Widths> widths_;       ///< at each sample
  std::vector<float> tissue_power_;  ///< of each material
  std::vector<Layer> layers_;
  std::vector<float> place_, tissue_, sheet_;
};

}  // namespace wobblebench::sim
