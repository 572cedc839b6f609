#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/trade/trade_report.h"
#include "bench/studies/tune/tune_report.h"

namespace wobblebench::bench {

namespace {

/// What is asked for, then what it is made of.
std::vector<std::string> columns_of(const TuneRequest& request) {
  std::vector<std::string> columns{request.least};
  const auto add = [&](const std::string& name) {
    if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  };
  for (const TuneLimit& limit : request.limits) add(limit.name);
  for (const char* name : {"volume_ms", "p95_mm", "missed_percent", "false_percent"}) add(name);
  return columns;
}

std::string cell(const std::optional<TradeScore>& score, const std::string& name) {
  if (!score) return "refused";
  const double value = quantity_of(*score, name);
  return std::isfinite(value) ? significant(value, 3) : "none";
}

void write_head(const TuneResults& results, const std::string& machine, std::ostream& markdown) {
  const TradePlan& plan = results.work.plan;
  markdown << "# " << request_text(results.options.request)
           << "\n\nMade by `wobblebench tune`: " << machine << ". " << plan.axes.size()
           << " settings, " << plan.scenes.size() << " scenes, seeds " << plan.seeds.front()
           << " to " << plan.seeds.back() << "; " << results.evaluated << " points measured ("
           << results.refused << " were refused)";
  if (results.known > 0) markdown << " beside the " << results.known << " of the trade";
  markdown << ", search seed " << results.options.search.seed << ". Confirmed on the fresh seeds "
           << results.fresh_seeds.front() << " to " << results.fresh_seeds.back()
           << ". All sticks are simulated. Errors are means over the scenes.\n";
}

void write_candidates(const TuneResults& results, std::ostream& markdown) {
  const auto columns = columns_of(results.options.request);
  markdown
      << "\n## Candidates\n\nIn the order in which they were tried. A limit holds if a further "
         "seed exceeds it with a probability of 5 % or less (in brackets: that bound); times "
         "are compared as measured.\n\n| point | measured on |";
  for (const std::string& name : columns) markdown << " " << name << " |";
  markdown << " holds |\n| ---: | --- |";
  for (std::size_t i = 0; i < columns.size(); ++i) markdown << " ---: |";
  markdown << " --- |\n";
  for (const TuneCandidate& candidate : results.candidates) {
    markdown << "| " << candidate.point << " | searched seeds |";
    for (const std::string& name : columns)
      markdown << " " << cell(candidate.searched, name) << " |";
    markdown << " |\n| | fresh seeds |";
    for (const std::string& name : columns) {
      markdown << " " << cell(candidate.fresh, name);
      if (candidate.fresh && std::isfinite(upper_quantity(*candidate.fresh, name))) {
        markdown << " (" << significant(upper_quantity(*candidate.fresh, name), 3) << ")";
      }
      markdown << " |";
    }
    markdown << (candidate.holds ? " yes |\n" : " no |\n");
  }
}

void write_chosen(const TuneResults& results, std::ostream& markdown) {
  const TuneCandidate* chosen = results.chosen();
  markdown << "\n## Chosen\n\n";
  if (chosen == nullptr) {
    markdown << (results.candidates.empty() ? "No setting met the limits on the searched seeds.\n"
                                            : "No candidate held on fresh seeds.\n");
    return;
  }
  markdown << "Point " << chosen->point << ": " << point_text(results.work, chosen->point)
           << ". As a scene file: `tuned.toml`.\n";
  const std::set<std::string> ends(results.at_an_end.begin(), results.at_an_end.end());
  for (const std::string& key : ends) {
    markdown << "\n- `" << key
             << "` is at an end of what the plan allows; beyond it may lie something better.";
  }
  if (!ends.empty()) markdown << "\n";
  if (results.unseen.empty()) return;
  const auto columns = columns_of(results.options.request);
  markdown << "\n## On scenes that the search did not see\n\n| scene |";
  for (const std::string& name : columns) markdown << " " << name << " |";
  markdown << "\n| --- |";
  for (std::size_t i = 0; i < columns.size(); ++i) markdown << " ---: |";
  for (const UnseenScore& unseen : results.unseen) {
    markdown << "\n| " << unseen.scene << " |";
    for (const std::string& name : columns) markdown << " " << cell(unseen.score, name) << " |";
  }
  markdown << "\n";
}

}  // namespace

std::string tune_markdown(const TuneResults& results, const std::string& machine) {
  std::ostringstream markdown;
  write_head(results, machine, markdown);
  if (!results.candidates.empty()) write_candidates(results, markdown);
  write_chosen(results, markdown);
  return markdown.str();
}

}  // namespace wobblebench::bench
