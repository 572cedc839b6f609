#include "bench/studies/trade/trade_plan.h"

#include <algorithm>
#include <array>
#include <boost/random/sobol.hpp>
#include <charconv>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>

#include "base/hash.h"
#include "base/number_text.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/scene/toml_file.h"
#include "bench/studies/dataset/drawn_scenes.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostLevels = 64;
constexpr int kRangeLevels = 4;
constexpr int kDigits = 4;  // of a value in a range

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

/// The value at a share of a range from 0 to 1.
double value_in(const TradeAxis::Range& range, double share) {
  if (range.logarithmic) return range.from * std::pow(range.to / range.from, share);
  return range.from + (range.to - range.from) * share;
}

std::vector<std::string> quarters(const TradeAxis::Range& range) {
  const auto edge = [&](int i) { return significant(value_in(range, 1.0 * i / kRangeLevels), 3); };
  std::vector<std::string> names;
  for (int i = 0; i < kRangeLevels; ++i) names.push_back(edge(i) + " to " + edge(i + 1));
  return names;
}

/// Reads one axis.
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

  const std::string& source_;
  std::string key_;
};

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

/// Of one half to measure on, of the other to judge on.
void draw_scenes(const DrawnOptions& options, const std::filesystem::path& path, TradePlan& plan) {
  const bool trains = options.half == PopulationHalf::train;
  for (NamedDrawnScene& drawn : drawn_scenes(options, options.half, path)) {
    plan.scenes.push_back(std::move(drawn.scene));
    plan.strata.push_back(std::move(drawn.stratum));
  }
  const auto other = trains ? PopulationHalf::judge : PopulationHalf::train;
  for (NamedDrawnScene& drawn : drawn_scenes(options, other, path)) {
    plan.unseen.push_back(std::move(drawn.scene));
    plan.unseen_strata.push_back(std::move(drawn.stratum));
  }
}

/// `share` in [0, 1) of the axis: the level that lies there, or the value of a range.
void add_value(const TradeAxis& axis, double share, TradePoint& point) {
  const auto count = static_cast<double>(axis.levels.size());
  const auto level = static_cast<std::size_t>(std::clamp(share * count, 0.0, count - 1));
  point.levels.push_back(static_cast<int>(level));
  if (!axis.range) {
    point.values.push_back(axis.levels[level]);
    return;
  }
  point.values.push_back(significant(value_in(*axis.range, share), kDigits));
}

/// The last axis runs fastest.
std::vector<TradePoint> grid(const TradePlan& plan) {
  std::vector<TradePoint> points(static_cast<std::size_t>(plan.points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t block = points.size();
    for (const TradeAxis& axis : plan.axes) {
      block /= axis.levels.size();
      const std::size_t level = i / block % axis.levels.size();
      points[i].values.push_back(axis.levels[level]);
      points[i].levels.push_back(static_cast<int>(level));
    }
  }
  return points;
}

std::vector<TradePoint> latin_hypercube(const TradePlan& plan) {
  std::mt19937_64 random(plan.design_seed);
  std::vector<TradePoint> points(static_cast<std::size_t>(plan.points));
  std::vector<std::size_t> order(points.size());
  for (const TradeAxis& axis : plan.axes) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Not std::shuffle(): the same order with every standard library.
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double share = (static_cast<double>(order[i]) + 0.5) / static_cast<double>(plan.points);
      add_value(axis, share, points[i]);
    }
  }
  return points;
}

/// Shifted by a random vector, modulo 1, so that seeds differ.
std::vector<TradePoint> sobol(const TradePlan& plan) {
  boost::random::sobol sequence(plan.axes.size());
  std::mt19937_64 random(plan.design_seed);
  std::vector<double> shifts(plan.axes.size());
  std::generate(shifts.begin(), shifts.end(), [&] { return unit_interval(random()); });
  std::vector<TradePoint> points(static_cast<std::size_t>(plan.points));
  for (TradePoint& point : points) {
    for (std::size_t i = 0; i < plan.axes.size(); ++i) {
      const double share = unit_interval(sequence()) + shifts[i];
      add_value(plan.axes[i], share - std::floor(share), point);
    }
  }
  return points;
}

