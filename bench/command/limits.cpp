#include "bench/command/limits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "base/near_name.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"

namespace wobblebench::bench {

namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

constexpr int kDigits = 6;

std::string text_of(const Limit& limit) {
  return limit.name + "<=" + significant(limit.most, kDigits);
}

const LimitedFigure& figure_of(const Limit& limit, const std::vector<LimitedFigure>& figures) {
  const auto found = std::ranges::find(figures, limit.name, &LimitedFigure::name);
  if (found == figures.end()) throw std::logic_error("no figure " + limit.name);
  return *found;
}

/// Why the limit does not hold; empty: it does.
std::string excess(const Limit& limit, const LimitedFigure& figure) {
  if (std::isnan(figure.value)) {
    const std::string& why = figure.because;
    return limit.name + " is not formed" + (why.empty() ? why : ": " + why);
  }
  if (std::abs(figure.value) <= limit.most) return "";
  return limit.name + " is " + significant(figure.value, kDigits);
}

}  // namespace

Limit parse_limit(const std::string& text, const std::vector<std::string>& names) {
  const auto at = text.find("<=");
  if (at == std::string::npos) {
    throw UserError("--limit = " + text + ": must be NAME<=NUMBER, as p95_mm<=2");
  }
  Limit limit{text.substr(0, at), 0};
  if (std::ranges::find(names, limit.name) == names.end()) {
    throw UserError("--limit = " + limit.name + ": must be one of " + joined(names) +
                    did_you_mean(limit.name, names));
  }
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + at + 2, end, limit.most);
  if (error != std::errc() || stop != end || !std::isfinite(limit.most) || limit.most < 0) {
    throw UserError("--limit = " + text + ": must be NAME<=NUMBER with a number of 0 or more");
  }
  return limit;
}

std::vector<Limit> parse_limits(const std::vector<std::string>& texts,
                                const std::vector<std::string>& names) {
  std::vector<Limit> limits;
  limits.reserve(texts.size());
  for (const std::string& text : texts) limits.push_back(parse_limit(text, names));
  return limits;
}

void add_limit_option(CLI::App& command,
                      std::vector<std::string>& limits,
                      const std::vector<std::string>& names) {
  add_list(command,
           "--limit",
           limits,
           "NAME<=NUMBER, as " + names.front() +
               "<=2 (repeatable): exit code 1 where it does not hold. NAME: " + joined(names));
}

void check_limits(const std::vector<Limit>& limits,
                  const std::vector<LimitedFigure>& figures,
                  CommandResult& result) {
  for (const Limit& limit : limits) {
    const LimitedFigure& figure = figure_of(limit, figures);
    const std::string why = excess(limit, figure);
    result.checks.push_back({.group = "limits",
                             .name = text_of(limit),
                             .failure = why,
                             .output = limit.name + " = " + significant(figure.value, kDigits)});
    if (why.empty()) continue;
    result.exit_code = kFailed;
    if (!result.failure.empty()) result.failure += "\n";
    result.failure.append("--limit ").append(text_of(limit)).append(": ").append(why);
  }
}

}  // namespace wobblebench::bench
