#include "bench/studies/tolerance/tolerance_choice.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/studies/tolerance/tolerance_question.h"
#include "bench/studies/trade/trade_measurement.h"
#include "bench/studies/tune/tune_request.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeast_mm = 0.01, kMost_mm = 100;
constexpr double kAgreement = 0.25;           // of the tolerance
constexpr std::size_t kMostCoarserRungs = 2;  // geometry and field

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
  return upper_quantity(score, kToleranceMeasure) <= tolerance_mm &&
         upper_quantity(score, kWrongMeasure) <= kMostWrongPercent;
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
  /// So many points are on the finest rung, which come first, and so many on each other.
  std::size_t settings() const {
    const bool by_rung = !work_.plan.axes.empty() && work_.plan.axes.back().key == kRungKey;
    if (!by_rung) return work_.points.size();
    return static_cast<std::size_t>(std::ranges::count_if(work_.points, [&](const auto& point) {
      return point.values.back() == work_.points.front().values.back();
    }));
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
    const double value = upper_quantity(setting.score, kToleranceMeasure);
    return std::pair(!std::isfinite(value), value);
  };
  return static_cast<std::size_t>(std::ranges::min_element(settings, {}, bound) - settings.begin());
}

/// Of a measure on one rung less that on the other, both of the same seeds.
MeanInterval difference(const Measured& measured, const TradeScore& a, const TradeScore& b) {
  const std::size_t measure = trade_measure(kToleranceMeasure);
  std::vector<double> of_a, of_b;
  for (std::size_t seed = 0; seed < measured.work().plan.seeds.size(); ++seed) {
    of_a.push_back(measured.records().at({0, a.point, seed}).measures[measure]);
    of_b.push_back(measured.records().at({0, b.point, seed}).measures[measure]);
  }
  return paired_difference(of_a, of_b);
}

class Choosing {
 public:
  Choosing(const ToleranceRequest& request, Measured& measured) : measured_(measured) {
    choice_.request = request;
    choice_.seeds = measured.work().plan.seeds;
  }

  ToleranceChoice run(const ToleranceQuestion& question) {
    choice_.finest_rung = choice_.rung = question.finest_rung();
    choose_setting();
    std::size_t number = choice_.setting().score.point;
    if (choice_.promised) number = choose_rung(question);
    choice_.scene_settings = settings_of(measured_.work().plan, measured_.work().points[number]);
    return std::move(choice_);
  }

 private:
  /// The first that holds: they come from the fastest on.
  void choose_setting() {
    const std::size_t count = measured_.settings();
    for (std::size_t i = 0; i < count && !choice_.promised; ++i) {
      const auto score = measured_.score(i);
      if (!score) continue;
      choice_.promised = holds(*score, most());
      const std::string text = text_of(measured_.work(), measured_.work().points[i]);
      choice_.settings.push_back({text, *score, choice_.promised});
    }
    if (choice_.settings.empty()) {
      throw std::runtime_error("--tolerance: the scene refuses every setting: " +
                               measured_.records().begin()->second.refused);
    }
    choice_.chosen =
        choice_.promised ? choice_.settings.size() - 1 : most_accurate(choice_.settings);
  }

  /// The number of the chosen setting's point on the rung that it chooses.
  std::size_t choose_rung(const ToleranceQuestion& question) {
    const TradeScore& finest = choice_.setting().score;
    std::size_t number = finest.point;
    for (const std::string& name : question.coarser_rungs()) {
      number += measured_.settings();
      const auto score = measured_.score(number);
      if (!score) continue;
      const MeanInterval by = difference(measured_, *score, finest);
      const bool agrees =
          std::abs(by.mean) + by.half <= kAgreement * most() && holds(*score, most());
      choice_.rungs.push_back({name, by, agrees});
      if (!agrees) continue;
      choice_.rung = name;
      return number;
    }
    return finest.point;
  }

  double most() const { return choice_.request.tolerance_mm; }

  Measured& measured_;
  ToleranceChoice choice_;
};

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
  static_cast<void>(ToleranceQuestion(request));
}

ToleranceChoice choose_for_tolerance(const ToleranceRequest& request,
                                     render::GlContext& context,
                                     PhantomCache& cache,
                                     const PartDone& done) {
  const ToleranceQuestion question(request);
  const TradeWork work = question.work();
  const std::string key = key_of(work, request.machine);
  const auto kept = key.empty() ? std::nullopt : cache.text(key);
  Measured measured(work, kept ? trade_records(*kept) : TradeRecords{}, context, cache, done);
  ToleranceChoice choice = Choosing(request, measured).run(question);
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
