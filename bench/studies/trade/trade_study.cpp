#include "bench/studies/trade/trade_study.h"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "base/statistics.h"
#include "base/user_error.h"
#include "bench/cache/sha256.h"
#include "bench/evaluation/evaluator.h"
#include "bench/scene/available_memory.h"
#include "bench/scene/option_tables.h"
#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

bool is_of_scan(const std::string& key) {
  return !key.starts_with("render.");
}

/// What decides which slices a renderer makes.
bool is_of_slices(const std::string& key) {
  return key.starts_with("render.reconstruction.") || key.starts_with("render.scan_conversion.");
}

/// The values of the axes that `is_of` names, as one text.
template <class IsOf>
std::string values_of(const TradePlan& plan, const TradePoint& point, const IsOf& is_of) {
  std::string text;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    if (is_of(plan.axes[i].key)) text += point.values[i] + "\n";
  }
  return text;
}

Scene load(const TradePlan& plan,
           const NamedOptions& scene,
           std::vector<std::string> settings,
           const std::vector<std::string>& more) {
  settings.insert(settings.begin(), scene.settings.begin(), scene.settings.end());
  settings.insert(settings.end(), more.begin(), more.end());
  const std::string source = plan.source + " (scene " + scene.name + ")";
  Scene read = load_scene(scene.file, settings, source);
  if (read.acquisition.volumes != 1) {
    refuse_plan(source, "acquisition.volumes", "must be 1; one volume is rendered");
  }
  if (read.given.contains("simulation.seed")) {
    refuse_plan(source, "simulation.seed", "is set by the plan's seeds; leave it out");
  }
  check_memory_of_run(read, available_memory_bytes());
  return read;
}

/// Working state of measure_trade().
class Study {
 public:
  Study(const TradeWork& work, render::GlContext& context, PhantomCache& cache)
      : work_(work), context_(context), cache_(cache) {}

  TradeRecord measure(const TradeUnit& unit) {
    TradeRecord record{unit, {}, {}};
    try {
      const Scene scene = work_.scene(unit.scene, work_.points[unit.point]);
      prepare(unit, scene);
      measure(scene, record);
    } catch (const UserError& error) {
      record.refused = error.what();
    } catch (const InvalidOption& error) {
      record.refused = error.what();
    }
    return record;
  }

 private:
  using ScanKey = std::tuple<std::size_t, std::string>;

  /// Makes the evaluators of the unit, with their sticks.
  void prepare(const TradeUnit& unit, const Scene& scene) {
    if (!reference_ || reference_scene_ != unit.scene) {
      reference_.reset();
      reference_.emplace(work_.reference(unit.scene), context_, cache_);
      reference_->scan(reference_->scene().simulation.fidelity, work_.plan.seeds.front());
      reference_scene_ = unit.scene;
      reference_options_ = reference_->render_options(work_.reference(unit.scene));
      reference_->time_picture(reference_options_);
    }
    const ScanKey key{unit.scene, values_of(work_.plan, work_.points[unit.point], is_of_scan)};
    if (!evaluator_ || key_ != key) {
      evaluator_.reset();
      seed_.reset();
      evaluator_.emplace(scene, context_, cache_);
      key_ = key;
    }
    if (seed_ == unit.seed) return;
    evaluator_->scan(scene.simulation.fidelity, work_.plan.seeds[unit.seed]);
    seed_ = unit.seed;
  }

  void measure(const Scene& scene, TradeRecord& record) {
    const render::RenderOptions options = evaluator_->render_options(scene);
    const EvaluationChoice choice{{.shaded = false, .distance = false}, false};
    record.measures = trade_measures(evaluator_->evaluate(options, choice).measures);
    std::vector<double> volume, view, volume_ratio, view_ratio;
    for (int i = 0; i < work_.plan.repeats; ++i) {
      const PictureTime theirs = reference_->time_picture(reference_options_);
      const PictureTime mine = evaluator_->time_picture(options);
      volume.push_back(mine.volume_ms);
      view.push_back(mine.view_ms);
      volume_ratio.push_back(mine.volume_ms / theirs.volume_ms);
      view_ratio.push_back(mine.view_ms / theirs.view_ms);
    }
    record.volume_ms = spread_of(volume).median;
    record.view_ms = spread_of(view).median;
    record.volume_ratio = spread_of(volume_ratio).median;
    record.view_ratio = spread_of(view_ratio).median;
  }

