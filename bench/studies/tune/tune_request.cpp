#include "bench/studies/tune/tune_request.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/user_error.h"
#include "bench/evaluation/seed_statistics.h"

namespace wobblebench::bench {

namespace {

constexpr double kNotFormed = 1e6;

struct Time {
  const char* name;
  double TradeScore::*value;
};

constexpr Time kTimes[] = {{"volume_ms", &TradeScore::volume_ms},
                           {"view_ms", &TradeScore::view_ms},
                           {"volume_ratio", &TradeScore::volume_ratio},
                           {"view_ratio", &TradeScore::view_ratio}};

const Time* time_of(const std::string& name) {
  const auto* found = std::find_if(
      std::begin(kTimes), std::end(kTimes), [&](const Time& time) { return time.name == name; });
  return found == std::end(kTimes) ? nullptr : found;
}

std::string all_quantities() {
  std::string names;
  for (const std::string& name : tune_quantities()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

double magnitude(const std::string& name, double value) {
  return name == "median_mm" ? std::abs(value) : value;
}

}  // namespace

const std::vector<std::string>& tune_quantities() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Time& time : kTimes) all.emplace_back(time.name);
    const auto& measures = trade_measure_names();
    all.insert(all.end(), measures.begin(), measures.end());
    return all;
  }();
  return names;
}

void check_quantity(const std::string& option, const std::string& name) {
  const auto& names = tune_quantities();
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw UserError(option + " = " + name + ": must be one of " + all_quantities());
}

TuneLimit parse_limit(const std::string& text) {
  const auto at = text.find("<=");
  if (at == std::string::npos) {
    throw UserError("--limit = " + text + ": must be NAME<=NUMBER, as p95_mm<=2");
  }
  TuneLimit limit{text.substr(0, at), 0};
  check_quantity("--limit", limit.name);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + at + 2, end, limit.most);
  if (error != std::errc() || stop != end || !std::isfinite(limit.most) || limit.most <= 0) {
    throw UserError("--limit = " + text + ": must be NAME<=NUMBER with a number above 0");
  }
  return limit;
}

double quantity_of(const TradeScore& score, const std::string& name) {
  if (const Time* time = time_of(name)) return score.*time->value;
  return magnitude(name, score.measures[trade_measure(name)].mean);
}

double upper_quantity(const TradeScore& score, const std::string& name) {
  if (const Time* time = time_of(name)) return score.*time->value;
  MeanInterval known = score.measures[trade_measure(name)];
  known.mean = magnitude(name, known.mean);
  return upper_of_next(known);
}

double excess_of(const TuneRequest& request, const TradeScore& score) {
  double sum = 0;
  for (const TuneLimit& limit : request.limits) {
    const double value = quantity_of(score, limit.name);
    if (!std::isfinite(value)) return kNotFormed;
    sum += std::max(0.0, value / limit.most - 1);
  }
  return std::isfinite(quantity_of(score, request.least)) ? sum : kNotFormed;
}

}  // namespace wobblebench::bench
