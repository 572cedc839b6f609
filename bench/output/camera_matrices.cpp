#include "bench/output/camera_matrices.h"

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

constexpr double kNearPlane_mm = 1;

bool is_parallel(const render::Camera& camera) {
  return camera.projection == render::Projection::parallel;
}

double distance_mm(const render::Camera& camera) {
  return (is_parallel(camera) ? camera.plane_distance_m : camera.eye_distance_m) / kMillimetre;
}

/// From the camera's frame to the picture.
RowMatrix projection(const render::Camera& camera) {
  const double scale = 2 * kMillimetre / camera.width_m, distance = distance_mm(camera);
  if (is_parallel(camera)) {
    return {scale, 0, 0, 0, 0, -scale, 0, 0, 0, 0, 0.5 / distance, 0, 0, 0, 0, 1};
  }
  const double wide = scale * distance;
  return {wide, 0, 0, 0, 0, -wide, 0, 0, 0, 0, 1, 1, 0, 0, -kNearPlane_mm, 0};
}

RowMatrix product(const RowMatrix& a, const RowMatrix& b) {
  RowMatrix result{};
  for (std::size_t i = 0; i < 16; ++i) {
    for (std::size_t k = 0; k < 4; ++k) result[i] += a[i / 4 * 4 + k] * b[4 * k + i % 4];
  }
  return result;
}

nlohmann::ordered_json rows(const RowMatrix& m) {
  auto json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < 16; i += 4) json.push_back({m[i], m[i + 1], m[i + 2], m[i + 3]});
  return json;
}

}  // namespace

std::string depth_meaning(const render::Camera& camera) {
  return is_parallel(camera)
             ? "length of the pixel's ray from the view plane (camera z = 0), which "
               "is z of the camera"
             : "length of the pixel's ray from the eye (origin of the camera), not "
               "z of the camera";
}

RowMatrix world_to_camera(const render::Camera& camera) {
  const glm::dvec3 &r = camera.right, &d = camera.down, &f = camera.forward;
  const glm::dvec3 origin = camera.center / kMillimetre - distance_mm(camera) * f;
  return {r.x,
          d.x,
          f.x,
          0,  //
          r.y,
          d.y,
          f.y,
          0,  //
          r.z,
          d.z,
          f.z,
          0,  //
          -glm::dot(origin, r),
          -glm::dot(origin, d),
          -glm::dot(origin, f),
          1};
}

RowMatrix world_to_ndc(const render::Camera& camera) {
  return product(world_to_camera(camera), projection(camera));
}

nlohmann::ordered_json camera_json(const render::Camera& camera) {
  return {
      {"projection", is_parallel(camera) ? "parallel" : "perspective"},
      {"flipped", camera.flipped},
      {"image_size", camera.image_size},
      {"mm_per_pixel", camera.pixel_m() / kMillimetre},
      {"unit", "mm"},
      {"world", kWorldFrame},
      {"depth", depth_meaning(camera)},
      {"pixels", kPixels},
      {is_parallel(camera) ? "view_plane_to_center_mm" : "eye_to_center_mm", distance_mm(camera)},
      {"world_to_camera", rows(world_to_camera(camera))},
      {"world_to_ndc", rows(world_to_ndc(camera))}};
}

}  // namespace wobblebench::bench
