// A picture's camera for other programs: matrices in millimetres, and how they read a depth map
// (docs/units.md, "From a depth map to points").
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "render/camera.h"

namespace wobblebench::bench {

/// 4 x 4 in the order of EXR files: points are rows, [x y z 1] M, and numbers 12 to 14 translate.
using RowMatrix = std::array<double, 16>;

/// From the probe frame, mm, to the camera's, mm: x to the right in the picture, y down, z into it.
/// Its origin is the middle of the view plane (parallel) or the eye (perspective).
RowMatrix world_to_camera(const render::Camera& camera);

/// From the probe frame, mm, to the picture, after division by the fourth number: x from -1 at its
/// left edge to +1, y from -1 at its lower edge to +1 at the upper one. z is 0 in the view plane
/// and 1 as far behind the middle of the box (parallel), or 1 - 1 mm / z of the camera.
RowMatrix world_to_ndc(const render::Camera& camera);

/// What a depth of this camera's pictures is, for a reader of a file.
std::string depth_meaning(const render::Camera& camera);
/// The frame that the matrices start from, and the order of pixels, likewise.
inline constexpr const char* kWorldFrame =
    "probe: origin in the centre of curvature of the face, x along the array, z into the body, y = "
    "z cross x; points are rows, [x y z 1] M";
inline constexpr const char* kPixels =
    "rows from the top, columns from the left; the centre of pixel (column, row) is NDC x = (2 "
    "column + 1) / N - 1, y = 1 - (2 row + 1) / N; NaN: no surface";

/// "camera" of report.json.
nlohmann::ordered_json camera_json(const render::Camera& camera);

}  // namespace wobblebench::bench
