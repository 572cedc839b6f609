#include "bench/studies/tune/tune_study.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/near_name.h"
#include "base/user_error.h"
#include "bench/evaluation/seed_statistics.h"

namespace wobblebench::bench {

namespace {

constexpr double kNotFormed = 1e6;
constexpr double kNearEnd = 0.03;
constexpr std::size_t kMostScans = 12;  // kept at a time: some 100 MB each at the default scan

/// The time of that name; none: it names a measure.
std::optional<double> time_of(const TradeFigures& of, const std::string& name) {
  for (const auto& [known, time] : kTradeTimes) {
    if (name == known->key) return of.*time;
  }
  return std::nullopt;
}

Reached reached_by(const TradeScore& score, const std::string& name, bool bound) {
  if (is_mean(name)) return {figure_of(score, name.substr(kMeanOf.size()), bound)};
  Reached worst{-1};
  for (const TradeScore::OnScene& one : score.scenes) {
    const double value = figure_of(one, name, bound);
    if (std::isnan(value)) return {value, one.scene};
    if (value > worst.value) worst = {value, one.scene};
  }
  return worst;
}

std::vector<LimitValue> limit_values(const TuneRequest& request,
                                     const TradeScore& score,
                                     bool bound) {
  std::vector<LimitValue> values;
  for (const TuneLimit& limit : request.limits) {
    values.push_back({limit, reached_by(score, limit.name, bound)});
  }
  return values;
}

/// Sum of the parts above each limit.
double excess_of(const std::vector<LimitValue>& values) {
  double sum = 0;
  for (const auto& [limit, reached] : values) {
    sum +=
        std::isfinite(reached.value) ? std::max(0.0, reached.value / limit.most - 1) : kNotFormed;
  }
  return sum;
}

/// Scores points of one work, measuring what is not known.
class Scorer {
 public:
  Scorer(const TradeWork& work,
         TradeRecords known,
         KeptSearch kept,
         render::GlContext& context,
         PhantomCache& cache)
      : work_(work),
        records_(std::move(known)),
        kept_(std::move(kept)),
        measurement_(work, context, cache, scans(work)) {}

  /// On all scenes; none where one refuses the point.
  std::optional<TradeScore> score(std::size_t point) {
    return score(point, all_scenes(work_.plan));
  }

  std::optional<TradeScore> score(std::size_t point, const std::vector<std::size_t>& scenes) {
    for (const std::size_t scene : scenes) {
      for (std::size_t seed = 0; seed < work_.plan.seeds.size(); ++seed) {
        const TradeUnit unit{scene, point, seed};
        if (records_.contains(unit)) continue;
        const TradeRecord& record = records_.emplace(unit, measure(unit)).first->second;
        if (!record.refused.empty()) return std::nullopt;
      }
    }
    return trade_score(work_, records_, scenes, point);
  }

 private:
  static std::size_t scans(const TradeWork& work) {
    return std::min(kMostScans, work.plan.scenes.size() * work.plan.seeds.size());
  }

  TradeRecord measure(const TradeUnit& unit) {
    if (kept_.journal == nullptr) return measurement_.measure(unit);
    const TuneKey key = {kept_.part,
                         work_.plan.scenes[unit.scene].name,
                         work_.points[unit.point].values,
                         work_.plan.seeds[unit.seed]};
    if (const TradeRecord* const found = kept_.journal->find(key)) {
      TradeRecord record = *found;
      record.unit = unit;
      return record;
    }
    TradeRecord record = measurement_.measure(unit);
    kept_.journal->append(key, record);
    return record;
  }

  const TradeWork& work_;
  TradeRecords records_;
  const KeptSearch kept_;
  TradeMeasurement measurement_;
};

class Tuning {
 public:
  Tuning(TradeWork work,
         const TuneOptions& options,
         TradeRecords known,
         KeptSearch kept,
         render::GlContext& context,
         PhantomCache& cache,
         const PartDone& done)
      : kept_(std::move(kept)), context_(context), cache_(cache), done_(done) {
    results_.work = std::move(work);
    results_.options = options;
    results_.known = results_.work.points.size();
    for (const TradeAxis& axis : plan().axes) {
      axes_.push_back({axis.range ? 0 : static_cast<int>(axis.levels.size())});
    }
    score_known(std::move(known));
  }

  TuneResults run() {
    find();
    confirm();
    find_nearest();
    judge();
    return std::move(results_);
  }

 private:
  const TradePlan& plan() const { return results_.work.plan; }
  const TuneRequest& request() const { return results_.options.request; }

  void score_known(TradeRecords known) {
    const auto scenes = all_scenes(plan());
    for (std::size_t point = 0; point < results_.known; ++point) {
      numbers_.emplace(results_.work.points[point].values, point);
      const auto score = trade_score(results_.work, known, scenes, point);
      if (score) scores_.emplace(point, *score);
    }
    scorer_.emplace(results_.work, std::move(known), kept_, context_, cache_);
  }

