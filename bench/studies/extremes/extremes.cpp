#include "bench/studies/extremes/extremes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/user_error.h"
#include "bench/pipeline/acquire.h"
#include "bench/scene/resolved_scene.h"
#include "bench/scene/scene.h"
#include "bench/studies/extremes/test_volumes.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

/// Where the settings are from, as refusals say it.
const std::string kSource = "extremes";

bool is_colour(const glm::vec3& colour) {
  const auto within = [](float value) { return value >= 0 && value <= 1.00001F; };
  return within(colour.r) && within(colour.g) && within(colour.b);
}

bool are_depths(const Image<float>& depth_m) {
  return std::none_of(
      depth_m.pixels.begin(), depth_m.pixels.end(), [](float z) { return std::isinf(z); });
}

bool are_colours(const Image<glm::vec3>& picture) {
  return std::all_of(picture.pixels.begin(), picture.pixels.end(), is_colour);
}

/// The case's scene, with a small scan and picture. Throws UserError.
Scene scene_of(const ExtremeCase& of, render::RenderPreset preset) {
  std::vector<std::string> settings = base_settings();
  settings.insert(settings.end(), of.settings.begin(), of.settings.end());
  return load_scene({}, settings, kSource, preset);
}

ResolvedScene resolved_case(const ExtremeCase& of, const Scene& scene, PhantomCache& cache) {
  if (of.sticks == StickSource::ball) return resolve_scene(scene, std::nullopt);
  return resolve_scene(scene, cache.phantom(scene.phantom));
}

hw::PolarVolume sticks_of(const ResolvedScene& scene, PhantomCache& cache) {
  if (!scene.subject()) return ball_volume(scene.plan());
  return acquire_simulated(scene, cache.tissue_maps()).volume;
}

bool is_one_sample(SampleChange change) {
  return change != SampleChange::none && change != SampleChange::all_zero &&
         change != SampleChange::all_one;
}

void render_case(ExtremeOutcome& outcome,
                 const Scene& scene,
                 const hw::PolarVolume& volume,
                 render::GlContext& context) {
  const ExtremeCase& of = outcome.of;
  if (!of.compared) {
    outcome.finite = is_finite({.picture = render_volume(context, volume, scene.render)});
    outcome.rendered = true;
    return;
  }
  const ChangedVolume changed = changed_volume(volume, of.change);
  const PassPictures pictures = run_passes(changed.given, scene.render, context);
  outcome.rendered = true;
  outcome.finite = is_finite(pictures);
  outcome.errors = pass_errors(pictures, changed.meant, scene.render);
  if (!is_one_sample(of.change)) return;
  const PassPictures before = run_passes(volume, scene.render, context);
  outcome.changed_out_of_reach =
      changed_out_of_reach(reached_pixels(volume, changed.meant, scene.render),
                           before.depth.cast_m,
                           pictures.depth.cast_m,
                           scene.render);
}

/// True if the refusal reads "extremes: SECTION.KEY = VALUE: what is allowed" and the key exists.
bool names_a_key(const std::string& refusal) {
  const std::string head = kSource + ": ";
  const std::size_t end = refusal.find(" = ");
  if (!refusal.starts_with(head) || end == std::string::npos) return false;
  const Scene defaults;
  nlohmann::ordered_json at = resolved(defaults);
  std::istringstream words(refusal.substr(head.size(), end - head.size()));
  for (std::string word; std::getline(words, word, '.');) {
    if (!at.is_object() || !at.contains(word)) return false;
    at = nlohmann::ordered_json(at.at(word));
  }
  return refusal.find('\n') == std::string::npos;
}

void judge(ExtremeOutcome& outcome) {
  auto& failures = outcome.failures;
  const MustHappen must = outcome.of.must;
  if (outcome.rendered && must == MustHappen::refuse) failures.emplace_back("was not refused");
  if (!outcome.rendered && must == MustHappen::render) failures.emplace_back("was refused");
  if (!outcome.rendered) {
    if (!names_a_key(outcome.refusal)) failures.emplace_back("the refusal names no key of a scene");
    return;
  }
  if (!outcome.finite) failures.emplace_back("not finite");
  for (const PassError& error : outcome.errors) {
    if (error.outside == 0) continue;
    failures.push_back(error.pass + ": " + std::to_string(error.outside) + " of " +
                       std::to_string(error.compared) + " beyond the bound");
  }
  if (outcome.changed_out_of_reach.value_or(0) > 0) {
    failures.push_back(std::to_string(*outcome.changed_out_of_reach) +
                       " pixels changed that the sample does not reach");
  }
}

}  // namespace

bool is_finite(const PassPictures& pictures) {
  const auto in_slice = [](const Image<float>& slice) {
    return std::all_of(
        slice.pixels.begin(), slice.pixels.end(), [](float v) { return std::isfinite(v); });
  };
  const auto& [slices, depth, shaded, picture] = pictures;
  return std::all_of(slices.slices.begin(), slices.slices.end(), in_slice) &&
         are_depths(depth.cast_m) && are_depths(picture.depth_m) &&
         are_depths(picture.filtered_depth_m) && are_colours(picture.volume) &&
         are_colours(shaded) && are_colours(picture.surface);
}

ExtremeOutcome run_extreme_case(const ExtremeCase& of,
                                render::RenderPreset preset,
                                render::GlContext& context,
                                PhantomCache& cache) {
  ExtremeOutcome outcome{of, std::string(to_string(preset))};
  try {
    const ResolvedScene scene = resolved_case(of, scene_of(of, preset), cache);
    render_case(outcome, scene.options(), sticks_of(scene, cache), context);
  } catch (const UserError& error) {
    outcome.refusal = error.what();
  } catch (const std::exception& error) {
    outcome.refusal = error.what();
    outcome.failures.push_back(std::string("after work had begun: ") + error.what());
  }
  judge(outcome);
  return outcome;
}

}  // namespace wobblebench::bench
