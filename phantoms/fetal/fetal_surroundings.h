// What lies about the fetal head, in the phantom frame: fluid, body, hand and cord.
#pragma once

#include "phantoms/shapes/sculpture.h"

namespace wobblebench::phantoms {

/// All lengths of the 21-week fetus times `scale`.
Sculpture sculpt_body(double scale);
Sculpture sculpt_hand(double scale);

/// Three strands wound about a loop beside the face.
class UmbilicalCord {
 public:
  explicit UmbilicalCord(double scale);
  double distance(const glm::dvec3& position) const;

 private:
  // A strand in pieces, each with its bound, so that distant pieces cost little.
  struct Piece {
    Tube tube;
    Ball bound;
  };
  using Strand = std::vector<Piece>;
  static Strand cut(const Tube& tube);
  static double strand_distance(const Strand& strand, const glm::dvec3& position);

  std::vector<Strand> strands_;
  Ball bound_;
};

/// The amniotic cavity: rounded, slightly irregular; the distance of its wall, within some
/// percent as far as the narrow band reaches.
double cavity_distance(const glm::dvec3& position, double scale);

/// Half the extent of the cavity and its centre.
struct CavitySize {
  glm::dvec3 center_m;
  glm::dvec3 radii_m;
};
CavitySize cavity_size(double scale);

}  // namespace wobblebench::phantoms
