// Area of the true surface that a pixel shows.
#pragma once

#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// Smallest cosine between ray and normal that counts, 88.9 degrees: at the very rim of a body the
/// area of a pixel diverges, and one pixel would outweigh all others. Of a ball 1 % is so left out.
inline constexpr double kLeastCosine = 0.02;

/// dA = t^2 dOmega / |cos|, with t the depth, dOmega the solid angle of the pixel and cos that of
/// the angle between ray and normal (the change of variables of the rendering equation from
/// directions to areas: pbrt, 4th ed., section 4.2.3; docs/references.md [20]). A pixel of side p
/// at the eye's distance f, at an angle a off the axis, has dOmega = p^2 cos^3(a) / f^2. In
/// parallel projection dA = p^2 / |cos|. The pixel must show a surface.
double pixel_area_m2(const Truth& truth, const render::Camera& camera, int column, int row);
/// Of any surface that a pixel shows, at a depth and with a normal.
double pixel_area_m2(const render::Camera& camera,
                     const hw::Ray& ray,
                     double depth_m,
                     const glm::dvec3& normal);

}  // namespace wobblebench::bench
