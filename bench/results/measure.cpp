#include "bench/results/measure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const MeasuredValue& found) {
  if (!std::isfinite(found.value)) return nullptr;
  return found.whole ? Json(static_cast<std::int64_t>(found.value)) : Json(found.value);
}

constexpr Unit kUnits[] = {{"_mm", "mm", 2},
                           {"_cm2", "cm²", 2},
                           {"_percent", "%", 2},
                           {"_deg", "°", 1},
                           {"_ms", "ms", 1},
                           {"_per_s", "/s", 2},
                           {"_db", "dB", 1},
                           {"", "", 3}};

}  // namespace

const Unit& unit_of(std::string_view key) {
  return *std::ranges::find_if(kUnits,
                               [&](const Unit& unit) { return key.ends_with(unit.ending); });
}

void Measurements::add(const Measure& measure, double value, bool whole) {
  const std::string name = (prefix_.empty() ? "" : prefix_ + "_") + measure.key;
  all_.push_back({&measure, value, whole, name, because_});
}

const MeasuredValue* Measurements::find(std::string_view name) const {
  const auto found = std::ranges::find(all_, name, &MeasuredValue::name);
  return found == all_.end() ? nullptr : &*found;
}

double Measurements::value(const Measure& measure) const {
  const MeasuredValue* const found = find(measure.key);
  return found ? found->value : std::numeric_limits<double>::quiet_NaN();
}

Json to_json(const Measurements& found) {
  Json json;
  for (const MeasuredValue& one : found) json[one.name] = json_of(one);
  return json;
}

}  // namespace wobblebench::bench
