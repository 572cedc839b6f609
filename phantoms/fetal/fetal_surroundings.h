// What surrounds the fetal head, in the phantom frame: amniotic cavity, body, hand and cord, and
// the mother's abdominal wall between the probe and the uterus.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "phantoms/phantom.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

/// All lengths are those of the 21-week fetus times `scale`.
CsgBody make_body(double scale);
CsgBody make_hand(double scale);

/// Tubes of a hand with stretched fingers before mouth and chin, at a depth that place_before()
/// changes: fingers and back of the hand, thumb, and last the forearm. The little finger is 0.9079
/// g - 7.804 mm long (Goldstein 1995, to 23 weeks); the others by assumed ratios.
std::vector<Tube> hand_before(double scale, double weeks);
CsgBody united_hand(const std::vector<Tube>& tubes, double fillet_m);

/// Centre line of a cord beside the face, and of one across it.
Tube cord_beside(double scale);
Tube cord_across(double scale);

/// Shift along z by which the tubes, thickened by `thicker_m`, come to lie `gap_m` before a body,
/// to 1e-6 m: the least of their distances. `distance`: signed, of the body.
double place_before(const std::function<double(const glm::dvec3&)>& distance,
                    const std::vector<Tube>& tubes,
                    double thicker_m,
                    double gap_m);

/// Largest of `distance` plus radius over the tubes: negative where all of them lie within a body.
double most_outside(const std::function<double(const glm::dvec3&)>& distance,
                    const std::vector<Tube>& tubes,
                    double thicker_m);

Tube shifted(const Tube& tube, const glm::dvec3& by_m);

/// Signed distance of an anterior placenta on the cavity's front wall, `thickness_m` on the axis of
/// the face and thinner towards its rim, 55 mm from there at 21 weeks (assumed).
double placenta_distance(const glm::dvec3& position, double scale, double thickness_m);

/// Three strands twisted about a curve.
class UmbilicalCord {
 public:
  UmbilicalCord(double scale, const Tube& path);
  /// Radius of the whole cord.
  static double radius_m(double scale);
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

/// Nested bodies around the probe's face, each ending at the interface to the next tissue, in
/// painter's order muscle, fat, skin. The skin follows the face of the probe; deeper interfaces are
/// flatter. Each interface has an undulation of its own. Phantom frame.
class MaternalLayer {
 public:
  /// `face_m`: the point of the probe's face on its axis.
  MaternalLayer(double thickness_m, const glm::dvec3& face_m);

  /// Signed distances, within some percent inside the narrow band.
  double skin(const glm::dvec3& p) const { return distance(skin_, p); }
  double fat(const glm::dvec3& p) const { return distance(fat_, p); }
  double muscle(const glm::dvec3& p) const { return distance(muscle_, p); }

  /// Contains all of them.
  Box bounds() const;

 private:
  struct Interface {
    Ellipsoid mean;
    double undulation_m;
    double phase;
    double wave_at_axis;
  };
  Interface interface(double depth_m) const;
  double distance(const Interface& interface, const glm::dvec3& p) const;

  glm::dvec3 face_m_;
  Interface skin_, fat_, muscle_;
};

}  // namespace wobblebench::phantoms
