#include "bench/studies/trade/trade_study.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "base/user_error.h"
#include "bench/cache/sha256.h"
#include "bench/scene/scene_cost.h"
#include "bench/studies/accuracy/option_tables.h"
#include "bench/studies/trade/trade_measurement.h"

namespace wobblebench::bench {

namespace {

Scene load(const TradePlan& plan,
           const NamedOptions& scene,
           std::vector<std::string> settings,
           const std::vector<std::string>& more) {
  settings.insert(settings.begin(), scene.settings.begin(), scene.settings.end());
  settings.insert(settings.end(), more.begin(), more.end());
  const std::string source = plan.source + " (scene " + scene.name + ")";
  Scene read = load_scene(scene.file, settings, source);
  check_memory_of_run(read, available_memory_bytes());
  if (plan.of_one_scene) return read;
  if (read.acquisition.volumes != 1) {
    refuse_plan(source, "acquisition.volumes", "must be 1; one volume is rendered");
  }
  if (read.given.contains("simulation.seed")) {
    refuse_plan(source, "simulation.seed", "is set by the plan's seeds; leave it out");
  }
  return read;
}

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
    const std::string scan = scan_values(work.plan, work.points[point]);
    const std::string slices = slice_values(work.plan, work.points[point]);
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
  TradeMeasurement measurement(work, context, cache);
  PartCount parts(left.size(), done);
  for (const TradeUnit& unit : left) {
    journal.append(measurement.measure(unit));
    parts.finish_one();
  }
}

}  // namespace wobblebench::bench
