#include "bench/studies/tolerance/tolerance_choice.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/studies/trade/trade_study.h"
#include "bench/studies/tune/tune_study.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeast_mm = 0.01, kMost_mm = 100;
constexpr double kAgreement = 0.25;  // of the tolerance
constexpr int kSeeds = 3;
constexpr int kRepeats = 2;
constexpr const char* kRungKey = "simulation.fidelity";
constexpr const char* kRungs[] = {"geometry", "field", "scatterers"};  // by cost
constexpr std::size_t kMostCoarserRungs = std::size(kRungs) - 1;

/// The render settings to choose from: keys of a scene, and for each setting their values as in
/// TOML, the fastest first where they were measured (docs/decisions/0036-tolerance.md). None of
/// them changes what a picture shows or how large it is.
constexpr std::size_t kKeys = 6;
constexpr const char* kLadderKeys[kKeys] = {"render.reconstruction.sticks",
                                            "render.reconstruction.spacing_mm",
                                            "render.scan_conversion.slice_size",
                                            "render.ray_casting.steps",
                                            "render.ray_casting.detector",
                                            "render.ray_casting.incidence_correction_mm"};
constexpr const char* kLadder[][kKeys] = {
    {"\"plain\"", "1", "128", "128", "\"iso\"", "\"auto\""},
    {"\"plain\"", "1", "256", "256", "\"iso\"", "\"auto\""},
    {"\"plain\"", "1", "512", "512", "\"iso\"", "\"auto\""},
    {"\"aligned\"", "4", "256", "256", "\"iso\"", "\"auto\""},
    {"\"aligned\"", "2.5", "256", "256", "\"iso\"", "\"auto\""},
    {"\"aligned\"", "1.5", "384", "256", "\"iso\"", "\"auto\""},
    {"\"aligned\"", "1", "512", "512", "\"iso\"", "\"auto\""},
    {"\"aligned\"", "0.7", "512", "1024", "\"iso\"", "\"auto\""}};

/// What the request alone decides, before anything is measured.
class ToleranceWork {
 public:
  /// Throws UserError.
  explicit ToleranceWork(const ToleranceRequest& request)
      : request_(request), given_(load({}).given), finest_(choose_finest_rung()) {
    if (!given_.contains("render.preset")) return;
    throw UserError("--tolerance: chooses the settings of the renderer; leave render.preset out");
  }

  /// The scene's own rung, or the finest that it allows but for `reference`, which is for small
  /// scenes alone.
  const std::string& finest_rung() const { return finest_; }

  /// Rungs that may be chosen instead, the coarsest first.
  std::vector<std::string> coarser_rungs() const {
    if (given_.contains(kRungKey)) return {};
    return {std::begin(kRungs), std::ranges::find(kRungs, finest_)};
  }

  /// Points: each setting of the ladder on the finest rung, then on each coarser one; without those
  /// that are equal but for keys that the scene names itself.
  TradeWork work() const {
    std::vector<std::string> rungs = coarser_rungs();
    rungs.insert(rungs.begin(), finest_);
    TradeWork work{.plan = plan(), .points = {}, .more = {}};
    for (const std::string& rung : rungs) {
      for (const auto& values : kLadder) {
        TradePoint point;
        for (std::size_t i = 0; i < kKeys; ++i) {
          if (is_free(kLadderKeys[i])) point.values.emplace_back(values[i]);
        }
        if (is_free(kRungKey)) point.values.push_back(rung);
        if (std::ranges::find(work.points, point) == work.points.end()) {
          work.points.push_back(point);
        }
      }
    }
    return work;
  }

 private:
  Scene load(const std::vector<std::string>& more) const {
    std::vector<std::string> settings = request_.settings;
    settings.insert(settings.end(), more.begin(), more.end());
    return load_scene(request_.file, settings);
  }

  std::string choose_finest_rung() const {
    if (given_.contains(kRungKey)) return sim::to_string(load({}).simulation.fidelity);
    for (std::size_t i = std::size(kRungs); i-- > 1;) {
      try {
        load({std::string(kRungKey) + "=" + kRungs[i]});
        return kRungs[i];
      } catch (const UserError&) {  // a coarser one, then
      }
    }
    return kRungs[0];
  }

