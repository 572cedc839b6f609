#include "sim/rungs/geometry_model.h"

#include <stdexcept>

#include "sim/receive/receiver.h"
#include "sim/rungs/stick_propagation.h"

namespace wobblebench::sim {

namespace {

constexpr std::string_view kGeometryEffects[] = {
    "tissue_echo", "tissue_motion", "log_compression", "line_filter", "persistence", "grey_levels"};

}  // namespace

constinit const EchoModelType GeometryModel::kType = {
    .name = "geometry",
    .lower = nullptr,
    .added_effects = kGeometryEffects,
    .reach_m = [](const hw::AcquisitionPlan&) { return 0.0; },
    .memory =
        [](const hw::AcquisitionPlan&, const SimulationOptions&, bool) { return EchoMemory{}; },
    .make = [](const ScannedTissue& tissue,
               const hw::AcquisitionPlan& plan,
               const SimulationOptions& options,
               const EchoStore&) -> std::unique_ptr<const EchoModel> {
      return std::make_unique<GeometryModel>(tissue, plan, options);
    }};

GeometryModel::GeometryModel(const ScannedTissue& tissue,
                             const hw::AcquisitionPlan& plan,
                             const SimulationOptions& options)
    : tissue_(tissue), plan_(plan) {
  for (const auto& material : tissue.materials) {
    const double mean = amplitude_of_db(material.backscatter_db);
    sample_of_material_.push_back(
        options.output == hw::SampleScale::linear_envelope
            ? static_cast<float>(mean / amplitude_of_db(options.full_scale_db))
            : log_compressed(mean, options));
  }
}

StickMaker GeometryModel::stick_maker(const IqSink& iq) const {
  if (iq) throw std::logic_error("the rung geometry makes no IQ samples");
  return [this, track = StickTrack()](std::uint64_t sequence, std::span<float> samples) mutable {
    const TimedRay line = stick_ray(plan_, plan_.index(sequence));
    follow(tissue_, line, plan_.acquisition().depth_m, track, Surfaces::crossed);
    fill(track, samples);
  };
}

void GeometryModel::fill(const StickTrack& track, std::span<float> samples) const {
  const int count = static_cast<int>(samples.size());
  int k = 0;
  for (const Stretch& stretch : track.stretches) {
    const bool is_last = &stretch == &track.stretches.back();
    while (k < count && (is_last || plan_.sample_range_m(k) < stretch.to_m)) {
      samples[static_cast<std::size_t>(k++)] =
          sample_of_material_[static_cast<std::size_t>(stretch.material)];
    }
  }
}

}  // namespace wobblebench::sim
