#include "bench/live/space_message.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/units.h"
#include "bench/live/messages.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/surface_mesh.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little);

/// phantoms::Material::backscatter_db of a fluid.
constexpr double kNoEcho_db = -200;
/// Edges of a drawn surface on its longest side.
constexpr double kEdges = 48;

template <class Number>
void put(Number number, std::string& to) {
  std::array<char, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), &number, sizeof(Number));
  to.append(bytes.data(), bytes.size());
}

void put_mm(const glm::dvec3& position_m, std::string& to) {
  for (int i = 0; i < 3; ++i) put(static_cast<float>(position_m[i] / kMillimetre), to);
}

/// Every so many of `all` that `most` at most are left, the last one too.
std::vector<int> drawn(int all, int most) {
  std::vector<int> indices;
  const int count = std::min(all, most);
  for (int i = 0; i < count; ++i) indices.push_back(count == 1 ? 0 : i * (all - 1) / (count - 1));
  return indices;
}

std::string sticks_mm(const hw::AcquisitionPlan& plan,
                      const std::vector<int>& frames,
                      const std::vector<int>& lines) {
  std::string bytes;
  for (const int frame : frames) {
    for (const int line : lines) {
      const hw::Ray stick = plan.geometry().stick(plan.theta_rad(line), plan.frame_phi_rad(frame));
      put_mm(stick.at(0), bytes);
      put_mm(stick.at(plan.acquisition().depth_m), bytes);
    }
  }
  return bytes;
}

/// The target surfaces; those around fluid only where there are no others, which they would hide.
std::vector<std::size_t> drawn_surfaces(const phantoms::Phantom& phantom) {
  std::vector<std::size_t> of_tissue, of_fluid;
  const auto& surfaces = phantom.surfaces();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (!surfaces[i].is_target) continue;
    const auto inside = static_cast<std::size_t>(surfaces[i].inside);
    const bool has_echo = phantom.materials().at(inside).backscatter_db > kNoEcho_db;
    (has_echo ? of_tissue : of_fluid).push_back(i);
  }
  return of_tissue.empty() ? of_fluid : of_tissue;
}

void add_surfaces(const phantoms::PlacedPhantom& subject,
                  Json& header,
                  std::vector<std::string>& parts) {
  for (const std::size_t i : drawn_surfaces(subject.phantom)) {
    const phantoms::SurfaceMesh mesh = phantoms::surface_mesh(subject.phantom, i, kEdges);
    std::string points, triangles;
    for (const glm::dvec3& point_m : mesh.points_m) put_mm(subject.from_rest(point_m, 0), points);
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) put(corner, triangles);
    }
    header["surfaces"].push_back(subject.phantom.surfaces()[i].name);
    parts.push_back(std::move(points));
    parts.push_back(std::move(triangles));
  }
}

}  // namespace

LiveMessage space_message(const ResolvedScene& scene) {
  const hw::AcquisitionPlan& plan = scene.plan();
  const std::vector<int> frames = drawn(plan.acquisition().frames_per_volume, kMostDrawnFrames);
  const std::vector<int> lines = drawn(plan.acquisition().sticks_per_frame, kMostDrawnLines);
  Json header = {{"type", "space"},
                 {"frames", frames},
                 {"lines", lines},
                 {"moves", scene.moves()},
                 {"surfaces", Json::array()}};
  std::vector<std::string> parts = {sticks_mm(plan, frames, lines)};
  if (scene.subject()) add_surfaces(*scene.subject(), header, parts);
  return binary_message(std::move(header), parts);
}

}  // namespace wobblebench::bench
