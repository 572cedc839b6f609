// Nearest points in space, by nanoflann; for .cpp files alone.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <nanoflann.hpp>
#include <vector>

namespace wobblebench::bench {

/// Points in the form that nanoflann asks for.
struct TreePoints {
  const std::vector<glm::dvec3>& at;

  std::size_t kdtree_get_point_count() const { return at.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return at[i][static_cast<glm::length_t>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using PointTree = nanoflann::
    KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, TreePoints>, TreePoints, 3>;

}  // namespace wobblebench::bench