  SearchPoint search_point(const TradePoint& point) const {
    SearchPoint result;
    const std::vector<double> shares = shares_of(plan(), point);
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      result.push_back(axes_[i].levels == 0 ? shares[i] : point.levels[i]);
    }
    return result;
  }

  TradePoint trade_point(const SearchPoint& point) const {
    std::vector<double> shares;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      shares.push_back(axes_[i].levels == 0 ? point[i] : (point[i] + 0.5) / axes_[i].levels);
    }
    return point_at(plan(), shares);
  }

  SearchValue value_of(const TradeScore& score) const {
    return {quantity_of(score, mean_of(request().least)).value, excess_of(request(), score)};
  }

  SearchValue measure(const SearchPoint& at) {
    const TradePoint point = trade_point(at);
    const auto [number, is_new] = numbers_.emplace(point.values, results_.work.points.size());
    if (is_new) {
      results_.work.points.push_back(point);
      ++results_.evaluated;
      if (const auto score = scorer_->score(number->second)) {
        scores_.emplace(number->second, *score);
      } else {
        ++results_.refused;
      }
      if (done_) done_(std::min<std::size_t>(results_.evaluated, evaluations()), evaluations());
    }
    const auto found = scores_.find(number->second);
    return found == scores_.end() ? SearchValue{1e9, 1e9} : value_of(found->second);
  }

  std::size_t evaluations() const {
    return static_cast<std::size_t>(results_.options.search.evaluations);
  }

  /// Points in the order of the request: those within its limits first, by the quantity to be
  /// small.
  std::vector<std::size_t> best_first() const {
    std::vector<std::size_t> points;
    for (const auto& [point, score] : scores_) points.push_back(point);
    std::ranges::stable_sort(points, {}, [&](std::size_t point) {
      const SearchValue value = value_of(scores_.at(point));
      return std::pair(value.excess, value.goal);
    });
    return points;
  }

  std::vector<SearchPoint> starts() const {
    std::vector<TradePoint> points;
    for (const std::size_t point : best_first()) points.push_back(results_.work.points[point]);
    if (results_.known == 0) points = design_points(plan());
    std::vector<SearchPoint> starts;
    for (const TradePoint& point : points) starts.push_back(search_point(point));
    return starts;
  }

  void find() {
    SearchOptions options = results_.options.search;
    // What is known costs nothing.
    if (options.method == SearchMethod::nsga2) {
      options.evaluations += static_cast<int>(std::min(results_.known, kSearchPopulation));
    }
    if (evaluations() == 0) return;
    search(axes_, starts(), options, [this](const SearchPoint& at) { return measure(at); });
  }

  /// The best ones on fresh seeds, one after the other until one holds.
  void confirm() {
    results_.fresh_seeds = seeds_from(plan().seeds.back() + 1, results_.options.fresh_seeds);
    const TradeWork fresh = work_on(plan().scenes, results_.fresh_seeds);
    Scorer scorer(fresh, {}, kept_, context_, cache_);
    for (const std::size_t point : best_first()) {
      const TradeScore& searched = scores_.at(point);
      if (excess_of(request(), searched) > 0) break;
      results_.candidates.push_back({point, searched, scorer.score(point), false});
      TuneCandidate& candidate = results_.candidates.back();
      candidate.holds = candidate.fresh && all_hold(*candidate.fresh);
      if (candidate.holds || results_.candidates.size() == kMostCandidates) break;
    }
  }

  /// Of the candidates if there are any, by their fresh seeds; else of all points.
  void find_nearest() {
    if (results_.chosen() != nullptr) return;
    for (const TuneCandidate& candidate : results_.candidates) {
      if (candidate.fresh) take_nearer(candidate.point, *candidate.fresh, true);
    }
    if (results_.nearest) return;
    const auto points = best_first();
    if (!points.empty()) take_nearer(points.front(), scores_.at(points.front()), false);
  }

  void take_nearer(std::size_t point, const TradeScore& score, bool fresh) {
    TuneNearest nearest{point, fresh, limit_values(request(), score, fresh)};
    if (!results_.nearest || excess_of(nearest.values) < excess_of(results_.nearest->values)) {
      results_.nearest = std::move(nearest);
    }
  }

  bool all_hold(const TradeScore& fresh) const {
    return std::ranges::all_of(limit_values(request(), fresh, true), &LimitValue::holds);
  }

  void judge() {
    const TuneCandidate* chosen = results_.chosen();
    if (chosen == nullptr) return;
    const std::size_t point = chosen->point;
    results_.at_an_end = keys_at_an_end(plan(), results_.work.points[point]);
    if (results_.options.judging_seeds > 0) {
      const auto seeds =
          seeds_from(results_.fresh_seeds.back() + 1, results_.options.judging_seeds);
      const TradeWork judging = work_on(plan().scenes, seeds);
      results_.judged = Scorer(judging, {}, kept_, context_, cache_).score(point);
    }
    judge_unseen(point);
  }

