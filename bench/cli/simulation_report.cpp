#include "bench/cli/simulation_report.h"

#include <nlohmann/json.hpp>

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

void report_fidelity(Json& report, const std::optional<sim::Fidelity>& fidelity) {
  Json ran = Json::array(), left_out = Json::array();
  report["simulation"] = nullptr;
  if (fidelity) {
    for (const sim::Effect& effect : fidelity->effects) {
      if (effect.left_out.empty()) {
        ran.push_back(effect.name);
      } else {
        left_out.push_back({{"effect", effect.name}, {"why", effect.left_out}});
      }
    }
    report["simulation"] = {{"rung", sim::to_string(fidelity->rung)},
                            {"reason", fidelity->reason},
                            {"left_out", left_out}};
  }
  report["effects"] = ran;
}

}  // namespace wobblebench::bench
