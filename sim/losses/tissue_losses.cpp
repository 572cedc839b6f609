#include "sim/losses/tissue_losses.h"

#include "sim/losses/losses.h"

namespace wobblebench::sim {

TissueLosses::TissueLosses(const hw::AcquisitionPlan& plan,
                           const SimulationOptions& options,
                           const std::vector<phantoms::Material>& materials)
    : materials_(&materials), interfaces_(options.transmission_loss) {
  for (const auto& material : materials) {
    const double alpha = options.attenuation ? material.attenuation_db_per_cm_mhz : 0;
    nepers_per_m_.push_back(two_way_nepers_per_m(plan, alpha));
  }
}

double TissueLosses::transmission(const Interface& crossed) const {
  if (!interfaces_) return 1;
  const double r = reflection(materials_->at(static_cast<std::size_t>(crossed.before)),
                              materials_->at(static_cast<std::size_t>(crossed.behind)),
                              crossed.cos_incidence);
  return 1 - r * r;
}

}  // namespace wobblebench::sim
