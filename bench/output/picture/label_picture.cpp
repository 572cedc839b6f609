#include "bench/output/picture/label_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

using phantoms::Part;

/// Neighbours in the face differ in hue and lightness.
constexpr std::array<std::pair<Part, std::uint32_t>, 31> kColours = {{
    {Part::forehead, 0xc9b18f},
    {Part::brow, 0x7a5230},
    {Part::eyelids, 0x3b7dd8},
    {Part::nose, 0xf2a33a},
    {Part::philtrum, 0xf5dd5d},
    {Part::upper_lip, 0xd6304a},
    {Part::lower_lip, 0xf0788c},
    {Part::mouth, 0x6e0f2a},
    {Part::tongue, 0xff5fb0},
    {Part::chin, 0x5fae4b},
    {Part::jaw, 0x2f6b3c},
    {Part::cheek, 0xa9d98c},
    {Part::cheekbone, 0x35a79c},
    {Part::ear, 0x8e5bc0},
    {Part::face_base, 0xe7d7c1},
    {Part::around_mouth, 0xc7c24a},
    {Part::cleft, 0x101010},
    {Part::neck, 0x8a8f98},
    {Part::body, 0x616874},
    {Part::arm, 0x6fc3e8},
    {Part::hand, 0x22a6e0},
    {Part::cord, 0xb58bd9},
    {Part::skull, 0xf4f1e6},
    {Part::brain, 0xd9a6b3},
    {Part::eye, 0x1c4f8f},
    {Part::uterine_wall, 0x7c3b3b},
    {Part::placenta, 0xa03c5a},
    {Part::maternal_muscle, 0x9c4f45},
    {Part::maternal_fat, 0xdcc66a},
    {Part::maternal_skin, 0xb98a70},
    {Part::amniotic_fluid, 0x23415c},
}};
/// Of phantoms whose parts have no names, in turn.
constexpr std::array<std::uint32_t, 8> kUnnamed = {
    0xf2a33a, 0x3b7dd8, 0x5fae4b, 0xd6304a, 0x8e5bc0, 0x35a79c, 0xf5dd5d, 0xa9d98c};

constexpr std::uint32_t kSeen = 0xe8e8e8, kHidden = 0xd55e00;

std::string spaced(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

std::string name_of(const Labels& labels, std::uint8_t label) {
  for (const phantoms::LabelName& name : labels.names) {
    if (name.label == label) return name.name;
  }
  return "none";
}

/// Lighter where the surface faces the viewer, so that its relief can be seen.
double relief(const Truth& truth, const render::Camera& camera, int column, int row) {
  const glm::dvec3 normal = truth.normal.at(column, row);
  const double facing = std::abs(glm::dot(camera.ray(column, row).direction, normal));
  return 0.5 + 0.5 * facing;
}

std::vector<ColourName> legend(const Labels& labels, const Image<std::uint8_t>& shown) {
  std::array<bool, 256> is_there{};
  for (const std::uint8_t label : shown.pixels) is_there[label] = true;
  std::vector<ColourName> names;
  for (const phantoms::LabelName& name : labels.names) {
    if (!is_there[name.label]) continue;
    names.push_back({display_colour(label_colour(name.label)),
                     std::to_string(name.label) + " " + spaced(name.name)});
  }
  return names;
}

Panel part_panel(const Truth& truth, const Labels& labels, const render::Camera& camera) {
  Panel panel{.title = "true part of each pixel",
              .picture = Picture3(truth.kind.width, truth.kind.height, display_colour(0x2b2b2b)),
              .names = legend(labels, truth.part),
              .mm_per_pixel = camera.pixel_m() / kMillimetre};
  for (int row = 0; row < truth.kind.height; ++row) {
    for (int column = 0; column < truth.kind.width; ++column) {
      const std::uint8_t label = truth.part.at(column, row);
      if (label == 0) continue;
      panel.picture.at(column, row) = static_cast<float>(relief(truth, camera, column, row)) *
                                      display_colour(label_colour(label));
    }
  }
  return panel;
}

/// Crosses of the landmarks that the picture shows.
PanelLines crosses(const Labels& labels, const render::Camera& camera, bool visible) {
  PanelLines lines{.of = {display_colour(visible ? 0xffffff : kHidden),
                          visible ? "landmark, seen by the probe" : "landmark, not seen"},
                   .segments = {},
                   .width = 1.6};
  const double arm = 0.012 * camera.image_size;
  for (const SeenLandmark& landmark : labels.landmarks) {
    if (!landmark.in_picture || landmark.is_visible() != visible) continue;
    const glm::dvec2 at(landmark.at.column, landmark.at.row);
    lines.segments.push_back({at - glm::dvec2(arm, 0), at + glm::dvec2(arm, 0)});
    lines.segments.push_back({at - glm::dvec2(0, arm), at + glm::dvec2(0, arm)});
  }
  return lines;
}

/// Why the probe does not see a pixel; empty: it does.
std::string why_not(TruthKind kind, std::uint8_t before, const Labels& labels) {
  switch (kind) {
    case TruthKind::none:
      return "nothing";
    case TruthKind::outside_field:
      return "outside_field";
    case TruthKind::surface:
    case TruthKind::grazing:
    case TruthKind::shadowed:
      break;
  }
  if (before != 0) return "behind " + name_of(labels, before);
  if (kind == TruthKind::grazing) return "grazing";
  return kind == TruthKind::shadowed ? "shadowed" : "";
}

std::uint32_t visibility_colour(TruthKind kind, std::uint8_t before) {
  if (kind == TruthKind::none) return 0x2b2b2b;
  if (kind == TruthKind::outside_field) return 0x6b5a2e;
  if (before != 0) return label_colour(before);
  if (kind == TruthKind::grazing) return 0x8f8f8f;
  return kind == TruthKind::shadowed ? 0xa45bb5 : kSeen;
}

Panel visibility_panel(const Truth& truth, const Labels& labels, const render::Camera& camera) {
  Panel panel{.title = "what the probe sees",
              .picture = Picture3(truth.kind.width, truth.kind.height),
              .names = {{display_colour(kSeen), "seen"},
                        {display_colour(0x8f8f8f), "grazing"},
                        {display_colour(0xa45bb5), "shadowed"},
                        {display_colour(0x6b5a2e), "outside the field"}},
              .mm_per_pixel = camera.pixel_m() / kMillimetre};
  Image<std::uint8_t> hiding(truth.kind.width, truth.kind.height, 0);
  for (int row = 0; row < truth.kind.height; ++row) {
    for (int column = 0; column < truth.kind.width; ++column) {
      const TruthKind kind = truth.kind.at(column, row);
      const std::uint8_t before = labels.before.at(column, row);
      const double light = kind == TruthKind::none ? 1.0 : relief(truth, camera, column, row);
      panel.picture.at(column, row) =
          static_cast<float>(light) * display_colour(visibility_colour(kind, before));
      if (kind != TruthKind::outside_field) hiding.at(column, row) = before;
    }
  }
  for (ColourName& name : legend(labels, hiding)) {
    panel.names.push_back({name.colour, "behind " + name.name});
  }
  return panel;
}

}  // namespace

