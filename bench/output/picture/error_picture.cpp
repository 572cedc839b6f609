#include "bench/output/picture/error_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

PixelClass class_of(bool found, TruthKind kind) {
  switch (kind) {
    case TruthKind::none:
      return found ? PixelClass::false_surface : PixelClass::none;
    case TruthKind::surface:
      return found ? PixelClass::none : PixelClass::missed;
    case TruthKind::outside_field:
      return PixelClass::outside_field;
    case TruthKind::grazing:
      return PixelClass::grazing;
    case TruthKind::shadowed:
      return PixelClass::shadowed;
  }
  return PixelClass::none;
}

const PixelClassName* name_of(PixelClass of) {
  for (const PixelClassName& name : pixel_class_names()) {
    if (name.of == of) return &name;
  }
  return nullptr;
}

}  // namespace

std::span<const PixelClassName> pixel_class_names() {
  static constexpr std::array<PixelClassName, 6> names = {
      {{PixelClass::missed, "missed", 0xf0d000},
       {PixelClass::false_surface, "false", 0x00b37d},
       {PixelClass::grazing, "grazing", 0x8f8f8f},
       {PixelClass::shadowed, "shadowed", 0xa45bb5},
       {PixelClass::outside_field, "outside the field", 0x6b5a2e},
       {PixelClass::drawn, "drawn beyond", 0xe07ab8}}};
  return names;
}

Image<PixelClass> pixel_classes(const render::Picture& picture, const Truth& truth) {
  const Image<float>& depth_m = picture.depth_m;
  Image<PixelClass> classes(depth_m.width, depth_m.height);
  for (std::size_t i = 0; i < classes.pixels.size(); ++i) {
    const bool drawn = !picture.drawn.pixels.empty() && picture.drawn.pixels[i] == 1;
    classes.pixels[i] =
        drawn ? PixelClass::drawn : class_of(!std::isnan(depth_m.pixels[i]), truth.kind.pixels[i]);
  }
  return classes;
}

Panel error_panel(const Image<float>& error_m,
                  const Image<PixelClass>& classes,
                  double limit_mm,
                  double mm_per_pixel) {
  const double limit_m = limit_mm * kMillimetre;
  Panel panel{.title = "signed error",
              .picture = coloured(error_m, -limit_m, limit_m, diverging, display_colour(kNothing)),
              .bar = ColourBar{diverging, -limit_mm, limit_mm, "found minus true (mm)"},
              .mm_per_pixel = mm_per_pixel};
  for (std::size_t i = 0; i < classes.pixels.size(); ++i) {
    const PixelClassName* name = name_of(classes.pixels[i]);
    if (name != nullptr) panel.picture.pixels[i] = display_colour(name->rgb);
  }
  if (classes.pixels.empty()) return panel;
  for (const PixelClassName& name : pixel_class_names()) {
    panel.names.push_back({display_colour(name.rgb), name.name});
  }
  return panel;
}

Panel reason_panel(const Truth& truth, double mm_per_pixel) {
  static constexpr std::array<std::pair<const char*, std::uint32_t>, 5> names = {
      {{"0 nothing is crossed", kNothing},
       {"1 seen", 0xe8e8e8},
       {"2 outside the field", 0x6b5a2e},
       {"3 grazing", 0x8f8f8f},
       {"4 shadowed", 0xa45bb5}}};
  Panel panel{.title = "why a pixel has a true surface",
              .picture = Picture3(truth.kind.width, truth.kind.height),
              .mm_per_pixel = mm_per_pixel};
  std::ranges::transform(truth.kind.pixels, panel.picture.pixels.begin(), [](TruthKind kind) {
    return display_colour(names.at(static_cast<std::size_t>(kind)).second);
  });
  for (const auto& [name, rgb] : names) panel.names.push_back({display_colour(rgb), name});
  return panel;
}

}  // namespace wobblebench::bench
