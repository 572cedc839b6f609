#include "bench/studies/tables/compared_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "base/statistics.h"
#include "base/units.h"
#include "bench/exchange/files/npy.h"
#include "bench/studies/tables/stage_times.h"
#include "hw/wire/crc32c.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kLayers = 6;
/// Float arithmetic in another order; a step of a ray is 150 to 310 micrometres.
constexpr float kArithmetic_m = 10e-6F;
constexpr std::array kSettings = {"paper", "default"};

/// z of pass 2, before its outline is smoothed and small pieces are left out.
Image<float> cast(const hw::PolarVolume& volume,
                  render::RenderOptions options,
                  render::GlContext& context) {
  options.ray_casting.outline_m = options.ray_casting.smallest_piece_m2 = 0;
  Image<float> cast_m;
  render::Renderer renderer(context, volume.plan(), options);
  render::RenderTaps taps;
  taps.depth = [&](const render::CastDepth& depth) -> std::optional<Image<float>> {
    cast_m = depth.cast_m;
    return {};
  };
  renderer.set_taps(taps);
  renderer.add_volume(volume);
  static_cast<void>(renderer.render());
  return cast_m;
}

/// The options with the detector's level moved by what samples may be off, `sign` times.
render::RenderOptions moved(render::RenderOptions options,
                            const std::optional<render::SurfaceLevels>& levels,
                            double sign) {
  auto& casting = options.ray_casting;
  if (casting.detector == render::Detector::paper) {
    casting.threshold += sign * casting.buffer_length * kFilterError;
  } else if (levels->separate) {  // else there is no surface at any level
    const double share = kFilterError / (levels->tissue - levels->fluid);
    if (casting.iso_level)
      *casting.iso_level += sign * share;
    else
      casting.below_tissue_db -= sign * kFilterError * options.reconstruction.display_range_db;
  }
  return options;
}

ComparedPicture compared(const std::string& settings,
                         const hw::PolarVolume& volume,
                         const render::RenderOptions& options,
                         render::GlContext& context) {
  render::Picture picture = render::render_volume(context, volume, options);
  return {settings,
          cast(volume, moved(options, picture.levels, -1), context),
          cast(volume, options, context),
          cast(volume, moved(options, picture.levels, 1), context),
          std::move(picture.surface)};
}

/// Nothing nearer than `nearest_m` and nothing farther than `farthest_m`; NaN is infinitely far.
bool is_explained(float z_m, float nearest_m, float farthest_m) {
  const auto far = [](float z) { return std::isnan(z) ? INFINITY : z; };
  return far(z_m) >= far(nearest_m) - kArithmetic_m && far(z_m) <= far(farthest_m) + kArithmetic_m;
}

void compare_light(const Image<glm::vec3>& here,
                   const Image<glm::vec3>& other,
                   PictureAgreement& agreement) {
  double squares = 0;
  for (std::size_t i = 0; i < here.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double apart = std::abs(here.pixels[i][c] - other.pixels[i][c]);
      squares += apart * apart;
      agreement.light_largest = std::max(agreement.light_largest, apart);
    }
  }
  agreement.light_rms = std::sqrt(squares / (3.0 * static_cast<double>(here.pixels.size())));
}

PictureAgreement agreement_of(const ComparedPicture& here, const ComparedPicture& other) {
  PictureAgreement agreement{.settings = here.settings};
  const std::size_t all = here.cast_m.pixels.size();
  std::size_t in_one = 0, unexplained = 0;
  std::vector<double> apart_mm;
  for (std::size_t i = 0; i < all; ++i) {
    const float z = here.cast_m.pixels[i], expected = other.cast_m.pixels[i];
    if (!is_explained(z, other.nearest_m.pixels[i], other.farthest_m.pixels[i])) ++unexplained;
    if (std::isnan(z) != std::isnan(expected)) ++in_one;
    if (std::isnan(z) || std::isnan(expected)) continue;
    apart_mm.push_back(std::abs(static_cast<double>(z) - expected) / kMillimetre);
  }
  agreement.pixels = static_cast<int>(apart_mm.size());
  agreement.found_in_one_share = static_cast<double>(in_one) / static_cast<double>(all);
  agreement.unexplained_share = static_cast<double>(unexplained) / static_cast<double>(all);
  compare_light(here.surface, other.surface, agreement);
  if (apart_mm.empty()) return agreement;
  double squares = 0;
  for (const double apart : apart_mm) squares += apart * apart;
  agreement.z_rms_mm = std::sqrt(squares / static_cast<double>(apart_mm.size()));
  agreement.z_p999_mm = quantile(apart_mm, 0.999);
  agreement.z_largest_mm = *std::ranges::max_element(apart_mm);
  return agreement;
}

