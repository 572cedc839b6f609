// What a picture's rays see of a mesh, or of a cloud of points, in the box of interest.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "phantoms/io/triangle_mesh.h"
#include "render/view.h"

namespace wobblebench::bench {

/// Depth of the first triangle that each pixel's ray meets within the view's box, from either side;
/// kNoSurface: none. `mesh`: probe frame, m.
Image<float> depth_of_mesh(const phantoms::TriangleMesh& mesh, const render::View& view);

/// Depth of the points within the view's box, each of which covers the pixels whose centres lie
/// within `radius_m` of it across the line of sight. Of the points that cover a pixel, those within
/// 4 radii of the nearest one count, and the one nearest to the pixel's centre gives its depth: a
/// disc would show steep surfaces too near. `points_m`: probe frame.
Image<float> depth_of_points(const std::vector<glm::dvec3>& points_m,
                             const render::View& view,
                             double radius_m);

/// The points within the view's box.
std::vector<glm::dvec3> points_in_box(const std::vector<glm::dvec3>& points_m,
                                      const render::View& view);

/// A radius with which depth_of_points() closes the gaps between points that are spread evenly: 95
/// % of them have another one within it. NaN for fewer than two different points.
double point_spacing_m(const std::vector<glm::dvec3>& points_m);

}  // namespace wobblebench::bench
