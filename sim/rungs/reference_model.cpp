#include "sim/rungs/reference_model.h"

#include <algorithm>

#include "sim/rungs/scatterers_model.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<float>;

constexpr std::string_view kEffects[] = {"element_sum"};

}  // namespace

constinit const EchoModelType ReferenceModel::kType = {
    .name = "reference",
    .lower = &ScatterersModel::kType,
    .added_effects = kEffects,
    .reach_m = &ScatterersModel::reach_m,
    .memory = [](const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 bool tissue_moves) { return iq_memory(plan, options, tissue_moves, 0); },
    .make = &make_iq_model<ReferenceModel>};

ReferenceModel::ReferenceModel(const ScannedTissue& tissue,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options)
    : IqModel(plan, options),
      tissue_(tissue),
      propagation_(tissue_, plan, options, Surfaces::crossed),
      scene_(tissue_, plan, options) {}

IqMaker ReferenceModel::iq_maker() const {
  const auto samples = static_cast<std::size_t>(propagation_.samples());
  return [this,
          propagation = propagation_,
          points = scene_.points(),
          iq = std::vector<Complex>(samples)](const hw::StickIndex& index) mutable {
    propagation.follow(index);
    std::fill(iq.begin(), iq.end(), Complex(0));
    scene_.add_echoes(propagation.path(), iq);
    scene_.add_points(propagation.path(), points.find(propagation.path()), iq);
    propagation.add_specular_echoes(iq);
    return std::span<const Complex>(iq);
  };
}

}  // namespace wobblebench::sim
