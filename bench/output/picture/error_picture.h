// Signed depth errors as a picture that can be read: colours in millimetres, and colours of their
// own for surface that was missed, found where there is none, or cannot be seen.
#pragma once

#include <cstdint>
#include <span>

#include "bench/evaluation/truth/truth.h"
#include "bench/output/picture/panels.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// What a pixel is that has no signed error; 0: it has one, or nothing is there and nothing found.
enum class PixelClass : std::uint8_t {
  none = 0,
  missed,         ///< the probe can see a surface, and none was found
  false_surface,  ///< one was found where there is none
  grazing,        ///< as TruthKind, whether a surface was found or not
  shadowed,
  outside_field,
  drawn,  ///< z was not found but continues the surface (render::Picture::drawn), right or wrong
};

struct PixelClassName {
  PixelClass of;
  const char* name;
  std::uint32_t rgb;
};
/// All but `none`.
std::span<const PixelClassName> pixel_class_names();

Image<PixelClass> pixel_classes(const render::Picture& picture, const Truth& truth);

/// ± this is the whole colour bar of error.png and its like.
inline constexpr double kErrorLimit_mm = 3;

/// Where nothing is found and nothing is there.
inline constexpr std::uint32_t kNothing = 0x2b2b2b;

/// A panel of signed errors (NaN: none), found less true depth, with its colour bar.
/// `classes`: of each pixel; empty: none, and no names below the picture.
Panel error_panel(const Image<float>& error_m,
                  const Image<PixelClass>& classes = {},
                  double limit_mm = kErrorLimit_mm,
                  double mm_per_pixel = 0);

/// A panel that says why each pixel has a true surface or none (TruthKind), with the names of its
/// colours.
Panel reason_panel(const Truth& truth, double mm_per_pixel = 0);

}  // namespace wobblebench::bench
