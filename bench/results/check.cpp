#include "bench/results/check.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

Json to_json(const std::vector<Check>& checks) {
  const auto text = [](const std::string& of) { return of.empty() ? Json(nullptr) : Json(of); };
  const auto number = [](double of) { return std::isfinite(of) ? Json(of) : Json(nullptr); };
  Json all = Json::array();
  for (const Check& check : checks) {
    all.push_back({{"name", check.name},
                   {"asked", text(check.asked)},
                   {"limit", number(check.limit)},
                   {"value", number(check.value)},
                   {"held", check.skipped.empty() ? Json(check.failure.empty()) : Json(nullptr)},
                   {"because", text(check.failure + check.skipped)}});
  }
  return all;
}

std::string verdict_text(const std::vector<Check>& checks) {
  std::string broken, held;
  for (const Check& check : checks) {
    if (check.asked.empty()) continue;
    const std::string asked = "`" + check.asked + "`";
    if (!check.failure.empty()) broken += "- **Failed**: " + asked + ": " + check.failure + "\n";
    if (check.failure.empty()) {
      held += "- Holds: " + asked + (check.output.empty() ? "" : ": " + check.output) + "\n";
    }
  }
  return broken + held;
}

}  // namespace wobblebench::bench
