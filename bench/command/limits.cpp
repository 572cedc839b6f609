#include "bench/command/limits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
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

/// "; did you mean A or B?": the names that have every word of the text, else one that is spelt
/// nearly alike.
std::string nearest_figures(const std::string& text, const std::vector<std::string>& names) {
  const auto has_words = [&](const std::string& name) {
    std::istringstream words(text);
    bool all = !text.empty();
    for (std::string word; std::getline(words, word, '_');) {
      all = all && ("_" + name + "_").find("_" + word + "_") != std::string::npos;
    }
    return all;
  };
  std::string near;
  for (const std::string& name : names) {
    if (has_words(name)) near += (near.empty() ? "; did you mean " : " or ") + name;
  }
  return near.empty() ? did_you_mean(text, names) : near + "?";
}

constexpr int kDigits = 6;

/// Why the limit does not hold; empty: it does.
std::string excess(const Limit& limit, const MeasuredValue& figure) {
  if (std::isnan(figure.value)) {
    const std::string& why = figure.because;
    return limit.name + " is not formed" + (why.empty() ? why : ": " + why);
  }
  if (std::abs(figure.value) <= limit.most) return "";
  return limit.name + " is " + significant(figure.value, kDigits);
}

}  // namespace

std::string text_of(const Limit& limit) {
  return limit.name + "<=" + significant(limit.most, kDigits);
}

Limit parse_limit(const std::string& text, const std::vector<std::string>& names) {
  const auto at = text.find("<=");
  if (at == std::string::npos) {
    throw UserError("--limit = " + text + ": must be NAME<=NUMBER, as p95_mm<=2");
  }
  Limit limit{text.substr(0, at), 0};
  if (std::ranges::find(names, limit.name) == names.end()) {
    throw UserError("--limit = " + limit.name + ": must be one of " + joined(names) +
                    nearest_figures(limit.name, names));
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

std::vector<std::string> limit_names(const Measurements& figures) {
  std::vector<std::string> names;
  for (const MeasuredValue& one : figures) {
    const Worse worse = one.measure->worse;
    if (worse == Worse::higher || worse == Worse::away_from_zero) names.push_back(one.name);
  }
  return names;
}

void check_limits(const std::vector<Limit>& limits,
                  const Measurements& figures,
                  CommandResult& result) {
  for (const Limit& limit : limits) {
    const MeasuredValue* const figure = figures.find(limit.name);
    if (figure == nullptr) throw std::logic_error("no figure " + limit.name);
    add_check({.group = "limits",
               .name = text_of(limit),
               .failure = excess(limit, *figure),
               .output = limit.name + " = " + significant(figure->value, kDigits),
               .asked = "--limit " + text_of(limit),
               .limit = limit.most,
               .value = figure->value},
              result);
  }
}

}  // namespace wobblebench::bench
