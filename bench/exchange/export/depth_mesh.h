// The surface of a depth map as triangles between neighbouring pixels.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// Vertices are the points of the pixels that have a depth. Four neighbours are joined where their
/// depths differ by at most 3 mm.
class DepthMesh {
 public:
  /// Both must outlive it.
  DepthMesh(const Image<float>& depth_m, const render::Camera& camera);

  /// Column and row of each vertex.
  const std::vector<glm::ivec2>& pixels() const { return pixels_; }
  /// Numbers of vertices, three a triangle; they turn so that normals point to the viewer.
  std::vector<std::int32_t> corners() const;

  glm::dvec3 point_m(const glm::ivec2& pixel) const;
  /// Towards the viewer, of neighbouring points; against the ray where there are none.
  glm::dvec3 normal(const glm::ivec2& pixel) const;

 private:
  bool has(int column, int row) const;
  bool joins(int column, int row) const;
  bool is_near(const glm::ivec2& pixel, const glm::ivec2& neighbour) const;
  glm::dvec3 difference(const glm::ivec2& pixel, const glm::ivec2& step) const;

  const Image<float>& depth_m_;
  const render::Camera& camera_;
  Image<std::int32_t> number_;  ///< of a pixel's vertex; -1: it has none
  std::vector<glm::ivec2> pixels_;
};

}  // namespace wobblebench::bench
