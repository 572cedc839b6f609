#include "render/reconstruction/reconstruction.h"

#include <algorithm>
#include <limits>

#include "render/reconstruction/stick_edges.h"
#include "render/reconstruction/stick_levels.h"

namespace wobblebench::render {

bool needs_levels(const RenderOptions& options) {
  return options.ray_casting.detector != Detector::paper ||
         options.reconstruction.sticks == Sticks::aligned;
}

double detection_level(const EchoLevels& levels, const RayCastingOptions& options) {
  if (!levels.separate) return std::numeric_limits<double>::infinity();
  const double rise = options.iso_level.value_or(kIsoLevel) * (levels.tissue - levels.fluid);
  return options.detector == Detector::floor ? rise : levels.fluid + rise;
}

Reconstruction::Reconstruction(const hw::AcquisitionPlan& plan, const RenderOptions& options)
    : plan_(plan), options_(options) {
  if (needs_levels(options)) planned_spans_ = spans_in_box(plan, options.volume_of_interest);
}

std::vector<SampleSpan> Reconstruction::spans(const MotorAngles& angles) const {
  if (angles.as_planned()) return planned_spans_;
  return spans_in_box(plan_, options_.volume_of_interest, angles);
}

EchoLevels Reconstruction::levels(const std::vector<std::vector<float>>& received,
                                  const MotorAngles& angles) const {
  return measure_levels(plan_, received, spans(angles));
}

PreparedSticks prepare_sticks(const hw::AcquisitionPlan& plan,
                              const std::vector<std::vector<float>>& received,
                              const std::vector<SampleSpan>& spans,
                              const EchoLevels& levels,
                              const hw::BeamWidths* beam,
                              const RenderOptions& options) {
  PreparedSticks sticks;
  sticks.edges = find_stick_edges(
      plan, received, spans, levels, options.ray_casting.edge, options.reconstruction.edge_level);
  if (!has_stick_levels(options) || !levels.separate) return sticks;
  const auto stick_levels = find_stick_levels(plan, received, sticks.edges, levels, *beam, options);
  const auto [lowest, highest] = std::ranges::minmax(stick_levels);
  sticks.range = {lowest, highest};
  sticks.levelled = level_sticks(plan, received, stick_levels, levels, levels.at(kIsoLevel));
  return sticks;
}

PreparedSticks Reconstruction::prepare(const std::vector<std::vector<float>>& received,
                                       const MotorAngles& angles,
                                       const EchoLevels& levels,
                                       const hw::BeamWidths* beam) const {
  if (!waits_for_volume()) return {};
  return prepare_sticks(plan_, received, spans(angles), levels, beam, options_);
}

std::vector<std::vector<float>> Reconstruction::frames(
    const std::vector<std::vector<float>>& received,
    const MotorAngles& angles,
    const PreparedSticks& sticks,
    std::vector<std::vector<float>> memory) const {
  const auto& samples = sticks.samples(received);
  if (!aligns()) return angles.as_planned() ? samples : place_frames(plan_, samples, angles);
  return align_sticks(plan_,
                      dense_factors(plan_, options_),
                      samples,
                      angles,
                      sticks.edges,
                      options_.reconstruction.steepest_rad,
                      std::move(memory));
}

}  // namespace wobblebench::render
