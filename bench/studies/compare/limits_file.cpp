#include "bench/studies/compare/limits_file.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/near_name.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/results/counts.h"
#include "bench/results/error.h"
#include "bench/results/times.h"
#include "bench/scene/toml_file.h"
#include "bench/studies/compare/run_figures.h"

namespace wobblebench::bench {

namespace {

struct AllowedName {
  Allowed allowed;
  const char* key;
  const char* says;
};

constexpr std::array kAllowed = {
    AllowedName{Allowed::worse_by, "worse_by", "worse by at most "},
    AllowedName{Allowed::changed_by, "changed_by", "changed by at most "},
    AllowedName{Allowed::ratio, "ratio", "at most "},
    AllowedName{Allowed::equal, "equal", "equal"},
};

const AllowedName& name_of(Allowed allowed) {
  return *std::ranges::find(kAllowed, allowed, &AllowedName::allowed);
}

class LimitReader {
 public:
  explicit LimitReader(std::string file) : file_(std::move(file)) {}

  ChangeLimit read(const std::string& figure, const toml::node& node) const {
    const auto& known = run_figure_names();
    if (std::ranges::find(known, figure) == known.end()) {
      std::string list;
      for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
      fail(figure, "no figure of a run" + did_you_mean(figure, known) + "; there are " + list);
    }
    const toml::table* const table = node.as_table();
    if (table == nullptr || table->size() != 1) fail(figure, kForms);
    const std::string key(table->begin()->first.str());
    const auto* const found = std::ranges::find(kAllowed, key, &AllowedName::key);
    if (found == kAllowed.end()) fail(figure, kForms);
    return {figure, found->allowed, number_of(figure, *found, *table->get(key))};
  }

 private:
  static constexpr const char* kForms =
      "must be one of { worse_by = NUMBER }, { changed_by = NUMBER }, { ratio = NUMBER } and "
      "{ equal = true }";

  double number_of(const std::string& figure,
                   const AllowedName& of,
                   const toml::node& value) const {
    const std::string key = figure + "." + of.key;
    if (of.allowed == Allowed::equal) {
      if (value.value<bool>() != true) fail(key, "must be true; leave the limit out instead");
      return 0;
    }
    const auto number = value.is_number() ? value.value<double>() : std::nullopt;
    const double least = of.allowed == Allowed::ratio ? 1 : 0;
    if (!number || !std::isfinite(*number) || *number < least) {
      std::ostringstream shown;
      value.visit([&](const auto& concrete) { shown << concrete; });
      fail(key + " = " + shown.str(), "must be a number of " + significant(least, 1) + " or more");
    }
    return *number;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& allowed) const {
    throw UserError(file_ + ": limits." + key + ": " + allowed);
  }

  std::string file_;
};

}  // namespace

std::string text_of(const ChangeLimit& limit) {
  std::string says = name_of(limit.allowed).says;
  if (limit.allowed == Allowed::equal) return says;
  if (limit.allowed == Allowed::ratio && limit.most == 1) return "not more";
  if (limit.allowed == Allowed::ratio) return says + significant(limit.most, 4) + " times";
  const std::string unit = unit_of(limit.figure).name;
  return says + significant(limit.most, 4) + (unit.empty() || unit == "°" ? "" : " ") + unit;
}

std::vector<ChangeLimit> default_change_limits() {
  return {{error::kBias.key, Allowed::changed_by, 0.05},
          {error::kMedian.key, Allowed::changed_by, 0.05},
          {error::kRms.key, Allowed::worse_by, 0.1},
          {error::kP95.key, Allowed::worse_by, 0.1},
          {error::kOutsideP95.key, Allowed::worse_by, 0.05},
          {error::kMissed.key, Allowed::worse_by, 0.2},
          {error::kFalse.key, Allowed::worse_by, 0.2},
          {error::kNormalMedian.key, Allowed::worse_by, 0.5},
          {times::kFrame.key, Allowed::ratio, 1.25},
          {times::kCpu.key, Allowed::ratio, 1.25},
          {kPictureSsim.key, Allowed::worse_by, 0.005},
          {counts::kFetches.key, Allowed::ratio, 1},
          {counts::kSticks.key, Allowed::equal},
          {counts::kSamples.key, Allowed::equal}};
}

std::vector<ChangeLimit> read_change_limits(const std::filesystem::path& file) {
  const toml::table table = parse_toml_file(file, "a list of limits");
  const LimitReader reader(file.string());
  for (const auto& [key, unused] : table) {
    if (key.str() == "limits") continue;
    throw UserError(file.string() + ": " + std::string(key.str()) +
                    ": no such section; there is [limits] alone");
  }
  const toml::table* const limits = table["limits"].as_table();
  if (limits == nullptr || limits->empty()) {
    throw UserError(file.string() +
                    ": [limits]: must name a figure, as p95_mm = { worse_by = 0.1 }");
  }
  std::vector<ChangeLimit> read;
  for (const auto& [key, node] : *limits) read.push_back(reader.read(std::string(key.str()), node));
  return read;
}

}  // namespace wobblebench::bench
