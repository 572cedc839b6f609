// Which parcels of tissue a stick's beam passes: a tube around the axis that is as wide at each
// range as the beam.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "sim/beam/beam_table.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// A linear map from the tissue's rest frame to beam coordinates (axial, lateral, elevation;
/// metres).
struct RestToBeam {
  glm::dmat3 turn{1.0};
  glm::dvec3 shift{0};

  glm::dvec3 operator()(const glm::dvec3& rest_m) const { return turn * rest_m + shift; }
};

/// Tissue as one stick sees it.
class StickView {
 public:
  StickView(const ScannedTissue& subject, const Sightline& line);

  /// Where a place at rest is now, in beam coordinates, and back.
  glm::dvec3 to_beam(const glm::dvec3& rest_m) const;
  glm::dvec3 to_rest(const glm::dvec3& beam_m) const;

  bool rigid() const { return rigid_; }
  /// The map of all tissue, if it moves as one.
  const RestToBeam& map() const { return whole_[0]; }
  /// How tissue moves within a distance of a place at rest, and the map of what moves as one.
  phantoms::Deformation::Turn turn_within(const glm::dvec3& rest_m, double radius_m) const {
    return moment_.turn_within(rest_m, radius_m);
  }
  const RestToBeam& whole(phantoms::Deformation::Turn turn) const {
    return whole_[static_cast<std::size_t>(turn)];
  }
  /// The map near a place: exact there, and to first order around it.
  RestToBeam map_near(const glm::dvec3& rest_m) const;

 private:
  const ScannedTissue& subject_;
  hw::Ray ray_;
  AcrossStick across_;
  phantoms::Deformation moment_;
  bool rigid_;
  RestToBeam whole_[2];  ///< of what rests, and of what turns as a whole

  RestToBeam seen(const phantoms::Deformation::Tangent& tangent, const glm::dvec3& rest_m) const;
};

/// Widths of the tube along the stick, each the largest within a distance.
class BeamBounds {
 public:
  /// `margin_m`: half the diagonal of the parcels that will be asked for.
  BeamBounds(const BeamTable& table, double depth_m, double margin_m);

  struct Reach {
    double lateral_m;
    double elevation_m;
  };
  /// Widest reach within the margin of a range.
  const Reach& reach(double range_m) const;
  /// Of the whole tube.
  const Reach& widest() const { return widest_; }

 private:
  std::vector<Reach> reach_;
  double per_m_;
  Reach widest_{0, 0};
};

/// A lattice of parcels at rest.
struct ParcelGrid {
  glm::dvec3 origin_m{0};
  double side_m = 0;
  glm::ivec3 first{0};  ///< parcels beyond these two are never touched
  glm::ivec3 last{0};

  glm::dvec3 center(const glm::ivec3& index) const {
    return origin_m + side_m * (glm::dvec3(index) + 0.5);
  }
};

/// Parcels that touch the tube up to a range, each once, in an order that depends on the view
/// alone. `centers` are where they are now, in beam coordinates.
struct TouchedParcel {
  glm::ivec3 index{0};
  glm::dvec3 center{0};
};
void find_touched(const StickView& view,
                  const BeamBounds& tube,
                  const ParcelGrid& lattice,
                  double end_m,
                  std::vector<TouchedParcel>& touched);

}  // namespace wobblebench::sim