  /// The scene does not name the key.
  bool is_free(const char* key) const { return !given_.contains(key); }

  TradePlan plan() const {
    TradePlan plan;
    plan.source = "--tolerance";
    plan.of_one_scene = true;
    plan.repeats = kRepeats;
    plan.seeds = seeds_from(load({}).simulation.seed + 1, kSeeds);
    plan.scenes = {{"scene", request_.file, request_.settings}};
    for (const char* key : kLadderKeys) {
      if (is_free(key)) plan.axes.push_back({key, {}, {}});
    }
    if (is_free(kRungKey)) plan.axes.push_back({kRungKey, {}, {}});
    return plan;
  }

  const ToleranceRequest& request_;
  const std::set<std::string> given_;
  const std::string finest_;
};

/// Without the rung, which is chosen apart.
std::string text_of(const TradeWork& work, const TradePoint& point) {
  std::string text;
  for (std::size_t i = 0; i < point.values.size(); ++i) {
    const std::string& key = work.plan.axes[i].key;
    if (key == kRungKey) continue;
    text += (text.empty() ? "" : ", ") + key + " = " + plain_value(point.values[i]);
  }
  return text;
}

bool holds(const TradeScore& score, double tolerance_mm) {
  return upper_quantity(score, kToleranceMeasure).value <= tolerance_mm &&
         upper_quantity(score, kWrongMeasure).value <= kMostWrongPercent;
}

/// Measures what is asked for and not known.
class Measured {
 public:
  Measured(TradeWork work,
           TradeRecords records,
           render::GlContext& context,
           PhantomCache& cache,
           const PartDone& done)
      : work_(std::move(work)),
        records_(std::move(records)),
        measurement_(work_, context, cache, 2 * work_.plan.seeds.size()),
        parts_(work_.plan.seeds.size() * (settings() + kMostCoarserRungs), done) {}

  /// None where the scene refuses the point.
  std::optional<TradeScore> score(std::size_t number) {
    for (std::size_t seed = 0; seed < work_.plan.seeds.size(); ++seed) {
      const TradeUnit unit{0, number, seed};
      if (!records_.contains(unit)) {
        records_.emplace(unit, measurement_.measure(unit));
        ++measured_;
      }
      parts_.finish_one();
    }
    return trade_score(work_, records_, {0}, number);
  }
  /// Number of points per rung; those of the finest rung come first.
  std::size_t settings() const {
    const bool by_rung = !work_.plan.axes.empty() && work_.plan.axes.back().key == kRungKey;
    if (!by_rung) return work_.points.size();
    return static_cast<std::size_t>(std::ranges::count_if(work_.points, [&](const auto& point) {
      return point.values.back() == work_.points.front().values.back();
    }));
  }
  /// Values of kToleranceMeasure, by seed.
  std::vector<double> values(std::size_t number) const {
    std::vector<double> values;
    for (std::size_t seed = 0; seed < work_.plan.seeds.size(); ++seed) {
      const TradeRecord& record = records_.at({0, number, seed});
      values.push_back(record.measures[trade_measure(kToleranceMeasure)]);
    }
    return values;
  }
  const TradeWork& work() const { return work_; }
  const TradeRecords& records() const { return records_; }
  std::size_t measured() const { return measured_; }

 private:
  TradeWork work_;
  TradeRecords records_;
  TradeMeasurement measurement_;
  PartCount parts_;
  std::size_t measured_ = 0;
};

std::size_t most_accurate(const std::vector<ToleranceSetting>& settings) {
  const auto bound = [](const ToleranceSetting& setting) {
    const double value = upper_quantity(setting.score, kToleranceMeasure).value;
    return std::pair(!std::isfinite(value), value);
  };
  return static_cast<std::size_t>(std::ranges::min_element(settings, {}, bound) - settings.begin());
}

