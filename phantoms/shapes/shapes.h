// Signed-distance shapes, negative inside, and bodies of them by constructive solid geometry (CSG).
// Distances and positions in metres.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <variant>
#include <vector>

#include "phantoms/parts.h"

namespace wobblebench::phantoms {

/// A bounding sphere.
struct Ball {
  glm::dvec3 center{0};
  double radius_m = 0;
};

/// An interval of distances.
struct Span {
  double least = 0;
  double most = 0;
};

/// Distance to first order: exact on the surface, within some percent near it.
struct Ellipsoid {
  glm::dvec3 center{0};
  glm::dvec3 radii_m{1};
  glm::dmat3 to_axes{1.0};  ///< rotation from the surrounding frame to the ellipsoid's own axes

  double distance(const glm::dvec3& position) const;
  /// Contains distance() of every position in the ball.
  Span within(const Ball& ball) const;
  Ball bound() const;
};

/// One vertex of a tube.
struct TubePoint {
  glm::dvec3 center{0};
  double radius_m = 0;
};

/// The convex hull of two balls.
class RoundCone {
 public:
  RoundCone(const TubePoint& a, const TubePoint& b);

  /// Exact outside.
  double distance(const glm::dvec3& position) const;
  /// No more than distance(), for less work.
  double least_distance(const glm::dvec3& position) const;

 private:
  TubePoint a_, b_;
  glm::dvec3 axis_;
  double taper_m_;
  double length2_, length_m_;
  double slope_ = 0;      ///< slope of the mantle against the axis
  bool is_ball_ = false;  ///< one ball contains the other
  Ball bound_;
};

/// A chain of round cones through the points; the distance is exact outside.
class Tube {
 public:
  explicit Tube(std::vector<TubePoint> points);

  const std::vector<TubePoint>& points() const { return points_; }
  double distance(const glm::dvec3& position) const;
  /// Contains distance() of every position in the ball.
  Span within(const Ball& ball) const;
  /// The shortest stretch of the chain with the same distance() at every position in the ball.
  Tube near(const Ball& ball) const;
  Ball bound() const;

 private:
  std::vector<TubePoint> points_;
  std::vector<RoundCone> cones_;
};

/// The tube along a Catmull-Rom spline through `points`, with `pieces` segments between neighbours.
Tube smooth_tube(const std::vector<TubePoint>& points, int pieces);

/// Exact distance to the box of these half sizes about the origin.
double box_distance(const glm::dvec3& position, const glm::dvec3& half_m);

/// Smooth union and difference of two distances (quadratic smooth minimum, Quilez): sharp where
/// |a - b| >= fillet.
double smooth_union(double a, double b, double fillet_m);
double smooth_difference(double body, double tool, double fillet_m);

using Shape = std::variant<Ellipsoid, Tube>;

/// A signed distance, and the part of the shape that makes it.
struct PartDistance {
  double distance = 0;
  Part part = Part::none;
};

/// Shapes united and subtracted in the order of the calls, each with a fillet of its own.
class CsgBody {
 public:
  struct Operation {
    Shape shape;
    double fillet_m;
    bool is_difference;
    Ball bound;
    Part part = Part::none;
  };

  /// The part that shapes make from here on.
  void begin(Part part) { part_ = part; }
  void unite(const Shape& shape, double fillet_m) {
    operations_.push_back(operation(shape, fillet_m, false));
  }
  void subtract(const Shape& shape, double fillet_m) {
    operations_.push_back(operation(shape, fillet_m, true));
  }
  bool empty() const { return operations_.empty(); }
  const std::vector<Operation>& operations() const { return operations_; }
  /// The shape and its mirror image in the plane x = 0.
  void unite_pair(const Shape& shape, double fillet_m);
  void subtract_pair(const Shape& shape, double fillet_m);

  /// Signed distance in metres; first order at best near the surface, since fillets shorten it.
  /// Operations whose bounds are too far from `position` to change the result are skipped.
  double distance(const glm::dvec3& position) const;

  /// The same distance with the part of the operation that makes it: of two that are united the one
  /// with the lesser distance; the tool's where what it cuts away would be nearer.
  PartDistance part_distance(const glm::dvec3& position) const;

  /// A body with the same distance() to the bit at every position in the ball: without the
  /// operations that change nothing there.
  CsgBody near(const Ball& ball) const;

 private:
  Operation operation(const Shape& shape, double fillet_m, bool is_difference) const;
  template <class Wins>
  double folded(const glm::dvec3& position, const Wins& wins) const;

  std::vector<Operation> operations_;
  Part part_ = Part::none;
};

/// The mirror image of the shape in the plane x = 0.
Shape mirrored(const Shape& shape);

}  // namespace wobblebench::phantoms