  void judge_unseen(std::size_t point) {
    const TradeWork unseen = work_on(plan().unseen, results_.fresh_seeds);
    Scorer scorer(unseen, {}, {kept_.journal, kept_.part + " unseen"}, context_, cache_);
    std::vector<std::size_t> able;
    for (const std::size_t scene : all_scenes(unseen.plan)) {
      if (scorer.score(point, {scene})) {
        able.push_back(scene);
      } else {
        results_.unseen.refused.push_back(plan().unseen[scene].name);
      }
    }
    if (!able.empty()) results_.unseen.score = scorer.score(point, able);
  }

  TradeWork work_on(std::vector<NamedOptions> scenes, std::vector<std::uint64_t> seeds) const {
    TradeWork work = results_.work;
    work.plan.scenes = std::move(scenes);
    work.plan.seeds = std::move(seeds);
    return work;
  }

  const KeptSearch kept_;
  render::GlContext& context_;
  PhantomCache& cache_;
  const PartDone& done_;
  TuneResults results_;
  std::vector<SearchAxis> axes_;
  std::optional<Scorer> scorer_;
  std::map<std::vector<std::string>, std::size_t> numbers_;  ///< of points, by their values
  std::map<std::size_t, TradeScore> scores_;                 ///< of points that were not refused
};

}  // namespace

std::vector<std::string> tune_quantities() {
  std::vector<std::string> all;
  for (const auto& [measure, time] : kTradeTimes) all.emplace_back(measure->key);
  for (const Measure* measure : traded()) all.emplace_back(measure->key);
  return all;
}

std::string mean_of(const std::string& name) {
  return is_mean(name) ? name : std::string(kMeanOf) + name;
}

bool is_mean(const std::string& name) {
  return name.starts_with(kMeanOf);
}

const Measure& quantity(const std::string& name) {
  const std::string key = is_mean(name) ? name.substr(kMeanOf.size()) : name;
  for (const auto& [measure, time] : kTradeTimes) {
    if (key == measure->key) return *measure;
  }
  return *traded()[trade_measure(key)];
}

void check_quantity(const std::string& option, const std::string& name) {
  const auto names = tune_quantities();
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  std::string all;
  for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
  throw UserError(option + " = " + name + ": must be one of " + all + did_you_mean(name, names));
}

TuneLimit parse_limit(const std::string& text) {
  const bool mean = is_mean(text);
  TuneLimit limit = parse_limit(mean ? text.substr(kMeanOf.size()) : text, tune_quantities());
  if (!(limit.most > 0)) {
    throw UserError("--limit = " + text + ": must be NAME<=NUMBER with a number above 0");
  }
  if (mean) limit.name = mean_of(limit.name);
  return limit;
}

double figure_of(const TradeFigures& of, const std::string& name, bool bound) {
  if (const auto time = time_of(of, name)) return *time;
  MeanInterval known = of.measures[trade_measure(name)];
  if (quantity(name).worse == Worse::away_from_zero) known.mean = std::abs(known.mean);
  return bound ? upper_of_next(known) : known.mean;
}

Reached quantity_of(const TradeScore& score, const std::string& name) {
  return reached_by(score, name, false);
}

Reached upper_quantity(const TradeScore& score, const std::string& name) {
  return reached_by(score, name, true);
}

double excess_of(const TuneRequest& request, const TradeScore& score) {
  const double least = quantity_of(score, mean_of(request.least)).value;
  if (!std::isfinite(least)) return kNotFormed;
  return std::min(kNotFormed, excess_of(limit_values(request, score, false)));
}

std::vector<LimitValue> TuneResults::reached() const {
  if (chosen() == nullptr) return {};
  return limit_values(options.request, *chosen()->fresh, true);
}

std::vector<LimitValue> TuneResults::reached_unseen() const {
  if (!unseen.score) return {};
  return limit_values(options.request, *unseen.score, true);
}

const TuneCandidate* TuneResults::chosen() const {
  return candidates.empty() || !candidates.back().holds ? nullptr : &candidates.back();
}

std::vector<std::string> keys_at_an_end(const TradePlan& plan, const TradePoint& point) {
  std::vector<std::string> keys;
  const std::vector<double> shares = shares_of(plan, point);
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    const TradeAxis& axis = plan.axes[i];
    bool at_end = axis.range && (shares[i] < kNearEnd || shares[i] > 1 - kNearEnd);
    if (!axis.range) {
      const bool numbers = std::ranges::all_of(axis.levels, [](const std::string& level) {
        return level.find_first_not_of("0123456789.eE+-") == std::string::npos;
      });
      const auto last = static_cast<int>(axis.levels.size()) - 1;
      at_end = numbers && (point.levels[i] == 0 || point.levels[i] == last);
    }
    if (at_end) keys.push_back(axis.key);
  }
  return keys;
}

TuneResults tune(TradeWork work,
                 const TuneOptions& options,
                 TradeRecords known,
                 KeptSearch kept,
                 render::GlContext& context,
                 PhantomCache& cache,
                 const PartDone& done) {
  return Tuning(std::move(work), options, std::move(known), std::move(kept), context, cache, done)
      .run();
}

}  // namespace wobblebench::bench