  const TradeWork& work_;
  render::GlContext& context_;
  PhantomCache& cache_;
  std::optional<Evaluator> reference_, evaluator_;
  std::size_t reference_scene_ = 0;
  render::RenderOptions reference_options_;
  ScanKey key_;
  std::optional<std::size_t> seed_;  ///< whose sticks evaluator_ has
};

}  // namespace

Scene TradeWork::scene(std::size_t scene, const TradePoint& point) const {
  return load(plan, plan.scenes[scene], settings_of(plan, point), more);
}

Scene TradeWork::reference(std::size_t scene) const {
  return load(plan, plan.scenes[scene], plan.reference.settings, more);
}

std::string TradeWork::hash() const {
  Sha256 hash;
  hash.add(plan.canonical());
  for (const std::string& setting : more) hash.add("\n" + setting);
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) hash.add(resolved(reference(i)).dump());
  return hex(hash.digest());
}

void check_trade(const TradeWork& work) {
  for (std::size_t scene = 0; scene < work.plan.scenes.size(); ++scene) {
    work.reference(scene);
    for (const TradeAxis& axis : work.plan.axes) {
      std::vector<std::string> levels = axis.levels;
      if (axis.range) levels = {std::to_string(axis.range->from), std::to_string(axis.range->to)};
      for (const std::string& level : levels) {
        load(work.plan, work.plan.scenes[scene], {axis.key + "=" + level}, work.more);
      }
    }
  }
}

std::vector<TradeUnit> trade_units(const TradeWork& work) {
  struct Place {
    std::size_t scene;
    std::string scan;
    std::size_t seed;
    std::string slices;
    std::size_t point;
    bool operator<(const Place& o) const {
      return std::tie(scene, scan, seed, slices, point) <
             std::tie(o.scene, o.scan, o.seed, o.slices, o.point);
    }
  };
  std::vector<Place> places;
  for (std::size_t point = 0; point < work.points.size(); ++point) {
    const std::string scan = values_of(work.plan, work.points[point], is_of_scan);
    const std::string slices = values_of(work.plan, work.points[point], is_of_slices);
    for (std::size_t scene = 0; scene < work.plan.scenes.size(); ++scene) {
      for (std::size_t seed = 0; seed < work.plan.seeds.size(); ++seed) {
        places.push_back({scene, scan, seed, slices, point});
      }
    }
  }
  std::sort(places.begin(), places.end());
  std::vector<TradeUnit> units;
  for (const Place& place : places) units.push_back({place.scene, place.point, place.seed});
  return units;
}

std::vector<TradeUnit> trade_shard(const std::vector<TradeUnit>& units, int index, int count) {
  const auto at = [&](int i) {
    return units.begin() + static_cast<std::ptrdiff_t>(units.size() * static_cast<std::size_t>(i) /
                                                       static_cast<std::size_t>(count));
  };
  return {at(index - 1), at(index)};
}

void measure_trade(const TradeWork& work,
                   const std::vector<TradeUnit>& units,
                   TradeJournal& journal,
                   render::GlContext& context,
                   PhantomCache& cache,
                   const PartDone& done) {
  std::vector<TradeUnit> left;
  for (const TradeUnit& unit : units) {
    if (!journal.records().contains(unit)) left.push_back(unit);
  }
  Study study(work, context, cache);
  PartCount parts(left.size(), done);
  for (const TradeUnit& unit : left) {
    journal.append(study.measure(unit));
    parts.finish_one();
  }
}

}  // namespace wobblebench::bench
