// Truth that says why a surface cannot be seen.
#include "bench/evaluation/truth/shadows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "bench/scene/scene.h"
#include "phantoms/grids.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"
#include "render/view.h"

namespace wobblebench::bench {
namespace {

constexpr double kVoxel_m = 0.5e-3;
const glm::dvec3 kPlate_m(10e-3, 10e-3, 1.5e-3);  // half its size
const glm::dvec3 kWall_m(60e-3, 60e-3, 5e-3);
constexpr double kWallBehind_m = 30e-3;  // from the plate's middle to the wall's

auto box_grid(const std::string& name, const glm::dvec3& center_m, const glm::dvec3& half_m) {
  const glm::dvec3 room = half_m + 2 * phantoms::kHalfWidthVoxels * kVoxel_m;
  return phantoms::build_level_set(
      name,
      [=](const glm::dvec3& p) { return phantoms::box_distance(p - center_m, half_m); },
      {center_m - room, center_m + room},
      kVoxel_m,
      phantoms::Distances::exact);
}

/// A plate of bone in fluid, and behind it a wall of tissue that is to be found.
phantoms::Phantom plate_and_wall() {
  auto grids = std::make_shared<phantoms::Grids>();
  grids->signed_distance = {box_grid("plate", {0, 0, 0}, kPlate_m),
                            box_grid("wall", {0, 0, kWallBehind_m}, kWall_m)};
  return {"plate_and_wall",
          phantoms::material_table(),
          phantoms::material_index("amniotic_fluid"),
          {{"plate", phantoms::material_index("cortical_bone"), false},
           {"wall", phantoms::material_index("soft_tissue"), true}},
          {glm::dvec3(-30e-3, -30e-3, 10e-3), glm::dvec3(30e-3, 30e-3, 35e-3)},
          {0, 0, 90e-3},
          grids};
}

struct Seen {
  ResolvedScene scene;
  Truth truth;
  render::View view;
};

Seen look(const phantoms::Phantom& phantom, std::vector<std::string> settings) {
  settings.emplace_back("render.ray_casting.image_size=96");
  const ResolvedScene scene = resolve_scene(load_scene({}, settings), phantom);
  return {scene, true_surface(scene), scene.view()};
}

/// Signed distance, in the middle of the plate, of a stick's axis from its edge: negative inside.
double beside_plate_m(const Seen& seen, const glm::dvec3& position) {
  const auto plan = seen.scene.plan();
  const auto geometry = plan.geometry();
  const auto index = plan.nearest_stick(geometry.to_polar(position), 0);
  const auto ray =
      geometry.stick(plan.theta_rad(static_cast<int>(index.line)), plan.motor_angle_rad(index));
  const double at = (90e-3 - ray.origin.z) / ray.direction.z;
  const glm::dvec3 p = glm::abs(ray.at(at));
  return std::max(p.x, p.y) - 10e-3;
}

TEST(Shadows, LieBehindAPlateOfBone) {
  // 3.5 MHz through 3 mm of bone: 10 dB at the faces, 10.5 dB within, of each way; a bound on the
  // noise between the wall's echo in the open and behind the plate.
  const Seen seen =
      look(plate_and_wall(), {"simulation.aperture_losses=false", "simulation.noise_db=-58"});
  int shadowed = 0, open = 0;
  for (int row = 0; row < 96; ++row) {
    for (int column = 0; column < 96; ++column) {
      const float depth_m = seen.truth.crossing_m.at(column, row);
      if (std::isnan(depth_m)) continue;
      const double beside_m =
          beside_plate_m(seen, seen.view.camera.ray(column, row).at(static_cast<double>(depth_m)));
      if (std::abs(beside_m) < 0.5e-3) continue;
      const TruthKind kind = seen.truth.kind.at(column, row);
      ASSERT_EQ(kind, beside_m < 0 ? TruthKind::shadowed : TruthKind::surface)
          << column << " " << row << ": " << beside_m;
      EXPECT_EQ(std::isnan(seen.truth.depth_m.at(column, row)), beside_m < 0);
      ++(beside_m < 0 ? shadowed : open);
    }
  }
  EXPECT_GT(shadowed, 500);
  EXPECT_GT(open, 500);
}

TEST(Shadows, AreNoneWhereEchoesAreAboveTheNoise) {
  for (const char* quiet : {"simulation.noise_db=-150", "simulation.fidelity=geometry"}) {
    const Seen seen =
        look(plate_and_wall(),
             {"simulation.full_scale_db=-15", "simulation.dynamic_range_db=120", quiet});
    for (const TruthKind kind : seen.truth.kind.pixels) ASSERT_NE(kind, TruthKind::shadowed);
  }
}

/// The display's lower end hides echoes as noise does.
TEST(Shadows, LieBelowTheDynamicRange) {
  const Seen seen = look(plate_and_wall(),
                         {"simulation.aperture_losses=false",
                          "simulation.noise_db=-200",
                          "simulation.dynamic_range_db=40",
                          "simulation.tgc_db_per_cm_mhz=0"});
  EXPECT_EQ(seen.truth.kind.at(48, 48), TruthKind::shadowed);
  EXPECT_EQ(seen.truth.kind.at(5, 48), TruthKind::surface);
}

/// On the rim of a ball the sticks of the probe are tangents where the camera's rays are not.
TEST(Grazing, IsWhereAStickMeetsTheSurfaceAtMoreThan85Degrees) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .radius_m = 20e-3});
  const Seen seen = look(phantom, {"render.view.yaw_deg=50"});
  const auto plan = seen.scene.plan();
  const auto geometry = plan.geometry();
  int grazing = 0;
  for (int row = 0; row < 96; ++row) {
    for (int column = 0; column < 96; ++column) {
      const TruthKind kind = seen.truth.kind.at(column, row);
      if (kind != TruthKind::grazing && kind != TruthKind::surface) continue;
      const auto depth_m = static_cast<double>(seen.truth.crossing_m.at(column, row));
      const glm::dvec3 at = seen.view.camera.ray(column, row).at(depth_m);
      const glm::dvec3 normal = glm::normalize(at - seen.scene.subject()->placement.position_m);
      const auto stick = plan.nearest_stick(geometry.to_polar(at), 0);
      const glm::dvec3 along =
          geometry.stick(plan.theta_rad(static_cast<int>(stick.line)), plan.motor_angle_rad(stick))
              .direction;
      const double incidence_deg = std::acos(-glm::dot(along, normal)) / kDegree;
      EXPECT_NEAR(static_cast<double>(seen.truth.incidence_rad.at(column, row)) / kDegree,
                  incidence_deg,
                  1);
      if (std::abs(incidence_deg - 85) < 1) continue;
      EXPECT_EQ(kind == TruthKind::grazing, incidence_deg > 85) << incidence_deg;
      grazing += kind == TruthKind::grazing;
    }
  }
  EXPECT_GT(grazing, 100);
}

}  // namespace
}  // namespace wobblebench::bench