Image<float> layer_of(const NumpyArray& array, std::size_t setting, std::size_t layer) {
  const auto height = static_cast<int>(array.shape[2]), width = static_cast<int>(array.shape[3]);
  Image<float> image(width, height);
  const std::size_t first = (setting * kLayers + layer) * image.pixels.size();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<float>(array.values[first + i]);
  }
  return image;
}

}  // namespace

std::vector<ComparedPicture> render_compared(const hw::PolarVolume& volume,
                                             render::GlContext& context,
                                             const TableRun& run) {
  return {compared(kSettings[0], volume, paper_settings(run), context),
          compared(kSettings[1], volume, default_settings(run), context)};
}

std::string compared_bytes(const std::vector<ComparedPicture>& pictures) {
  std::vector<float> values;
  for (const ComparedPicture& picture : pictures) {
    for (const auto* z : {&picture.nearest_m, &picture.cast_m, &picture.farthest_m}) {
      values.insert(values.end(), z->pixels.begin(), z->pixels.end());
    }
    for (int c = 0; c < 3; ++c) {
      for (const glm::vec3& light : picture.surface.pixels) values.push_back(light[c]);
    }
  }
  const auto& size = pictures.at(0).cast_m;
  const std::array<std::uint64_t, 4> shape = {pictures.size(),
                                              kLayers,
                                              static_cast<std::uint64_t>(size.height),
                                              static_cast<std::uint64_t>(size.width)};
  return npy_bytes(shape, values);
}

std::vector<ComparedPicture> read_compared(std::string_view bytes) {
  const NumpyArray array = read_npy(bytes);
  const auto& shape = array.shape;
  constexpr std::uint64_t kMostSide = 4096;
  if (shape.size() != 4 || shape[0] != kSettings.size() || shape[1] != kLayers || shape[2] == 0 ||
      shape[3] == 0 || shape[2] > kMostSide || shape[3] > kMostSide) {
    throw std::invalid_argument("must hold an array of shape 2, 6, rows, columns");
  }
  std::vector<ComparedPicture> pictures;
  for (std::size_t s = 0; s < kSettings.size(); ++s) {
    ComparedPicture picture{.settings = kSettings[s],
                            .nearest_m = layer_of(array, s, 0),
                            .cast_m = layer_of(array, s, 1),
                            .farthest_m = layer_of(array, s, 2),
                            .surface = {}};
    picture.surface = {picture.cast_m.width, picture.cast_m.height};
    for (int c = 0; c < 3; ++c) {
      const Image<float> light = layer_of(array, s, 3 + static_cast<std::size_t>(c));
      for (std::size_t i = 0; i < light.pixels.size(); ++i) {
        picture.surface.pixels[i][c] = light.pixels[i];
      }
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

std::uint32_t samples_crc(const hw::PolarVolume& volume) {
  std::uint32_t crc = 0;
  for (const hw::PolarFrame& frame : volume.frames()) {
    crc = hw::crc32c(std::as_bytes(std::span(frame.samples)), crc);
  }
  return crc;
}

std::vector<PictureAgreement> compare_pictures(const std::vector<ComparedPicture>& here,
                                               const std::vector<ComparedPicture>& other) {
  std::vector<PictureAgreement> agreements;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const Image<float>&a = here[i].cast_m, &b = other.at(i).cast_m;
    if (a.width != b.width || a.height != b.height) {
      throw std::invalid_argument("has pictures of " + std::to_string(b.width) + " x " +
                                  std::to_string(b.height) + " pixels; must be " +
                                  std::to_string(a.width) + " x " + std::to_string(a.height));
    }
    agreements.push_back(agreement_of(here[i], other[i]));
  }
  return agreements;
}

}  // namespace wobblebench::bench
