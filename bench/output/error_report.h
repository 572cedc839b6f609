// "error" of report.json: everything that is measured of a picture against the truth.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// In mode "volume" no surface is computed, so that none is missed.
bool computes_surface(const ResolvedScene& scene);

/// Which figures of the surface can be formed.
struct Sought {
  bool surface = false;  ///< the renderer seeks one; in mode "volume" none is missed
  /// The phantom has one. What a detector finds among point scatterers, or within tissue that fills
  /// the picture, is neither right nor false.
  bool target = false;
};

Sought sought_in(const ResolvedScene& scene);

/// Why the truth shows no surface in the picture; empty: it shows one.
std::string why_none(const DepthError& raw, const Sought& sought);

/// Lengths in mm, angles in degrees. Figures that cannot be formed are null: where no surface was
/// sought (mode "volume"), and where there is none to be found.
nlohmann::ordered_json error_json(const PictureMeasures& measures, const Sought& sought);

}  // namespace wobblebench::bench
