// What the command `run` produces: sticks, picture, and their comparison with the truth.
#pragma once

#include <optional>
#include <string>

#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/depth_error.h"
#include "bench/evaluation/image_similarity.h"
#include "bench/evaluation/registration.h"
#include "bench/evaluation/truth.h"
#include "bench/pipeline/acquire.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// The picture against the truth per pixel.
struct PictureError {
  DepthError raw;          ///< of pass 2's z
  DepthError filtered;     ///< of pass 3's z
  ImageSimilarity shaded;  ///< of the surface image, with the truth shaded alike
};

PictureError measure_picture_error(const render::Picture& picture,
                                   const Truth& truth,
                                   const render::RenderOptions& options);

struct Comparison {
  Truth truth;
  PictureError error;
  std::optional<Registration> registration;       ///< none: not asked for
  std::optional<PictureError> before_correction;  ///< none: z is not corrected
};

struct RunResult {
  Acquisition acquisition;
  render::Picture picture;
  std::string gl_backend;                ///< as --gl takes it
  std::string gl_renderer;               ///< GL_RENDERER and GL_VERSION
  std::optional<Comparison> comparison;  ///< none: the samples are not of the scene's phantom
  PhantomCache::Kept kept;               ///< what was read from the cache
};

}  // namespace wobblebench::bench
