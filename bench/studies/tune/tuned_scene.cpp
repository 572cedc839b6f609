#include <map>
#include <sstream>
#include <vector>

#include "base/number_text.h"
#include "bench/studies/tune/tune_report.h"

namespace wobblebench::bench {

std::string request_text(const TuneRequest& request) {
  std::string text = "least " + request.least;
  for (const TuneLimit& limit : request.limits) {
    text += &limit == &request.limits.front() ? " with " : " and ";
    text += limit.name + " <= " + significant(limit.most, 6);
  }
  return text;
}

std::string tuned_scene(const TuneResults& results) {
  const TuneCandidate& chosen = *results.chosen();
  const TradePlan& plan = results.work.plan;
  std::map<std::string, std::vector<std::string>> sections;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    const std::string& key = plan.axes[i].key;
    const auto dot = key.rfind('.');
    sections[key.substr(0, dot)].push_back(key.substr(dot + 1) + " = " +
                                           results.work.points[chosen.point].values[i]);
  }
  std::ostringstream toml;
  toml << "# `wobblebench tune`, " << request_text(results.options.request) << "; on "
       << results.fresh_seeds.size() << " fresh seeds of simulated sticks:";
  for (const TuneLimit& limit : results.options.request.limits) {
    toml << " " << limit.name << " " << significant(quantity_of(*chosen.fresh, limit.name), 3)
         << ",";
  }
  const std::string& least = results.options.request.least;
  toml << " " << least << " " << significant(quantity_of(*chosen.fresh, least), 3) << ".\n";
  for (const auto& [section, lines] : sections) {
    toml << "\n[" << section << "]\n";
    for (const std::string& line : lines) toml << line << "\n";
  }
  return toml.str();
}

}  // namespace wobblebench::bench