LabelMaps label_maps(const Truth& truth, const Labels& labels) {
  LabelMaps maps{converted<float>(truth.part),
                 converted<float>(labels.before),
                 {truth.kind.width, truth.kind.height}};
  for (std::size_t i = 0; i < maps.visible.pixels.size(); ++i) {
    maps.visible.pixels[i] =
        Labels::is_visible(truth.kind.pixels[i], labels.before.pixels[i]) ? 1.0F : 0.0F;
  }
  return maps;
}

std::uint32_t label_colour(std::uint8_t label) {
  for (const auto& [part, rgb] : kColours) {
    if (static_cast<std::uint8_t>(part) == label) return rgb;
  }
  return kUnnamed[label % kUnnamed.size()];
}

std::vector<Panel> label_panels(const Truth& truth,
                                const Labels& labels,
                                const render::Camera& camera) {
  Panel parts = part_panel(truth, labels, camera);
  for (const bool visible : {true, false}) {
    PanelLines lines = crosses(labels, camera, visible);
    if (!lines.segments.empty()) parts.lines.push_back(std::move(lines));
  }
  return {std::move(parts), visibility_panel(truth, labels, camera)};
}

Table label_table(const Truth& truth, const Labels& labels) {
  Table table{.name = "labels",
              .caption = "Parts of the true surface",
              .columns = {{"label"},
                          {"name", "part"},
                          {"pixels"},
                          {"visible_pixels", "seen by the probe"},
                          {"hiding_pixels", "pixels before which it lies"}}};
  struct Counts {
    int all = 0, visible = 0, hiding = 0;
  };
  std::array<Counts, 256> counts{};
  for (std::size_t i = 0; i < truth.part.pixels.size(); ++i) {
    const std::uint8_t part = truth.part.pixels[i], before = labels.before.pixels[i];
    ++counts[part].all;
    ++counts[before].hiding;
    if (Labels::is_visible(truth.kind.pixels[i], before)) ++counts[part].visible;
  }
  for (const phantoms::LabelName& name : labels.names) {
    const Counts& count = counts[name.label];
    table.add({static_cast<int>(name.label), name.name, count.all, count.visible, count.hiding});
  }
  return table;
}

Table landmark_table(const Labels& labels) {
  using L = SeenLandmark;
  const auto mm = [](int axis) {
    return [axis](const L& of) { return of.position_m[axis] / kMillimetre; };
  };
  return table_of<L>(
      {.name = "landmarks",
       .caption = "Landmarks: where they are in the probe frame and in the picture"},
      labels.landmarks,
      {{{"name", "landmark"}, &L::name},
       {{"x_mm", "x", "mm"}, mm(0)},
       {{"y_mm", "y", "mm"}, mm(1)},
       {{"z_mm", "z", "mm"}, mm(2)},
       {{"column", "column", "", 1}, [](const L& of) { return of.at.column; }},
       {{"row", "row", "", 1}, [](const L& of) { return of.at.row; }},
       {{"depth_mm", "depth", "mm"}, [](const L& of) { return of.at.depth_m / kMillimetre; }},
       {{"in_picture", "shown by its pixel"}, [](const L& of) { return of.in_picture ? 1 : 0; }},
       {{"visible", "seen by the probe"}, [](const L& of) { return of.is_visible() ? 1 : 0; }},
       {{"why_not", "why not"}, [&](const L& of) { return why_not(of.kind, of.before, labels); }}});
}

nlohmann::ordered_json labels_json(const Truth& truth, const Labels& labels) {
  return {{"parts", to_json(label_table(truth, labels))},
          {"landmarks", to_json(landmark_table(labels))}};
}

}  // namespace wobblebench::bench
