// What surrounds the fetal head, in the phantom frame: amniotic cavity, body, hand and cord.
#pragma once

#include "phantoms/shapes/csg_body.h"

namespace wobblebench::phantoms {

/// All lengths are those of the 21-week fetus times `scale`.
CsgBody make_body(double scale);
CsgBody make_hand(double scale);

/// Three strands twisted about a curve beside the face.
class UmbilicalCord {
 public:
  explicit UmbilicalCord(double scale);
  double distance(const glm::dvec3& position) const;

  /// A cord with the same distance() to the bit at every position in the ball.
  UmbilicalCord near(const Ball& ball) const;

 private:
  // A strand in pieces with bounds, so that distant pieces are skipped.
  struct Piece {
    Tube tube;
    Ball bound;
  };
  using Strand = std::vector<Piece>;
  static Strand divided(const Tube& tube);
  static Strand near(const Strand& strand, const Ball& ball);
  static double strand_distance(const Strand& strand, const glm::dvec3& position);

  std::vector<Strand> strands_;
  Ball bound_;
};

/// Signed distance of the wall of the amniotic cavity, a slightly irregular superellipsoid; within
/// some percent inside the narrow band.
double cavity_distance(const glm::dvec3& position, double scale);

/// Centre and semi-axes of the cavity.
struct CavitySize {
  glm::dvec3 center_m;
  glm::dvec3 radii_m;
};
CavitySize cavity_size(double scale);

}  // namespace wobblebench::phantoms
