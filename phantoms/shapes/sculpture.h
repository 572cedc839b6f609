// A body modelled as a sculptor does: lumps added and hollows carved, one after the other, each
// with its fillet.
#pragma once

#include <variant>
#include <vector>

#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

using Shape = std::variant<Ellipsoid, Tube>;

class Sculpture {
 public:
  void add(const Shape& shape, double fillet_m) {
    strokes_.push_back(stroke(shape, fillet_m, false));
  }
  void carve(const Shape& shape, double fillet_m) {
    strokes_.push_back(stroke(shape, fillet_m, true));
  }
  /// The same on both sides of the plane x = 0.
  void add_pair(const Shape& shape, double fillet_m);
  void carve_pair(const Shape& shape, double fillet_m);

  /// Signed distance in metres, at most first order near the surface: fillets shorten it. Strokes
  /// out of reach of `position` are passed over.
  double distance(const glm::dvec3& position) const;

 private:
  struct Stroke {
    Shape shape;
    double fillet_m;
    bool carves;
    Ball bound;
  };
  static Stroke stroke(const Shape& shape, double fillet_m, bool carves);

  std::vector<Stroke> strokes_;
};

/// The shape seen in the mirror x = 0.
Shape mirrored(const Shape& shape);

}  // namespace wobblebench::phantoms
