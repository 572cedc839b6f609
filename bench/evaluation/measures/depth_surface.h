// A depth image as a surface in space.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "base/image.h"
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
  /// To the nearest vertex or to one of the triangles at it. There must be a point.
  double distance_m(const glm::dvec3& position_m) const;

 private:
  struct Tree;

  /// Index of the vertex of a pixel; negative: none.
  int vertex(int column, int row) const;
  bool joined(int a, int b) const;

  Image<float> depth_m_;
  std::vector<glm::dvec3> points_;
  std::vector<int> pixel_of_;  ///< of each point: row * width + column
  Image<int> vertex_of_;
  std::unique_ptr<Tree> tree_;
};

/// From a point to a triangle, edges and corners included.
double triangle_distance_m(const glm::dvec3& p,
                           const glm::dvec3& a,
                           const glm::dvec3& b,
                           const glm::dvec3& c);

}  // namespace wobblebench::bench
