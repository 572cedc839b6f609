#include "render/reconstruction/reconstruction.h"

#include <limits>

#include "render/reconstruction/stick_edges.h"

namespace wobblebench::render {

bool needs_levels(const RenderOptions& options) {
  return options.ray_casting.detector != Detector::paper ||
         options.reconstruction.sticks == Sticks::aligned;
}

double detection_level(const EchoLevels& levels, const RayCastingOptions& options) {
  if (!levels.separate) return std::numeric_limits<double>::infinity();
  const double rise = options.iso_level * (levels.tissue - levels.fluid);
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

std::vector<std::vector<float>> Reconstruction::aligned_frames(
    const std::vector<std::vector<float>>& received,
    const MotorAngles& angles,
    const EchoLevels& levels) const {
  const ReconstructionOptions& o = options_.reconstruction;
  const auto edges = find_stick_edges(
      plan_, received, spans(angles), levels, options_.ray_casting.edge, o.edge_level);
  return align_sticks(
      plan_, dense_factors(plan_, options_), received, angles, edges, o.steepest_rad);
}

}  // namespace wobblebench::render
