#include "bench/studies/trade/trade_plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "base/number_text.h"
#include "bench/scene/toml_file.h"
#include "bench/studies/accuracy/option_tables.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostLevels = 64;
constexpr int kRangeLevels = 4;

template <OptionsOf<TradePlan> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("design",
           o.design,
           {{"grid", TradeDesign::grid},
            {"latin_hypercube", TradeDesign::latin_hypercube},
            {"sobol", TradeDesign::sobol}});
  v.integer("points", o.points, 1, kMostTradePoints);
  v.seed("design_seed", o.design_seed);
  v.integer("repeats", o.repeats, 1, 100);
}

struct SeedOptions {
  int seeds = 3;
  std::uint64_t first_seed = 1;
};

template <OptionsOf<SeedOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("seeds", o.seeds, 1, kMostSeeds);
  v.seed("first_seed", o.first_seed);
}

/// 0.6, where a stream of 17 digits writes 0.59999999999999998.
std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string text_of(const toml::node& node) {
  const auto number = node.value_exact<double>();
  if (number && std::isfinite(*number)) return shortest(*number);
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  std::string line = text.str();
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

/// Reads the keys of one axis that is a range.
class AxisReader {
 public:
  AxisReader(const std::string& source, std::string key) : source_(source), key_(std::move(key)) {}

  TradeAxis read(const toml::node& node) const {
    TradeAxis axis{key_, {}, {}};
    if (const toml::array* levels = node.as_array()) {
      for (const toml::node& level : *levels) axis.levels.push_back(text_of(level));
      check_levels(axis.levels);
    } else if (const toml::table* range = node.as_table()) {
      axis.range = read_range(*range);
      axis.levels = quarters(*axis.range);
    } else {
      refuse("must be a list of values, or { from = A, to = B }");
    }
    return axis;
  }

 private:
  [[noreturn]] void refuse(const std::string& allowed) const {
    refuse_plan(source_, "axes.\"" + key_ + "\"", allowed);
  }

  void check_levels(const std::vector<std::string>& levels) const {
    if (levels.size() < 2 || levels.size() > kMostLevels) {
      refuse("must have 2 to " + std::to_string(kMostLevels) + " values");
    }
    const std::set<std::string> different(levels.begin(), levels.end());
    if (different.size() != levels.size()) refuse("has a value twice");
  }

  double number(const toml::table& range, const std::string& name) const {
    const auto value = range[name].value<double>();
    if (!value || !std::isfinite(*value)) refuse(name + " must be a number");
    return *value;
  }

  TradeAxis::Range read_range(const toml::table& table) const {
    for (const auto& [name, node] : table) {
      if (name != "from" && name != "to" && name != "logarithmic") {
        refuse(std::string(name.str()) + ": unknown; keys of a range are from, to, logarithmic");
      }
    }
    TradeAxis::Range range{number(table, "from"), number(table, "to"), false};
    if (table.contains("logarithmic")) {
      const auto flag = table["logarithmic"].as_boolean();
      if (flag == nullptr) refuse("logarithmic must be true or false");
      range.logarithmic = flag->get();
    }
    if (range.from >= range.to) refuse("from must be less than to");
    if (range.logarithmic && range.from <= 0) refuse("from of a logarithmic range must be above 0");
    return range;
  }

  static std::vector<std::string> quarters(const TradeAxis::Range& range);

  const std::string& source_;
  std::string key_;
};

double value_in(const TradeAxis::Range& range, double share) {
  if (range.logarithmic) return range.from * std::pow(range.to / range.from, share);
  return range.from + (range.to - range.from) * share;
}

std::vector<std::string> AxisReader::quarters(const TradeAxis::Range& range) {
  const auto edge = [&](int i) { return significant(value_in(range, 1.0 * i / kRangeLevels), 3); };
  std::vector<std::string> names;
  for (int i = 0; i < kRangeLevels; ++i) names.push_back(edge(i) + " to " + edge(i + 1));
  return names;
}

std::vector<TradeAxis> read_axes(const toml::table& root, const std::string& source) {
  const toml::table* table = root["axes"].as_table();
  if (table == nullptr || table->empty()) {
    refuse_plan(source, "axes", "must be a table [axes] with \"section.key\" = values");
  }
  std::vector<TradeAxis> axes;
  for (const auto& [name, node] : *table) {
    const std::string key(name.str());
    if (key.find('.') == std::string::npos) {
      refuse_plan(source, "axes." + key, "must be a quoted \"section.key\" of a scene");
    }
    if (key == "simulation.seed") {
      refuse_plan(source, "axes.\"" + key + "\"", "is set by seeds; leave it out");
    }
    axes.push_back(AxisReader(source, key).read(node));
  }
  return axes;
}

void check_design(TradePlan& plan, bool points_given) {
  if (plan.design != TradeDesign::grid) {
    if (!points_given) refuse_plan(plan.source, "points", "must be given for this design");
    return;
  }
  if (points_given) refuse_plan(plan.source, "points", "follows from the axes of a grid");
  double points = 1;
  for (const TradeAxis& axis : plan.axes) {
    if (axis.range) {
      refuse_plan(plan.source, "axes.\"" + axis.key + "\"", "must be a list of values for a grid");
    }
    points *= static_cast<double>(axis.levels.size());
  }
  if (points > kMostTradePoints) {
    refuse_plan(plan.source,
                "axes",
                "a grid of " + significant(points, 3) + " points; at most " +
                    std::to_string(kMostTradePoints) + " are allowed");
  }
  plan.points = static_cast<int>(points);
}

/// [reference] is read as a scene of that name.
NamedOptions read_reference(toml::table& root, const std::filesystem::path& path) {
  const toml::table* reference = root["reference"].as_table();
  if (reference == nullptr) return {"reference", {}, {}};
  toml::table wrapped{{"scenes", toml::table{{"reference", *reference}}}};
  return read_option_tables(wrapped, "scenes", path).front();
}

void refuse_unknown(const toml::table& root,
                    const std::vector<std::string>& known,
                    const std::string& source) {
  for (const auto& [key, node] : root) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    refuse_plan(source, std::string(key.str()), "unknown; keys of a plan are " + names);
  }
}

}  // namespace

