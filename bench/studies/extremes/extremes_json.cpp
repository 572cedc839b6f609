#include <nlohmann/json.hpp>

#include "bench/output/report_parts.h"
#include "bench/studies/extremes/extremes_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json errors_json(const std::vector<PassError>& errors) {
  Json list = Json::array();
  for (const PassError& error : errors) {
    list.push_back({{"pass", error.pass},
                    {"worst", number(error.worst)},
                    {"bound", number(error.bound)},
                    {"compared", error.compared},
                    {"outside", error.outside}});
  }
  return list;
}

}  // namespace

Json extremes_json(const ExtremesResults& results) {
  Json cases = Json::array(), numbers = Json::array();
  for (const ExtremeOutcome& outcome : results.cases) {
    Json json = {{"name", outcome.of.name},
                 {"preset", outcome.preset},
                 {"settings", outcome.of.settings},
                 {"passed", outcome.passed()},
                 {"failures", outcome.failures},
                 {"rendered", outcome.rendered}};
    if (!outcome.rendered) json["refusal"] = outcome.refusal;
    if (outcome.rendered) json["finite"] = outcome.finite;
    if (outcome.changed_out_of_reach) json["changed_out_of_reach"] = *outcome.changed_out_of_reach;
    json["passes"] = errors_json(outcome.errors);
    cases.push_back(std::move(json));
  }
  for (const NumberOutcome& outcome : results.numbers) {
    numbers.push_back({{"name", outcome.name},
                       {"passed", outcome.passed()},
                       {"worst", number(outcome.worst)},
                       {"bound", outcome.bound},
                       {"unit", outcome.unit}});
  }
  return {{"failed", results.failed()}, {"cases", cases}, {"numbers", numbers}};
}

}  // namespace wobblebench::bench
