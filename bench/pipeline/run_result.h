// What the command `run` produces: sticks, picture, and their comparison with the truth.
#pragma once

#include <optional>
#include <string>

#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/evaluation/registration/registration.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/pipeline/acquire.h"
#include "render/picture.h"

namespace wobblebench::bench {

struct Comparison {
  Truth truth;
  PictureMeasures error;
  std::optional<Registration> registration = {};          ///< none: not asked for
  std::optional<PictureMeasures> before_correction = {};  ///< none: z is not corrected
};

struct RunResult {
  Acquisition acquisition;
  render::Picture picture;
  std::string gl_backend;                ///< as --gl takes it
  std::string gl_renderer;               ///< GL_RENDERER and GL_VERSION
  std::optional<Comparison> comparison = {};  ///< none: the samples are not of the scene's phantom
  PhantomCache::Kept kept = {};               ///< what was read from the cache
};

}  // namespace wobblebench::bench
