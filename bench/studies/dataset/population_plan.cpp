#include "bench/studies/dataset/population_plan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/cache/sha256.h"
#include "bench/cache/watched_files.h"
#include "bench/exchange/export/writers.h"
#include "bench/scene/idle_options.h"
#include "bench/scene/toml_file.h"
#include "bench/studies/plans/option_tables.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// Scenes of a stratum of which one must be possible.
constexpr int kTriedScenes = 16;
constexpr double kShareError = 1e-6;

struct PlanOptions {
  int scenes = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> exports = {"polar.npz,content=polar"};
  bool pages = false;
};

template <OptionsOf<PlanOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("scenes", o.scenes, 1, kMostScenes);
  v.seed("seed", o.seed);
  v.texts("exports", o.exports);
  v.flag("pages", o.pages);
}

struct KeyValue {
  std::string key, value;
};

KeyValue split(const std::string& setting) {
  const auto equals = setting.find('=');
  return {setting.substr(0, equals), setting.substr(equals + 1)};
}

/// A table [scene] or [strata.NAME] as it is read.
struct OptionTable {
  std::string name;  ///< of the table
  std::map<std::string, std::vector<DistributionWord>> words;
  std::map<std::string, std::string> own;  ///< keys without a section
};

/// Adds "phantom.hand.choice=[…]" to the words of phantom.hand, and "phantom.hand=…" as its value.
void add_setting(const std::string& setting, OptionTable& table) {
  const auto [key, value] = split(setting);
  const auto dot = key.rfind('.');
  if (dot == std::string::npos) {
    table.own[key] = value;
  } else if (is_distribution_word(key.substr(dot + 1))) {
    table.words[key.substr(0, dot)].push_back({key.substr(dot + 1), value});
  } else {
    table.words[key].push_back({"", value});
  }
}

OptionTable option_table(const std::string& name, const NamedOptions& options) {
  OptionTable table{.name = name, .words = {}, .own = {}};
  for (const std::string& setting : options.settings) add_setting(setting, table);
  return table;
}

/// The file of a phantom is found from any folder.
std::string with_whole_path(const std::string& key, const std::string& value) {
  if (key != "phantom.file" && key != "phantom.scatterers") return value;
  const std::string plain = plain_value(value);
  return plain.empty() ? value : "\"" + fs::absolute(plain).string() + "\"";
}

/// Reads tables of options.
class TableReader {
 public:
  explicit TableReader(std::string source) : source_(std::move(source)) {}

  void read(const OptionTable& table, std::map<std::string, Distribution>& options) const {
    for (const auto& [key, words] : table.words) {
      options[key] = distribution(table.name + "." + key, key, words);
    }
  }

  void refuse_own(const OptionTable& table, const std::set<std::string>& allowed) const {
    for (const auto& [key, value] : table.own) {
      if (allowed.contains(key)) continue;
      const std::string own = allowed.empty() ? "" : "share, count or ";
      refuse_plan(
          source_, table.name + "." + key, "unknown; must be " + own + "section.key of a scene");
    }
  }

  /// A number of a key without a section; nullopt: it is not there.
  std::optional<double> number(const OptionTable& table, const std::string& key) const {
    const auto found = table.own.find(key);
    if (found == table.own.end()) return std::nullopt;
    const std::string& text = found->second;
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && stop == text.data() + text.size() && std::isfinite(value)) {
      return value;
    }
    refuse_plan(source_, table.name + "." + key + " = " + text, "must be a number");
  }

 private:
  Distribution distribution(const std::string& name,
                            const std::string& key,
                            const std::vector<DistributionWord>& words) const {
    if (words.size() == 1 && words.front().word.empty()) {
      return {.values = {with_whole_path(key, words.front().value)}, .shares = {}};
    }
    try {
      return read_distribution(words);
    } catch (const std::invalid_argument& error) {
      refuse_plan(source_, name, error.what());
    }
  }

  std::string source_;
};

/// How many scenes each stratum has.
class StratumSizes {
 public:
  StratumSizes(const TableReader& reader, std::string source, std::vector<OptionTable> tables)
      : source_(std::move(source)), tables_(std::move(tables)) {
    for (const OptionTable& table : tables_) {
      counts_.push_back(reader.number(table, "count"));
      shares_.push_back(reader.number(table, "share"));
    }
  }

