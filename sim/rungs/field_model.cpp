#include "sim/rungs/field_model.h"

#include <algorithm>
#include <cmath>

#include "sim/math/fast_math.h"
#include "sim/rungs/geometry_model.h"
#include "sim/rungs/stick_propagation.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

constexpr std::string_view kFieldEffects[] = {"attenuation",
                                              "transmission_loss",
                                              "aperture_losses",
                                              "tissue_sound_speed",
                                              "beam_width",
                                              "speckle",
                                              "interface_echo",
                                              "tissue_unevenness",
                                              "point_scatterers",
                                              "particles",
                                              "reverberation",
                                              "haze",
                                              "noise",
                                              "envelope",
                                              "low_pass",
                                              "time_gain"};

/// parts[i] = speckle[i] * sqrt(power[i]) for `count` complex values, each a pair of floats.
WOBBLEBENCH_SIMD void scale_by_root(const float* speckle,
                                    const float* power,
                                    int count,
                                    float* __restrict parts) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float amplitude = std::sqrt(power[i]);
    parts[at] = speckle[at] * amplitude;
    parts[at + 1] = speckle[at + 1] * amplitude;
  }
}

}  // namespace

constinit const EchoModelType FieldModel::kType = {
    .name = "field",
    .lower = &GeometryModel::kType,
    .added_effects = kFieldEffects,
    .reach_m = &MeanPower::reach_m,
    .memory =
        [](const hw::AcquisitionPlan& plan, const SimulationOptions& options, bool tissue_moves) {
          return iq_memory(plan, options, tissue_moves, options.speckle ? iq_bytes(plan) : 0);
        },
    .make = &make_iq_model<FieldModel>};

FieldModel::FieldModel(const ScannedTissue& tissue,
                       const ProbeOptics& optics,
                       const SimulationOptions& options)
    : IqModel(optics.plan(), options),
      tissue_(tissue),
      propagation_(tissue_, optics, options, Surfaces::nearby),
      mean_power_(optics,
                  options,
                  tissue_.materials,
                  propagation_.spacing_m(),
                  propagation_.samples(),
                  tissue_.map->reach_m()),
      has_speckle_(options.speckle) {
  if (tissue_.has_points()) {
    const auto settings =
        ScattererSettings::of(options, highest_frequency(tissue_, optics, options));
    echoing_ = ScattererField(tissue_, optics, options, settings);
    points_ = PointsInBeam(tissue_, echoing_->beam());
  }
  if (has_speckle_) speckle_ = homogeneous_speckle(optics, options.seed);
}

IqMaker FieldModel::iq_maker() const {
  const auto samples = static_cast<std::size_t>(propagation_.samples());
  return [this,
          propagation = propagation_,
          mean_power = mean_power_,
          power = std::vector<float>(samples),
          iq = std::vector<Complex>(samples),
          points = points_](const hw::StickIndex& index) mutable {
    propagation.follow(index);
    if (!mean_power.compute(
            propagation.track(), propagation.losses(), propagation.theta_rad(), power)) {
      std::fill(iq.begin(), iq.end(), Complex(0));
    } else if (has_speckle_) {
      scale_by_root(parts_of(speckle_.stick(index).data()),
                    power.data(),
                    static_cast<int>(iq.size()),
                    parts_of(iq.data()));
    } else {
      std::transform(
          power.begin(), power.end(), iq.begin(), [](float p) { return Complex(std::sqrt(p)); });
    }
    propagation.vary_tissue(iq);
    propagation.add_specular_echoes(iq);
    if (points) echoing_->add_points(propagation.path(), points->find(propagation.path()), iq);
    propagation.add_clutter(iq);
    return std::span<const Complex>(iq);
  };
}

}  // namespace wobblebench::sim
