#include "sim/rungs/echo_model.h"

#include <algorithm>
#include <stdexcept>

#include "sim/rungs/field_model.h"
#include "sim/rungs/geometry_model.h"
#include "sim/rungs/reference_model.h"
#include "sim/rungs/scatterers_model.h"

namespace wobblebench::sim {

bool volumes_repeat(const hw::AcquisitionPlan& plan, bool tissue_moves) {
  return !tissue_moves && plan.acquisition().motor != hw::MotorMode::alternating;
}

bool EchoModelType::models(std::string_view effect) const {
  return std::find(added_effects.begin(), added_effects.end(), effect) != added_effects.end() ||
         (lower != nullptr && lower->models(effect));
}

const EchoModelType& echo_model_type(Rung rung) {
  switch (rung) {
    case Rung::geometry:
      return GeometryModel::kType;
    case Rung::field:
      return FieldModel::kType;
    case Rung::scatterers:
      return ScatterersModel::kType;
    case Rung::reference:
      return ReferenceModel::kType;
    case Rung::automatic:
      break;
  }
  throw std::logic_error("Rung: no such rung");
}

std::unique_ptr<const EchoModel> make_echo_model(Rung rung,
                                                 const ScannedTissue& tissue,
                                                 const hw::AcquisitionPlan& plan,
                                                 const SimulationOptions& options) {
  return echo_model_type(rung).make(tissue, plan, options);
}

}  // namespace wobblebench::sim
