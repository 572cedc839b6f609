// A picture against the truth, whoever made it: what summaries say of it.
#pragma once

#include <optional>
#include <string>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/evaluation/registration/registration.h"
#include "bench/evaluation/truth/labels.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/scene/resolved_scene.h"
#include "render/picture.h"

namespace wobblebench::bench {

struct Comparison {
  Truth truth;
  PictureMeasures error;
  Image<glm::vec3> shaded_truth = {};             ///< light, as shade_truth() makes it
  std::optional<Registration> registration = {};  ///< none: not asked for
  std::optional<Labels> labels = {};              ///< none: not asked for
};

/// A picture against the truth, whoever made it.
struct PictureResult {
  render::Picture picture;
  std::optional<Comparison> comparison = {};  ///< none: what the picture shows is not known
};

/// Three significant digits; no decimals from 100 on.
std::string rounded(double value);
/// Likewise of metres, in millimetres.
std::string in_mm(double metres);

/// Lines of a summary.
std::string error_text(const Comparison& comparison, const ResolvedScene& scene);

}  // namespace wobblebench::bench
