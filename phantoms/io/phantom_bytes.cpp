#include "phantoms/io/phantom_bytes.h"

#include <cmath>
#include <memory>
#include <utility>

#include "base/byte_stream.h"
#include "base/text.h"
#include "phantoms/grids.h"
#include "phantoms/io/grid_bytes.h"

namespace wobblebench::phantoms {
namespace {

constexpr std::uint32_t kMostEntries = 10000;

void write(ByteWriter& to, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) to.value(v[axis]);
}

void write(ByteWriter& to, const Material& material) {
  to.text(material.name);
  to.value(material.sound_speed_m_s);
  to.value(material.impedance_rayl);
  to.value(material.attenuation_db_per_cm_mhz);
  to.value(material.backscatter_db);
  to.value(material.roughness);
  to.text(material.source);
}

void write(ByteWriter& to, const PointScatterers& points) {
  to.value(static_cast<std::uint32_t>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto track = points.track(i);
    to.value(static_cast<std::uint32_t>(track.size()));
    for (const ScattererKey& key : track) {
      to.value(key.time_s);
      write(to, key.point.position_m);
      to.value(key.point.amplitude);
    }
  }
}

void write(ByteWriter& to, const std::vector<Feature>& features) {
  to.value(static_cast<std::uint32_t>(features.size()));
  for (const Feature& feature : features) {
    to.text(feature.name);
    to.value(static_cast<std::uint32_t>(feature.balls.size()));
    for (const FeatureBall& ball : feature.balls) {
      write(to, ball.center_m);
      to.value(ball.radius_m);
    }
  }
}

double number(ByteReader& from) {
  const double value = from.value<double>();
  expect_bytes(std::isfinite(value), "a number is not finite");
  return value;
}

glm::dvec3 vector(ByteReader& from) {
  glm::dvec3 v{};
  for (int axis = 0; axis < 3; ++axis) v[axis] = number(from);
  return v;
}

std::string text(ByteReader& from) {
  std::string text = from.text();
  expect_bytes(is_printable_text(text), "a name is not printable");
  return text;
}

std::uint32_t below(ByteReader& from, std::uint32_t limit) {
  const auto value = from.value<std::uint32_t>();
  expect_bytes(value < limit, "a number is too large");
  return value;
}

std::vector<Material> read_materials(ByteReader& from) {
  std::vector<Material> materials(below(from, kMostEntries));
  for (Material& material : materials) {
    material.name = text(from);
    material.sound_speed_m_s = number(from);
    material.impedance_rayl = number(from);
    material.attenuation_db_per_cm_mhz = number(from);
    material.backscatter_db = number(from);
    material.roughness = number(from);
    material.source = text(from);
  }
  return materials;
}

void write(ByteWriter& to, const Mouth& mouth) {
  for (int axis = 0; axis < 3; ++axis) write(to, mouth.axes[axis]);
  write(to, mouth.center_m);
  to.value(mouth.opening_m);
  to.value(mouth.reach_m);
}

std::optional<Mouth> read_mouth(ByteReader& from) {
  if (below(from, 2) == 0) return std::nullopt;
  Mouth mouth;
  for (int axis = 0; axis < 3; ++axis) mouth.axes[axis] = vector(from);
  mouth.center_m = vector(from);
  mouth.opening_m = number(from);
  mouth.reach_m = number(from);
  expect_bytes(is_possible(mouth), "a mouth cannot move");
  return mouth;
}

std::optional<Joint> read_joint(ByteReader& from) {
  if (below(from, 2) == 0) return std::nullopt;
  const glm::dvec3 center_m = vector(from);
  const double inner_m = number(from), outer_m = number(from);
  const Joint joint{center_m, inner_m, outer_m, read_mouth(from)};
  expect_bytes(joint.inner_m >= 0 && joint.inner_m < joint.outer_m, "a joint is no shell");
  return joint;
}

PointScatterers read_scatterers(ByteReader& from) {
  PointScatterers points;
  for (auto left = from.value<std::uint32_t>(); left > 0; --left) {
    std::vector<ScattererKey> track;
    for (auto keys = from.value<std::uint32_t>(); keys > 0; --keys) {
      const double time_s = number(from);
      const glm::dvec3 position_m = vector(from);
      const double amplitude = number(from);
      expect_bytes(track.empty() || time_s > track.back().time_s, "a track's times do not rise");
      track.push_back({time_s, {position_m, amplitude}});
    }
    expect_bytes(!track.empty(), "a track has no keys");
    points.add_track(track);
  }
  return points;
}

std::vector<Feature> read_features(ByteReader& from) {
  std::vector<Feature> features(below(from, kMostEntries));
  for (Feature& feature : features) {
    feature.name = text(from);
    feature.balls.resize(below(from, kMostEntries));
    for (FeatureBall& ball : feature.balls) {
      ball.center_m = vector(from);
      ball.radius_m = number(from);
    }
  }
  return features;
}

}  // namespace

std::optional<std::string> to_bytes(const Phantom& phantom) {
  ByteWriter to;
  to.text(phantom.name());
  to.value(static_cast<std::uint32_t>(phantom.materials().size()));
  for (const Material& material : phantom.materials()) write(to, material);
  to.value(static_cast<std::uint32_t>(phantom.background()));
  write(to, phantom.region_of_interest().low);
  write(to, phantom.region_of_interest().high);
  write(to, phantom.suggested_position_m());
  to.value(std::uint32_t{phantom.joint() ? 1U : 0U});
  if (const auto& joint = phantom.joint()) {
    write(to, joint->center_m);
    to.value(joint->inner_m);
    to.value(joint->outer_m);
    to.value(std::uint32_t{joint->mouth ? 1U : 0U});
    if (joint->mouth) write(to, *joint->mouth);
  }
  to.value(static_cast<std::uint32_t>(phantom.surfaces().size()));
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const Surface& surface = phantom.surfaces()[i];
    to.text(surface.name);
    to.value(static_cast<std::uint32_t>(surface.inside));
    to.value(std::uint32_t{surface.is_target ? 1U : 0U});
    if (!write_grid(*phantom.grids().signed_distance[i], to)) return std::nullopt;
  }
  write(to, phantom.scatterers());
  write(to, phantom.features());
  return to.take();
}

Phantom phantom_from_bytes(std::string_view bytes) {
  ByteReader from(bytes);
  std::string name = text(from);
  std::vector<Material> materials = read_materials(from);
  const auto rows = static_cast<std::uint32_t>(materials.size());
  const auto background = static_cast<MaterialIndex>(below(from, rows));
  Box region;
  region.low = vector(from);
  region.high = vector(from);
  const glm::dvec3 position_m = vector(from);
  const std::optional<Joint> joint = read_joint(from);
  std::vector<Surface> surfaces(below(from, kMostEntries));
  auto grids = std::make_shared<Grids>();
  for (Surface& surface : surfaces) {
    surface.name = text(from);
    surface.inside = static_cast<MaterialIndex>(below(from, rows));
    surface.is_target = below(from, 2) == 1;
    grids->signed_distance.push_back(read_grid(from));
  }
  PointScatterers points = read_scatterers(from);
  std::vector<Feature> features = read_features(from);
  from.expect_end();
  return Phantom(std::move(name),
                 std::move(materials),
                 background,
                 std::move(surfaces),
                 region,
                 position_m,
                 std::move(grids),
                 joint,
                 std::move(points))
      .with_features(std::move(features));
}

}  // namespace wobblebench::phantoms