  /// `scenes`: 0: not given.
  std::vector<int> sizes(int scenes) const {
    const bool by_count = counts_.front().has_value();
    for (std::size_t i = 0; i < tables_.size(); ++i) check_kind(i, by_count);
    return by_count ? by_counts(scenes) : by_shares(scenes);
  }

 private:
  [[noreturn]] void refuse(const std::string& key, const std::string& allowed) const {
    refuse_plan(source_, key, allowed);
  }

  void check_kind(std::size_t i, bool by_count) const {
    if (counts_[i].has_value() == by_count && shares_[i].has_value() != by_count) return;
    refuse(tables_[i].name, "each stratum must have a share, or each a count");
  }

  std::vector<int> by_counts(int scenes) const {
    std::vector<int> sizes;
    double sum = 0;
    for (std::size_t i = 0; i < tables_.size(); ++i) {
      const double count = counts_[i].value();
      if (count < 1 || count > kMostScenes || count != std::floor(count)) {
        refuse(tables_[i].name + ".count = " + significant(count, 9),
               "must be a whole number, 1 to " + std::to_string(kMostScenes));
      }
      sizes.push_back(static_cast<int>(count));
      sum += count;
    }
    if (sum > kMostScenes || (scenes != 0 && scenes != sum)) {
      refuse("scenes",
             "the counts of the strata add up to " + significant(sum, 9) + "; must be " +
                 (scenes != 0 ? std::to_string(scenes) : "at most " + std::to_string(kMostScenes)));
    }
    return sizes;
  }

  std::vector<int> by_shares(int scenes) const {
    std::vector<double> shares;
    for (std::size_t i = 0; i < tables_.size(); ++i) {
      shares.push_back(shares_[i].value());
      if (shares.back() > 0) continue;
      refuse(tables_[i].name + ".share = " + significant(shares.back(), 9), "must be above 0");
    }
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    if (std::abs(sum - 1) > kShareError) {
      refuse("strata", "the shares add up to " + significant(sum, 9) + "; must be 1");
    }
    if (scenes == 0) refuse("scenes", "must be given where strata have shares");
    std::vector<int> sizes = counts_of_shares(shares, scenes);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if (sizes[i] > 0) continue;
      refuse(tables_[i].name + ".share = " + significant(shares[i], 9),
             "is no scene of " + std::to_string(scenes) + "; must be larger, or more scenes");
    }
    return sizes;
  }

  std::string source_;
  std::vector<OptionTable> tables_;
  std::vector<std::optional<double>> counts_, shares_;
};

void add_drawn_seed(std::map<std::string, Distribution>& options) {
  constexpr double kMostSeed = 2147483647;
  options.try_emplace("simulation.seed",
                      Distribution{.kind = Distribution::Kind::integers,
                                   .low = 1,
                                   .high = kMostSeed,
                                   .values = {},
                                   .shares = {}});
}

void read_strata(const fs::path& path, const toml::table& root, PopulationPlan& plan) {
  const TableReader reader(plan.source);
  const NamedOptions base = load_option_table(path, "scene");
  plan.file = base.file;
  const OptionTable common = option_table("scene", base);
  reader.refuse_own(common, {});
  std::map<std::string, Distribution> options;
  add_drawn_seed(options);
  reader.read(common, options);
  if (!root.contains("strata")) {
    if (plan.scenes == 0) refuse_plan(plan.source, "scenes", "must be given");
    plan.strata = {{"all", plan.scenes, options}};
    return;
  }
  std::vector<OptionTable> tables;
  for (const NamedOptions& stratum : load_option_tables(path, "strata")) {
    tables.push_back(option_table("strata." + stratum.name, stratum));
    reader.refuse_own(tables.back(), {"share", "count"});
    plan.strata.push_back({stratum.name, 0, options});
    reader.read(tables.back(), plan.strata.back().options);
  }
  const auto sizes = StratumSizes(reader, plan.source, tables).sizes(plan.scenes);
  for (std::size_t i = 0; i < sizes.size(); ++i) plan.strata[i].scenes = sizes[i];
  plan.scenes = std::accumulate(sizes.begin(), sizes.end(), 0);
}

