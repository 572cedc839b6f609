// The mother's abdominal wall between the probe and the uterus.
#pragma once

#include "phantoms/phantom.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

/// Where one of its tissues ends, on the axis below the probe's face.
struct MaternalDepths {
  double skin_m = 0;
  double fat_m = 0;
  double muscle_m = 0;  ///< the whole thickness
};

/// Skin 2 mm, at most a fifth of the whole; of the rest 60 % is fat (all assumed).
MaternalDepths maternal_depths(double thickness_m);

/// Bodies about the probe's face, each of which ends where its tissue meets the next: painted
/// muscle, fat, skin. Where the probe presses, tissue follows its face; the deeper, the flatter.
/// Each interface is uneven by its own slow waves. Phantom frame.
class MaternalLayer {
 public:
  /// `face_m`: the point of the probe's face on its axis.
  MaternalLayer(double thickness_m, const glm::dvec3& face_m);

  /// Distances, within some percent as far as the narrow band reaches.
  double skin(const glm::dvec3& p) const { return distance(skin_, p); }
  double fat(const glm::dvec3& p) const { return distance(fat_, p); }
  double muscle(const glm::dvec3& p) const { return distance(muscle_, p); }

  /// Holds all of them.
  Box bounds() const;

 private:
  struct Interface {
    Ellipsoid mean;
    double unevenness_m;
    double phase;
    double wave_on_axis;
  };
  Interface interface(double depth_m) const;
  double distance(const Interface& interface, const glm::dvec3& p) const;

  glm::dvec3 face_m_;
  Interface skin_, fat_, muscle_;
};

}  // namespace wobblebench::phantoms