TradePlan load_trade_plan(const std::filesystem::path& path) {
  TradePlan plan;
  plan.source = path.string();
  toml::table root = parse_toml_file(path, "a plan");
  const bool points_given = root.contains("points");
  TomlReader reader(plan.source, "plan", root);
  describe(plan, reader);
  SeedOptions seeds;
  describe(seeds, reader);
  plan.seeds = seed_list(seeds.first_seed, seeds.seeds);
  auto known = reader.known_keys();
  known.insert(known.end(), {"reference", "scenes", "unseen", "axes"});
  refuse_unknown(root, known, plan.source);
  plan.reference = read_reference(root, path);
  plan.scenes = read_option_tables(root, "scenes", path);
  if (root.contains("unseen")) plan.unseen = read_option_tables(root, "unseen", path);
  plan.axes = read_axes(root, plan.source);
  check_design(plan, points_given);
  return plan;
}

std::string TradePlan::canonical() const {
  std::ostringstream text;
  text << static_cast<int>(design) << " " << points << " " << design_seed << " " << repeats;
  for (const std::uint64_t seed : seeds) text << " " << seed;
  const auto add = [&](const NamedOptions& options) {
    text << "\n" << options.name << " " << options.file.string();
    for (const std::string& setting : options.settings) text << "\n " << setting;
  };
  add(reference);
  for (const NamedOptions& scene : scenes) add(scene);
  for (const TradeAxis& axis : axes) {
    text << "\n" << axis.key;
    for (const std::string& level : axis.levels) text << "\n " << level;
    if (axis.range) text << "\n " << axis.range->from << " " << axis.range->to;
  }
  return text.str();
}

std::string plain_value(const std::string& value) {
  const bool quoted = value.size() >= 2 && value.front() == value.back() &&
                      (value.front() == '"' || value.front() == '\'');
  return quoted ? value.substr(1, value.size() - 2) : value;
}

std::vector<std::string> settings_of(const TradePlan& plan, const TradePoint& point) {
  std::vector<std::string> settings;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    settings.push_back(plan.axes[i].key + "=" + point.values[i]);
  }
  return settings;
}

}  // namespace wobblebench::bench