std::string stratum_source(const PopulationPlan& plan, std::size_t stratum) {
  return plan.source + " (stratum " + plan.strata[stratum].name + ")";
}

/// What a scene of a data set must be, beside possible.
void check_scene(const PopulationPlan& plan, const DrawnScene& drawn) {
  const Scene scene = plan.scene(drawn);
  const std::string source = stratum_source(plan, drawn.stratum);
  if (scene.acquisition.volumes != 1) {
    refuse_plan(source, "acquisition.volumes", "must be 1; this command renders one volume");
  }
  if (!scene.picture.program.empty()) {
    refuse_plan(source, "render.program", "must be empty; this command takes no other renderer");
  }
}

/// The first scenes of a stratum, in order.
std::vector<DrawnScene> first_scenes(const PopulationPlan& plan, std::size_t stratum) {
  std::vector<DrawnScene> drawn;
  for (int i = 0; i < plan.scenes && drawn.size() < kTriedScenes; ++i) {
    if (plan.stratum_of[static_cast<std::size_t>(i)] == stratum) drawn.push_back(plan.draw(i));
  }
  return drawn;
}

/// The first scene of a stratum that is not refused. Throws UserError with the first refusal where
/// all are.
DrawnScene possible_scene(const PopulationPlan& plan, std::size_t stratum) {
  std::string refusal;
  const std::vector<DrawnScene> drawn = first_scenes(plan, stratum);
  for (const DrawnScene& scene : drawn) {
    try {
      check_scene(plan, scene);
      return scene;
    } catch (const UserError& error) {
      if (refusal.empty()) refusal = error.what();
    }
  }
  if (refusal.find("= {...}") != std::string::npos) {
    refusal +=
        ", or a distribution: { uniform = … }, { normal = …, within = … }, { integers = … } or "
        "{ choice = … }";
  }
  throw UserError(refusal);
}

DrawnScene with_value(DrawnScene scene, const std::string& key, const std::string& value) {
  for (std::string& setting : scene.settings) {
    if (split(setting).key == key) setting = key + "=" + value;
  }
  return scene;
}

/// Each stratum has a possible scene, and it stays possible at the ends of each distribution.
void check_strata(const PopulationPlan& plan) {
  for (std::size_t i = 0; i < plan.strata.size(); ++i) {
    const DrawnScene possible = possible_scene(plan, i);
    for (const auto& [key, distribution] : plan.strata[i].options) {
      if (!distribution.is_drawn()) continue;
      for (const std::string& value : distribution.extremes()) {
        check_scene(plan, with_value(possible, key, value));
      }
    }
  }
}

void check_exports(const PopulationPlan& plan) {
  std::set<std::string> names;
  for (const std::string& to : plan.exports) {
    const std::string name = to.substr(0, to.find(','));
    const bool is_name = !name.empty() && fs::path(name).filename() == name && name.front() != '.';
    if (!is_name || !names.insert(name).second) {
      refuse_plan(
          plan.source,
          "exports = " + to,
          "must be names of different files, as `export --to` takes them, without a folder");
    }
    try {
      static_cast<void>(export_format(name));
    } catch (const UserError& error) {
      refuse_plan(plan.source, "exports", error.what());
    }
  }
}

void add_file(const fs::path& file, Sha256& hash) {
  hash.add(file.empty() ? std::string(" none") : " " + sha256_of_file(file));
}

}  // namespace

std::string DrawnScene::value(const std::string& key) const {
  for (const std::string& setting : settings) {
    if (split(setting).key == key) return split(setting).value;
  }
  return "";
}

DrawnScene PopulationPlan::draw(int index) const {
  DrawnScene drawn{
      .index = index, .stratum = stratum_of.at(static_cast<std::size_t>(index)), .settings = {}};
  for (const auto& [key, distribution] : strata[drawn.stratum].options) {
    const double unit = unit_draw(seed, static_cast<std::uint64_t>(index), key);
    drawn.settings.push_back(key + "=" + distribution.at(unit));
  }
  return drawn;
}

Scene PopulationPlan::scene(const DrawnScene& drawn) const {
  return load_scene(file, drawn.settings, source + " (stratum " + strata[drawn.stratum].name + ")");
}

