#include "bench/studies/trade/trade_study.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "base/statistics.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/cache/sha256.h"
#include "bench/scene/idle_options.h"
#include "bench/scene/scene_cost.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

Scene load(const TradeWork& work, std::size_t number, const std::vector<std::string>& of_point) {
  const NamedOptions& scene = work.plan.scenes[number];
  const std::string source = work.plan.source + " (scene " + scene.name + ")";
  Scene read = load_scene(scene.file, work.settings(number, of_point), source);
  check_memory_of_run(read, available_memory_bytes());
  check_program(read.picture);
  if (work.plan.of_one_scene) return read;
  if (read.acquisition.volumes != 1) {
    refuse_plan(source, "acquisition.volumes", "must be 1; one volume is rendered");
  }
  if (read.given.contains("simulation.seed")) {
    refuse_plan(source, "simulation.seed", "is set by the plan's seeds; leave it out");
  }
  return read;
}

void add_files(const Scene& scene, std::vector<fs::path>& files) {
  const auto more = phantom_files(scene);
  files.insert(files.end(), more.begin(), more.end());
}

/// Every option with its value, and which of them were given: the defaults of others may follow
/// from an axis. Without the names of files.
std::string text_without_names(const Scene& scene) {
  auto options = resolved(scene);
  for (const char* file : {"file", "scatterers"}) options["phantom"].erase(file);
  std::string text = options.dump();
  for (const std::string& key : scene.given) text += "\n" + key;
  const std::string& program = scene.picture.program;
  if (!program.empty()) text += "\n" + renderer_command(program);
  return text;
}

template <class IsOf>
std::string values_of(const TradePlan& plan, const TradePoint& point, const IsOf& is_of) {
  std::string text;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    if (is_of(plan.axes[i].key)) text += point.values[i] + "\n";
  }
  return text;
}

/// The values of the axes that decide which sticks are made, as one text.
std::string scan_values(const TradePlan& plan, const TradePoint& point) {
  return values_of(plan, point, [](const std::string& key) { return !key.starts_with("render."); });
}

/// The values of the axes that decide which slices a renderer makes of them.
std::string slice_values(const TradePlan& plan, const TradePoint& point) {
  return values_of(plan, point, [](const std::string& key) {
    return key.starts_with("render.reconstruction.") || key.starts_with("render.scan_conversion.");
  });
}

}  // namespace

Scene TradeWork::scene(std::size_t scene, const TradePoint& point) const {
  return load(*this, scene, settings_of(plan, point));
}

Scene TradeWork::reference(std::size_t scene) const {
  return load(*this, scene, plan.reference.settings);
}

std::optional<Scene> TradeWork::without_point(std::size_t scene,
                                              const std::vector<std::string>& others) const {
  try {
    return load(*this, scene, others);
  } catch (const UserError&) {
    return std::nullopt;
  }
}

std::vector<std::string> TradeWork::settings(std::size_t scene,
                                             const std::vector<std::string>& of_point) const {
  std::vector<std::string> all = plan.scenes[scene].settings;
  all.insert(all.end(), of_point.begin(), of_point.end());
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string TradeWork::run_command(std::size_t scene, std::size_t point) const {
  auto settings = this->settings(scene, settings_of(plan, points[point]));
  settings.push_back("simulation.seed=" + std::to_string(plan.seeds.front()));
  return run_command_line(plan.scenes[scene].file, settings);
}

std::vector<fs::path> TradeWork::files() const {
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) {
    if (!plan.scenes[i].file.empty()) files.push_back(plan.scenes[i].file);
    add_files(reference(i), files);
    if (const auto of_points = without_point(i)) add_files(*of_points, files);
    for (const TradeAxis& axis : plan.axes) {
      if (!axis.is_of_files()) continue;
      for (const std::string& level : axis.levels) {
        add_files(load(*this, i, {axis.key + "=" + level}), files);
      }
    }
  }
  return files;
}

std::string TradeWork::hash() const {
  Sha256 hash;
  const auto add = [&](const std::string& part) {
    hash.add(std::to_string(part.size()) + " " + part);
  };
  add(plan.canonical());
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) {
    add(text_without_names(reference(i)));
    if (const auto of_points = without_point(i)) add(text_without_names(*of_points));
  }
  for (const fs::path& file : files()) add(sha256_of_file(file));
  return hex(hash.digest());
}

