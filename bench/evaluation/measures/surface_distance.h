// A depth image as a surface in space, and the distance between the found and the true one.
#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "base/image.h"
#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// Vertices are the points of the pixels; triangles join neighbours whose depths differ by no more
/// than kSurfaceJump_m. Const functions may be called from several threads.
class DepthSurface {
 public:
  DepthSurface(const Image<float>& depth_m, const render::Camera& camera);
  ~DepthSurface();
  DepthSurface(const DepthSurface&) = delete;
  DepthSurface& operator=(const DepthSurface&) = delete;

  const std::vector<glm::dvec3>& points() const { return points_; }
  /// Distance to the nearest vertex or to one of the triangles at it. There must be a point.
  double distance_m(const glm::dvec3& position_m) const;

 private:
  struct Tree;

  /// Index of the vertex of a pixel; negative: none.
  int vertex(int column, int row) const;
  bool joined(int a, int b) const;

  Image<float> depth_m_;
  std::vector<glm::dvec3> points_;
  std::vector<int> pixel_of_;  ///< [point]: row * width + column
  Image<int> vertex_of_;
  std::unique_ptr<Tree> tree_;
};

/// Distance from a point to a triangle, edges and corners included.
double triangle_distance_m(const glm::dvec3& p,
                           const glm::dvec3& a,
                           const glm::dvec3& b,
                           const glm::dvec3& c);

/// Distances from the points of one surface to the other one; NaN where either has none.
struct DirectedDistance {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double mean_m = kNone;
  double p95_m = kNone;
  double max_m = kNone;
  int n = 0;
};

/// Points are those of the pixels; a surface is the triangles between neighbouring pixels whose
/// depths differ by no more than kSurfaceJump_m, and lone points. The distance of a point is that
/// to the nearest vertex or to a triangle at it.
struct SurfaceDistance {
  DirectedDistance found_to_true;  ///< all that is found, to all that is there, seen or not
  DirectedDistance true_to_found;  ///< what the probe can see, to what is found
  double mean_m = DirectedDistance::kNone;         ///< over the points of both
  double p95_m = DirectedDistance::kNone;          ///< likewise
  double hausdorff95_m = DirectedDistance::kNone;  ///< the greater P95 of the two
};

SurfaceDistance surface_distance(const Image<float>& depth_m,
                                 const Truth& truth,
                                 const render::Camera& camera);

}  // namespace wobblebench::bench