double share_of(const TradeAxis& axis, const std::string& value, int level) {
  if (!axis.range) return (level + 0.5) / static_cast<double>(axis.levels.size());
  const TradeAxis::Range& range = *axis.range;
  const double number = std::stod(value);
  const double share = range.logarithmic
                           ? std::log(number / range.from) / std::log(range.to / range.from)
                           : (number - range.from) / (range.to - range.from);
  return std::clamp(share, 0.0, 1.0);
}

}  // namespace

bool TradeAxis::is_of_files() const {
  return key == "phantom.file" || key == "phantom.scatterers";
}

TradePlan load_trade_plan(const std::filesystem::path& path) {
  TradePlan plan;
  plan.source = path.string();
  toml::table root = parse_toml_file(path, "a plan");
  const bool points_given = root.contains("points");
  TomlReader reader(plan.source, "plan", root);
  describe(plan, reader);
  SeedOptions seeds;
  describe(seeds, reader);
  plan.seeds = seeds_from(seeds.first_seed, seeds.seeds);
  DrawnOptions drawn{.half = PopulationHalf::train};
  describe(drawn, reader);
  auto known = reader.known_keys();
  known.insert(known.end(), {"reference", "scenes", "unseen", "axes"});
  std::vector<std::string> given;
  for (const auto& [key, node] : root) given.emplace_back(key.str());
  refuse_unknown_keys(given, known, plan.source);
  // The reader has taken its own keys, "plan.half", out of `root`.
  for (const std::string& key : reader.given_keys()) given.push_back(key.substr(key.find('.') + 1));
  check_drawn_keys(drawn, given, {"scenes", "unseen"}, plan.source);
  plan.reference = load_option_table(path, "reference");
  if (drawn.given()) {
    draw_scenes(drawn, path, plan);
  } else {
    plan.scenes = load_option_tables(path, "scenes");
    if (root.contains("unseen")) plan.unseen = load_option_tables(path, "unseen");
  }
  plan.axes = read_axes(root, plan.source);
  check_design(plan, points_given);
  return plan;
}

std::string TradePlan::canonical() const {
  std::ostringstream text;
  text << static_cast<int>(design) << " " << points << " " << design_seed << " " << repeats;
  for (const std::uint64_t seed : seeds) text << " " << seed;
  for (const NamedOptions& scene : scenes) text << "\n" << scene.name;
  for (const TradeAxis& axis : axes) {
    text << "\n" << axis.key << " " << axis.levels.size();
    for (const std::string& level : axis.levels) text << "\n " << (axis.is_of_files() ? "" : level);
    if (!axis.range) continue;
    text << "\n " << shortest(axis.range->from) << " " << shortest(axis.range->to) << " "
         << axis.range->logarithmic;
  }
  return text.str();
}

std::vector<std::size_t> all_scenes(const TradePlan& plan) {
  std::vector<std::size_t> scenes(plan.scenes.size());
  std::iota(scenes.begin(), scenes.end(), std::size_t{0});
  return scenes;
}

std::vector<std::string> settings_of(const TradePlan& plan, const TradePoint& point) {
  std::vector<std::string> settings;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    settings.push_back(plan.axes[i].key + "=" + point.values[i]);
  }
  return settings;
}

TradePoint point_at(const TradePlan& plan, const std::vector<double>& shares) {
  if (shares.size() != plan.axes.size()) throw std::invalid_argument("point_at: a share an axis");
  TradePoint point;
  for (std::size_t i = 0; i < shares.size(); ++i) add_value(plan.axes[i], shares[i], point);
  return point;
}

std::vector<double> shares_of(const TradePlan& plan, const TradePoint& point) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    shares.push_back(share_of(plan.axes[i], point.values[i], point.levels[i]));
  }
  return shares;
}

std::vector<TradePoint> design_points(const TradePlan& plan) {
  switch (plan.design) {
    case TradeDesign::grid:
      return grid(plan);
    case TradeDesign::latin_hypercube:
      return latin_hypercube(plan);
    case TradeDesign::sobol:
      break;
  }
  return sobol(plan);
}

}  // namespace wobblebench::bench