void check_trade(const TradeWork& work) {
  for (const std::string& setting : work.more) {
    for (const TradeAxis& axis : work.plan.axes) {
      if (!setting.starts_with(axis.key + "=")) continue;
      throw UserError("--set " + setting + ": " + axis.key +
                      " is an axis of the plan; leave it out");
    }
  }
  for (std::size_t scene = 0; scene < work.plan.scenes.size(); ++scene) {
    work.reference(scene);
    for (const TradeAxis& axis : work.plan.axes) {
      std::vector<std::string> levels = axis.levels;
      if (axis.range) levels = {std::to_string(axis.range->from), std::to_string(axis.range->to)};
      for (const std::string& level : levels) {
        load(work, scene, {axis.key + "=" + level});
      }
    }
  }
  refuse_unused_renderers();
}

namespace {

/// Why a scene's phantom cannot be built; empty: it can.
std::string refusal_of(const Scene& scene, PhantomCache& cache) {
  try {
    with_late_refusals([&] { static_cast<void>(cache.phantom(scene.phantom)); });
    return {};
  } catch (const UserError& error) {
    return error.what();
  }
}

}  // namespace

std::vector<std::string> leave_out_refused(TradeWork& work,
                                           PhantomCache& cache,
                                           const PartDone& done) {
  TradePlan& plan = work.plan;
  std::vector<std::string> lines;
  if (plan.strata.empty()) return lines;
  std::vector<NamedOptions> scenes;
  std::vector<std::string> strata;
  PartCount parts(plan.scenes.size(), done);
  for (std::size_t i = 0; i < plan.scenes.size(); ++i) {
    const std::string refusal = refusal_of(work.reference(i), cache);
    parts.finish_one();
    if (!refusal.empty()) {
      lines.push_back("scene " + plan.scenes[i].name + " is left out: " + refusal);
      continue;
    }
    scenes.push_back(plan.scenes[i]);
    strata.push_back(plan.strata[i]);
  }
  if (scenes.empty()) throw UserError(plan.source + ": no scene can be built: " + lines.front());
  plan.scenes = std::move(scenes);
  plan.strata = std::move(strata);
  return lines;
}

std::string idle_settings(const TradeWork& work) {
  IdleInAll idle;
  for (const TradePoint& point : design_points(work.plan)) {
    for (std::size_t i = 0; i < work.plan.scenes.size(); ++i) {
      try {
        const Scene scene = work.scene(i, point);
        idle.add(scene, scene.given);
      } catch (const UserError&) {  // a combination that is refused is recorded as that
      }
    }
  }
  return idle_options_text(idle.options());
}