std::string PopulationPlan::hash() const {
  Sha256 hash;
  add_file(source, hash);
  add_file(file, hash);
  for (std::size_t i = 0; i < strata.size(); ++i) {
    for (const fs::path& of : phantom_files(scene(possible_scene(*this, i)))) add_file(of, hash);
  }
  return hex(hash.digest());
}

PopulationPlan load_population_plan(const fs::path& path) {
  PopulationPlan plan;
  plan.source = path.string();
  toml::table root = parse_toml_file(path, "a plan");
  PlanOptions options;
  TomlReader reader(plan.source, "plan", root);
  describe(options, reader);
  std::vector<std::string> given, known = reader.known_keys();
  known.insert(known.end(), {"scene", "strata"});
  for (const auto& [key, node] : root) given.emplace_back(key.str());
  refuse_unknown_keys(given, known, plan.source);
  plan.scenes = options.scenes;
  plan.seed = options.seed;
  plan.exports = options.exports;
  plan.pages = options.pages;
  check_exports(plan);
  read_strata(path, root, plan);
  std::vector<int> sizes;
  for (const Stratum& stratum : plan.strata) sizes.push_back(stratum.scenes);
  plan.stratum_of = spread_strata(sizes);
  check_strata(plan);
  return plan;
}

std::vector<DrawnScene> scenes_of_half(const PopulationPlan& plan,
                                       PopulationHalf half,
                                       int per_stratum) {
  std::vector<DrawnScene> scenes;
  std::vector<int> before(plan.strata.size(), 0), taken(plan.strata.size(), 0);
  std::map<std::string, bool> half_of;  // each seed and identity, and whether it trains
  for (int i = 0; i < plan.scenes; ++i) {
    DrawnScene drawn = plan.draw(i);
    const bool trains = before[drawn.stratum]++ % 2 == 0;
    for (const char* key : {"simulation.seed", "phantom.identity"}) {
      const std::string value = drawn.value(key);
      if (value.empty() || value == "0") continue;
      const auto [known, is_new] = half_of.emplace(std::string(key) + " = " + value, trains);
      if (is_new || known->second == trains) continue;
      refuse_plan(plan.source,
                  known->first,
                  "is in both halves of the population; must be drawn from more values");
    }
    if (trains != (half == PopulationHalf::train) || taken[drawn.stratum] == per_stratum) continue;
    ++taken[drawn.stratum];
    scenes.push_back(std::move(drawn));
  }
  return scenes;
}

std::string idle_options_of(const PopulationPlan& plan) {
  IdleInAll idle;
  for (std::size_t i = 0; i < plan.strata.size(); ++i) {
    for (const DrawnScene& drawn : first_scenes(plan, i)) {
      try {
        const Scene scene = plan.scene(drawn);
        idle.add(scene, scene.given);
      } catch (const UserError&) {
        continue;  // it will be noted as refused
      }
    }
  }
  return idle_options_text(idle.options());
}

std::vector<std::size_t> spread_strata(const std::vector<int>& counts) {
  const int scenes = std::accumulate(counts.begin(), counts.end(), 0);
  std::vector<std::size_t> of;
  std::vector<int> made(counts.size(), 0);
  for (int i = 0; i < scenes; ++i) {
    // The stratum that is most behind its share of the scenes up to this one.
    const auto behind = [&](std::size_t stratum) {
      const double share = static_cast<double>(counts[stratum]) / scenes;
      return made[stratum] < counts[stratum] ? share * (i + 1) - made[stratum] : -1e300;
    };
    std::size_t most = 0;
    for (std::size_t j = 1; j < counts.size(); ++j) {
      if (behind(j) > behind(most)) most = j;
    }
    ++made[most];
    of.push_back(most);
  }
  return of;
}

std::vector<int> counts_of_shares(const std::vector<double>& shares, int scenes) {
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  std::vector<int> counts;
  std::vector<std::pair<double, std::size_t>> rests;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double exact = shares[i] / sum * scenes;
    counts.push_back(static_cast<int>(std::floor(exact + 1e-9)));
    rests.emplace_back(-(exact - counts.back()), i);
  }
  std::ranges::sort(rests);
  int left = scenes - std::accumulate(counts.begin(), counts.end(), 0);
  for (std::size_t i = 0; left > 0; ++i, --left) ++counts[rests[i % rests.size()].second];
  return counts;
}

}  // namespace wobblebench::bench
