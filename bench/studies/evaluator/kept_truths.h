// The true surfaces of the views that settings look along, each computed once.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/scene/resolved_scene.h"
#include "render/options.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

class KeptTruths {
 public:
  explicit KeptTruths(sim::TissueMapSource maps) : maps_(std::move(maps)) {}

  /// The truth of a view, with what the sticks of `rung` cannot hear. Valid until the next call.
  const TrueView& of(const ResolvedScene& scene,
                     sim::Rung rung,
                     const render::RenderOptions& options);
  /// The same, shaded; nullptr where the shading depends on the picture, too.
  const Image<glm::vec3>* shaded(const ResolvedScene& scene,
                                 sim::Rung rung,
                                 const render::RenderOptions& options);

 private:
  sim::TissueMapSource maps_;
  std::map<sim::Rung, StickReach> reach_;
  std::map<std::string, TrueView> truths_;          ///< by what they depend on
  std::map<std::string, Image<glm::vec3>> shaded_;  ///< likewise
};

}  // namespace wobblebench::bench
