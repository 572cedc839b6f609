#include "phantoms/io/phantom_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "base/byte_stream.h"
#include "base/text.h"
#include "phantoms/grids.h"
#include "phantoms/io/level_set_bytes.h"
#include "phantoms/label_finder.h"

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

void write(ByteWriter& to, const glm::dmat3& matrix) {
  for (int axis = 0; axis < 3; ++axis) write(to, matrix[axis]);
}

void write(ByteWriter& to, const Shape& shape) {
  const auto* ellipsoid = std::get_if<Ellipsoid>(&shape);
  to.value(std::uint32_t{ellipsoid != nullptr ? 1U : 0U});
  if (ellipsoid != nullptr) {
    write(to, ellipsoid->center);
    write(to, ellipsoid->radii_m);
    write(to, ellipsoid->to_axes);
    return;
  }
  const auto& points = std::get<Tube>(shape).points();
  to.value(static_cast<std::uint32_t>(points.size()));
  for (const TubePoint& point : points) {
    write(to, point.center);
    to.value(point.radius_m);
  }
}

void write(ByteWriter& to, Part part) {
  to.value(static_cast<std::uint32_t>(part));
}

void write(ByteWriter& to, const PartBody& body) {
  to.value(static_cast<std::uint32_t>(body.shape.operations().size()));
  for (const CsgBody::Operation& operation : body.shape.operations()) {
    write(to, operation.part);
    to.value(std::uint32_t{operation.is_difference ? 1U : 0U});
    to.value(operation.fillet_m);
    write(to, operation.shape);
  }
  write(to, body.to_body);
  write(to, body.position_m);
  to.value(body.fillet_m);
}

void write(ByteWriter& to, const PhantomParts* parts) {
  to.value(std::uint32_t{parts != nullptr ? 1U : 0U});
  if (parts == nullptr) return;
  write(to, parts->background);
  for (const SurfaceParts& surface : parts->surfaces) {
    write(to, surface.on);
    write(to, surface.inside);
    to.value(static_cast<std::uint32_t>(surface.bodies.size()));
    for (const PartBody& body : surface.bodies) write(to, body);
  }
}

void write(ByteWriter& to, const std::vector<Landmark>& landmarks) {
  to.value(static_cast<std::uint32_t>(landmarks.size()));
  for (const Landmark& landmark : landmarks) {
    to.text(landmark.name);
    write(to, landmark.position_m);
  }
}

void write(ByteWriter& to, const std::vector<PhantomMeasure>& measures) {
  to.value(static_cast<std::uint32_t>(measures.size()));
  for (const PhantomMeasure& measure : measures) {
    to.text(measure.name);
    to.value(measure.value);
    to.value(std::uint32_t{measure.target ? 1U : 0U});
    to.value(measure.target.value_or(0));
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

glm::dmat3 matrix(ByteReader& from) {
  glm::dmat3 matrix;
  for (int axis = 0; axis < 3; ++axis) matrix[axis] = vector(from);
  return matrix;
}

double positive(ByteReader& from) {
  const double value = number(from);
  expect_bytes(value > 0, "a size is not positive");
  return value;
}

Shape read_shape(ByteReader& from) {
  if (below(from, 2) == 1) {
    Ellipsoid ellipsoid;
    ellipsoid.center = vector(from);
    for (int axis = 0; axis < 3; ++axis) ellipsoid.radii_m[axis] = positive(from);
    ellipsoid.to_axes = matrix(from);
    return ellipsoid;
  }
  std::vector<TubePoint> points(below(from, kMostEntries));
  expect_bytes(points.size() > 1, "a tube has no length");
  for (TubePoint& point : points) {
    point.center = vector(from);
    point.radius_m = positive(from);
  }
  return Tube(std::move(points));
}

Part read_part(ByteReader& from) {
  const auto part = static_cast<Part>(below(from, 256));
  const bool is_known = std::ranges::any_of(
      part_names(), [part](const PartName& known) { return known.part == part; });
  expect_bytes(is_known || part == Part::none, "a part is not known");
  return part;
}

PartBody read_body(ByteReader& from) {
  PartBody body;
  for (std::uint32_t left = below(from, kMostEntries); left > 0; --left) {
    body.shape.begin(read_part(from));
    const bool is_difference = below(from, 2) == 1;
    const double fillet_m = number(from);
    const Shape shape = read_shape(from);
    is_difference ? body.shape.subtract(shape, fillet_m) : body.shape.unite(shape, fillet_m);
  }
  body.to_body = matrix(from);
  body.position_m = vector(from);
  body.fillet_m = number(from);
  return body;
}

std::optional<PhantomParts> read_parts(ByteReader& from, std::size_t surfaces) {
  if (below(from, 2) == 0) return std::nullopt;
  PhantomParts parts;
  parts.background = read_part(from);
  parts.surfaces.resize(surfaces);
  for (SurfaceParts& surface : parts.surfaces) {
    surface.on = read_part(from);
    surface.inside = read_part(from);
    for (std::uint32_t left = below(from, kMostEntries); left > 0; --left) {
      surface.bodies.push_back(read_body(from));
    }
  }
  return parts;
}

std::vector<Landmark> read_landmarks(ByteReader& from) {
  std::vector<Landmark> landmarks(below(from, kMostEntries));
  for (Landmark& landmark : landmarks) {
    landmark.name = text(from);
    landmark.position_m = vector(from);
  }
  return landmarks;
}

std::vector<PhantomMeasure> read_measures(ByteReader& from) {
  std::vector<PhantomMeasure> measures(below(from, kMostEntries));
  for (PhantomMeasure& measure : measures) {
    measure.name = text(from);
    measure.value = number(from);
    const bool aimed = below(from, 2) == 1;
    const double target = number(from);
    if (aimed) measure.target = target;
  }
  return measures;
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
    if (!write_level_set(*phantom.grids().signed_distance[i], to)) return std::nullopt;
  }
  write(to, phantom.scatterers());
  write(to, phantom.parts());
  write(to, phantom.landmarks());
  write(to, phantom.measures());
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
    grids->signed_distance.push_back(read_level_set(from));
  }
  PointScatterers points = read_scatterers(from);
  std::optional<PhantomParts> parts = read_parts(from, surfaces.size());
  std::vector<Landmark> landmarks = read_landmarks(from);
  std::vector<PhantomMeasure> measures = read_measures(from);
  from.expect_end();
  expect_bytes(parts || landmarks.empty(), "landmarks without parts");
  Phantom phantom = Phantom(std::move(name),
                            std::move(materials),
                            background,
                            std::move(surfaces),
                            region,
                            position_m,
                            std::move(grids),
                            joint,
                            std::move(points))
                        .with_measures(std::move(measures));
  if (!parts) return phantom;
  return phantom.with_parts(*std::move(parts), std::move(landmarks));
}

}  // namespace wobblebench::phantoms
