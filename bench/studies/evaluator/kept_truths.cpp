#include "bench/studies/evaluator/kept_truths.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "bench/scene/scene.h"
#include "render/view.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kMost = 8;

/// Every render option, as a text that two settings share only if they are equal.
std::string key_of(sim::Rung rung, const render::RenderOptions& options) {
  Scene scene;
  scene.render = options;
  return sim::to_string(rung) + resolved(scene).dump();
}

/// What the true surface of a pixel depends on.
render::RenderOptions view_of(const render::RenderOptions& options) {
  render::RenderOptions view;
  view.view = options.view;
  view.volume_of_interest = options.volume_of_interest;
  view.ray_casting.image_size = options.ray_casting.image_size;
  view.ray_casting.edge = options.ray_casting.edge;
  return view;
}

/// The value of the key, made where there is none.
template <class Value, class Make>
const Value& kept(std::map<std::string, Value>& values, const std::string& key, const Make& make) {
  const auto found = values.find(key);
  if (found != values.end()) return found->second;
  Value made = make();
  if (values.size() >= kMost) values.clear();
  return values.emplace(key, std::move(made)).first->second;
}

}  // namespace

const TrueView& KeptTruths::of(const ResolvedScene& scene,
                               sim::Rung rung,
                               const render::RenderOptions& options) {
  return kept(truths_, key_of(rung, view_of(options)), [&] {
    if (!reach_.contains(rung)) reach_.emplace(rung, StickReach(scene, maps_));
    const render::View view = render::make_view(options);
    return TrueView(true_surface(scene, view, reach_.at(rung)), view.camera);
  });
}

const Image<glm::vec3>* KeptTruths::shaded(const ResolvedScene& scene,
                                           sim::Rung rung,
                                           const render::RenderOptions& options) {
  if (options.shading.base == render::ShadingBase::rendered) return nullptr;
  render::RenderOptions shown = view_of(options);
  shown.shading = options.shading;
  shown.smoothing = options.smoothing;
  return &kept(shaded_, key_of(rung, shown), [&] {
    return shade_truth(of(scene, rung, options).truth, options, {});
  });
}

}  // namespace wobblebench::bench
