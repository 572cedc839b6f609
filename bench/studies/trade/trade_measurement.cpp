#include "bench/studies/trade/trade_measurement.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/statistics.h"
#include "base/user_error.h"
#include "bench/evaluation/evaluator.h"

namespace wobblebench::bench {

namespace {

template <class IsOf>
std::string values_of(const TradePlan& plan, const TradePoint& point, const IsOf& is_of) {
  std::string text;
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    if (is_of(plan.axes[i].key)) text += point.values[i] + "\n";
  }
  return text;
}

}  // namespace

std::string scan_values(const TradePlan& plan, const TradePoint& point) {
  return values_of(plan, point, [](const std::string& key) { return !key.starts_with("render."); });
}

std::string slice_values(const TradePlan& plan, const TradePoint& point) {
  return values_of(plan, point, [](const std::string& key) {
    return key.starts_with("render.reconstruction.") || key.starts_with("render.scan_conversion.");
  });
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
    options = evaluator.render_options(work.reference(scene));
    evaluator.time_picture(options);
  }

  Evaluator evaluator;
  render::RenderOptions options;
};

TradeMeasurement::TradeMeasurement(const TradeWork& work,
                                   render::GlContext& context,
                                   PhantomCache& cache,
                                   std::size_t kept)
    : work_(work), context_(context), cache_(cache), kept_(kept) {}

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
  const render::RenderOptions options = evaluator.render_options(scene);
  const EvaluationChoice choice{{.shaded = false, .distance = false}, false};
  const Evaluation evaluation = evaluator.evaluate(options, choice);
  record.measures = trade_measures(evaluation.measures);
  record.evaluation = evaluation.times;
  std::vector<double> volume, view, volume_ratio, view_ratio;
  for (int i = 0; i < work_.plan.repeats; ++i) {
    const PictureTime theirs = reference.evaluator.time_picture(reference.options);
    const PictureTime mine = evaluator.time_picture(options);
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

TradeRecord TradeMeasurement::measure(const TradeUnit& unit) {
  TradeRecord record{unit, {}, {}};
  try {
    measure(unit, work_.scene(unit.scene, work_.points[unit.point]), record);
  } catch (const UserError& error) {
    record.refused = error.what();
  } catch (const InvalidOption& error) {
    record.refused = error.what();
  }
  return record;
}

}  // namespace wobblebench::bench