std::vector<TradeUnit> trade_units(const TradeWork& work) {
  using Position = std::tuple<std::size_t, std::string, std::size_t, std::string, std::size_t>;
  std::vector<Position> positions;
  for (std::size_t point = 0; point < work.points.size(); ++point) {
    const std::string scan = scan_values(work.plan, work.points[point]);
    const std::string slices = slice_values(work.plan, work.points[point]);
    for (std::size_t scene = 0; scene < work.plan.scenes.size(); ++scene) {
      for (std::size_t seed = 0; seed < work.plan.seeds.size(); ++seed) {
        positions.emplace_back(scene, scan, seed, slices, point);
      }
    }
  }
  std::sort(positions.begin(), positions.end());
  std::vector<TradeUnit> units;
  for (const auto& [scene, scan, seed, slices, point] : positions) {
    units.push_back({scene, point, seed});
  }
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

/// Sticks of a scene, and what they are compared with.
struct TradeMeasurement::Scan {
  std::size_t scene;
  std::string values;  ///< scan_values()
  std::size_t seed;    ///< whose sticks the evaluator has
  Evaluator evaluator;
};

/// The picture whose time is 1.
struct TradeMeasurement::Reference {
  Reference(const TradeWork& work,
            std::size_t scene,
            render::GlContext& context,
            PhantomCache& cache)
      : evaluator(work.reference(scene), context, cache) {
    evaluator.scan(evaluator.scene().simulation().fidelity, work.plan.seeds.front());
    options = evaluator.render_setting(work.reference(scene));
    evaluator.time_picture(options);
  }

  Evaluator evaluator;
  RenderSetting options;
};

TradeMeasurement::TradeMeasurement(const TradeWork& work,
                                   render::GlContext& context,
                                   PhantomCache& cache,
                                   std::size_t kept)
    : work_(work), context_(context), cache_(cache), kept_(kept), files_(work.files()) {}

TradeMeasurement::~TradeMeasurement() = default;

TradeMeasurement::Reference& TradeMeasurement::reference_of(std::size_t scene) {
  auto found = references_.find(scene);
  if (found == references_.end()) {
    if (references_.size() >= kept_) references_.clear();
    found = references_.emplace(scene, std::make_unique<Reference>(work_, scene, context_, cache_))
                .first;
  }
  return *found->second;
}

TradeMeasurement::Scan& TradeMeasurement::scan_of(const TradeUnit& unit, const Scene& scene) {
  const std::string values = scan_values(work_.plan, work_.points[unit.point]);
  const auto same_scan = [&](const auto& scan) {
    return scan->scene == unit.scene && scan->values == values;
  };
  const auto same = [&](const auto& scan) { return same_scan(scan) && scan->seed == unit.seed; };
  auto found = std::find_if(scans_.begin(), scans_.end(), same);
  const bool has_sticks = found != scans_.end();
  if (!has_sticks && scans_.size() >= kept_) {
    found = std::find_if(scans_.begin(), scans_.end(), same_scan);
    if (found == scans_.end()) scans_.pop_front();
  }
  std::unique_ptr<Scan> scan;
  if (found != scans_.end()) {
    scan = std::move(*found);
    scans_.erase(found);
  } else {
    scan.reset(new Scan{unit.scene, values, unit.seed, Evaluator(scene, context_, cache_)});
  }
  if (!has_sticks) {
    scan->evaluator.scan(scene.simulation.fidelity, work_.plan.seeds[unit.seed]);
    scan->seed = unit.seed;
  }
  scans_.push_back(std::move(scan));
  return *scans_.back();
}

void TradeMeasurement::measure(const TradeUnit& unit, const Scene& scene, TradeRecord& record) {
  Reference& reference = reference_of(unit.scene);
  Evaluator& evaluator = scan_of(unit, scene).evaluator;
  const RenderSetting options = evaluator.render_setting(scene);
  const EvaluationChoice choice{.measures = {.shaded = false, .distance = false},
                                .picture_time = true};
  const Evaluation evaluation = evaluator.evaluate(options, choice);
  record.measures = trade_measures(evaluation.measures);
  record.evaluation = evaluation.times;
  std::vector<TradeTimes> repeats;
  for (int i = 0; i < work_.plan.repeats; ++i) {
    const PictureTime theirs = reference.evaluator.time_picture(reference.options);
    const PictureTime mine = i == 0 ? evaluation.picture_time : evaluator.time_picture(options);
    repeats.push_back({mine.volume_ms,
                       mine.view_ms,
                       mine.volume_ms / theirs.volume_ms,
                       mine.view_ms / theirs.view_ms});
  }
  for (const auto& [measure, time] : kTradeTimes) {
    std::vector<double> values;
    for (const TradeTimes& times : repeats) values.push_back(times.*time);
    record.*time = spread_of(values).median;
  }
}

Image<glm::vec3> TradeMeasurement::picture(const TradeUnit& unit) {
  const Scene scene = work_.scene(unit.scene, work_.points[unit.point]);
  Evaluator& evaluator = scan_of(unit, scene).evaluator;
  const EvaluationChoice choice{{.shaded = false, .distance = false}, false};
  return evaluator.evaluate(evaluator.render_setting(scene), choice).picture.surface;
}

TradeRecord TradeMeasurement::measure(const TradeUnit& unit) {
  TradeRecord record;
  record.unit = unit;
  try {
    measure(unit, work_.scene(unit.scene, work_.points[unit.point]), record);
  } catch (const UserError& error) {
    record.refused = error.what();
  } catch (const InvalidOption& error) {
    record.refused = error.what();
  } catch (const phantoms::InvalidPhantom& error) {
    record.refused = std::string("phantom.") + error.what();
  }
  files_.refuse_changed(work_.plan.source);
  return record;
}

}  // namespace wobblebench::bench