/// The first setting that holds, as they come from the fastest on; without one the most accurate.
void choose_setting(Measured& measured, ToleranceChoice& choice) {
  const std::size_t count = measured.settings();
  for (std::size_t i = 0; i < count && !choice.promised; ++i) {
    const auto score = measured.score(i);
    if (!score) continue;
    choice.promised = holds(*score, choice.request.tolerance_mm);
    const std::string text = text_of(measured.work(), measured.work().points[i]);
    choice.settings.push_back({text, *score, choice.promised});
  }
  if (choice.settings.empty()) {
    throw std::runtime_error("--tolerance: the scene refuses every setting: " +
                             measured.records().begin()->second.refused);
  }
  choice.chosen = choice.promised ? choice.settings.size() - 1 : most_accurate(choice.settings);
}

/// The number of the chosen setting's point on the coarsest rung that agrees with the finest.
std::size_t choose_rung(const std::vector<std::string>& coarser_rungs,
                        Measured& measured,
                        ToleranceChoice& choice) {
  const double most_mm = choice.request.tolerance_mm;
  const std::size_t finest = choice.setting().score.point;
  std::size_t number = finest;
  for (const std::string& name : coarser_rungs) {
    number += measured.settings();
    const auto score = measured.score(number);
    if (!score) continue;
    const MeanInterval by = paired_difference(measured.values(number), measured.values(finest));
    const bool agrees =
        std::abs(by.mean) + by.half <= kAgreement * most_mm && holds(*score, most_mm);
    choice.rungs.push_back({name, by, agrees});
    if (!agrees) continue;
    choice.rung = name;
    return number;
  }
  return finest;
}

/// All that the records follow from: times are those of one machine. Empty: the phantom cannot be
/// kept, nor what was measured of it.
std::string key_of(const TradeWork& work, const std::string& machine) {
  const std::string phantom = phantom_key(work.reference(0).phantom);
  if (phantom.empty()) return {};
  std::string key = "tolerance\n" + machine + "\n" + phantom + "\n" + work.hash();
  for (const TradePoint& point : work.points) key.append(1, '\n').append(text_of(work, point));
  return key;
}

}  // namespace

double parse_tolerance_mm(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  const bool read = error == std::errc() && std::string_view(stop, end) == "mm";
  if (!read || !(value >= kLeast_mm && value <= kMost_mm)) {
    throw UserError("--tolerance = " + text + ": must be 0.01mm to 100mm, as 0.5mm");
  }
  return value;
}

void check_request(const ToleranceRequest& request) {
  static_cast<void>(ToleranceWork(request));
}

ToleranceChoice choose_for_tolerance(const ToleranceRequest& request,
                                     render::GlContext& context,
                                     PhantomCache& cache,
                                     const PartDone& done) {
  const ToleranceWork asked(request);
  const TradeWork work = asked.work();
  const std::string key = key_of(work, request.machine);
  const auto kept = key.empty() ? std::nullopt : cache.text(key);
  Measured measured(work, kept ? trade_records(*kept) : TradeRecords{}, context, cache, done);
  ToleranceChoice choice;
  choice.request = request;
  choice.seeds = work.plan.seeds;
  choice.finest_rung = choice.rung = asked.finest_rung();
  choose_setting(measured, choice);
  const std::size_t number = choice.promised ? choose_rung(asked.coarser_rungs(), measured, choice)
                                             : choice.setting().score.point;
  choice.scene_settings = settings_of(work.plan, work.points[number]);
  choice.kept = measured.measured() == 0;
  if (!choice.kept && !key.empty()) cache.keep_text(key, text_of(measured.records()));
  return choice;
}

ToleranceOutcome tolerance_outcome(const ToleranceChoice& choice, const PictureMeasures& measures) {
  const auto values = trade_measures(measures);
  ToleranceOutcome outcome;
  outcome.reached_mm = values[trade_measure(kToleranceMeasure)];
  outcome.wrong_percent = values[trade_measure(kWrongMeasure)];
  outcome.held = outcome.reached_mm <= choice.request.tolerance_mm &&
                 outcome.wrong_percent <= kMostWrongPercent;
  return outcome;
}

}  // namespace wobblebench::bench
