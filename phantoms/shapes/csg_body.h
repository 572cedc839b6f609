// A body by constructive solid geometry (CSG): smooth unions and differences of simple shapes.
#pragma once

#include <variant>
#include <vector>

#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

using Shape = std::variant<Ellipsoid, Tube>;

/// Shapes united and subtracted in the order of the calls, each with a fillet of its own.
class CsgBody {
 public:
  void unite(const Shape& shape, double fillet_m) {
    operations_.push_back(operation(shape, fillet_m, false));
  }
  void subtract(const Shape& shape, double fillet_m) {
    operations_.push_back(operation(shape, fillet_m, true));
  }
  /// The shape and its mirror image in the plane x = 0.
  void unite_pair(const Shape& shape, double fillet_m);
  void subtract_pair(const Shape& shape, double fillet_m);

  /// Signed distance in metres; first order at best near the surface, since fillets shorten it.
  /// Operations whose bounds are too far from `position` to change the result are skipped.
  double distance(const glm::dvec3& position) const;

  /// A body with the same distance() to the bit at every position in the ball: without the
  /// operations that change nothing there.
  CsgBody near(const Ball& ball) const;

 private:
  struct Operation {
    Shape shape;
    double fillet_m;
    bool is_difference;
    Ball bound;
  };
  static Operation operation(const Shape& shape, double fillet_m, bool is_difference);

  std::vector<Operation> operations_;
};

/// The mirror image of the shape in the plane x = 0.
Shape mirrored(const Shape& shape);

}  // namespace wobblebench::phantoms
