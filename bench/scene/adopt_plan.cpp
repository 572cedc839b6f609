#include "bench/scene/adopt_plan.h"

#include <nlohmann/json.hpp>

#include "base/user_error.h"
#include "bench/scene/available_memory.h"
#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

/// The value of a dotted key whose section has no dot; null for any other.
nlohmann::ordered_json value_of(const nlohmann::ordered_json& scene, const std::string& key) {
  const auto dot = key.find('.');
  const auto section = scene.find(key.substr(0, dot));
  if (section == scene.end()) return nullptr;
  const auto value = section->find(key.substr(dot + 1));
  return value == section->end() ? nlohmann::ordered_json(nullptr) : *value;
}

bool belongs_to_plan(const std::string& key) {
  return key.starts_with("acquisition.") || key.starts_with("probe.");
}

}  // namespace

void adopt_plan(Scene& scene, const hw::AcquisitionPlan& plan, const std::string& source) {
  const auto before = resolved(scene);
  static_cast<hw::ProbeOptions&>(scene.probe) = plan.probe();
  scene.acquisition = plan.acquisition();
  const auto after = resolved(scene);
  for (const std::string& key : scene.given) {
    if (!belongs_to_plan(key)) continue;
    const auto wanted = value_of(before, key);
    const auto delivered = value_of(after, key);
    if (wanted == delivered) continue;
    throw UserError(key + " = " + wanted.dump() + ": " + source + " delivers " + delivered.dump());
  }
  check_memory(scene, source, available_memory_bytes());
}

}  // namespace wobblebench::bench
