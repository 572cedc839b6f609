#include "sim/rungs/scatterers_model.h"

#include <algorithm>

#include "sim/rungs/field_model.h"
#include "sim/rungs/stick_propagation.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

constexpr std::string_view kScatterersEffects[] = {"scatterers_in_tissue", "side_lobes"};

}  // namespace

constinit const EchoModelType ScatterersModel::kType = {
    .name = "scatterers",
    .lower = &FieldModel::kType,
    .added_effects = kScatterersEffects,
    .reach_m = &ScatterersModel::reach_m,
    .memory = [](const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 bool tissue_moves) { return iq_memory(plan, options, tissue_moves, 0); },
    .make = &make_iq_model<ScatterersModel>};

double ScatterersModel::reach_m(const hw::AcquisitionPlan&) {
  return 2e-3;
}

ScatterersModel::ScatterersModel(const ScannedTissue& tissue,
                                 const ProbeOptics& optics,
                                 const SimulationOptions& options)
    : IqModel(optics.plan(), options),
      tissue_(tissue),
      propagation_(tissue_, optics, options, Surfaces::crossed),
      scatterers_(tissue_,
                  optics,
                  options,
                  ScattererSettings::of(options, highest_frequency(tissue_, optics, options))),
      points_(tissue_, scatterers_.beam()) {}

IqMaker ScatterersModel::iq_maker() const {
  const auto samples = static_cast<std::size_t>(propagation_.samples());
  return [this, propagation = propagation_, points = points_, iq = std::vector<Complex>(samples)](
             const hw::StickIndex& index) mutable {
    propagation.follow(index);
    std::fill(iq.begin(), iq.end(), Complex(0));
    scatterers_.add_echoes(propagation.path(), iq);
    propagation.vary_tissue(iq);
    const auto near = points.find(propagation.path());
    if (!near.empty()) scatterers_.add_points(propagation.path(), near, iq);
    propagation.add_specular_echoes(iq);
    propagation.add_clutter(iq);
    return std::span<const Complex>(iq);
  };
}

}  // namespace wobblebench::sim
