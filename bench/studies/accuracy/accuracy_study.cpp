#include "bench/studies/accuracy/accuracy_study.h"

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "base/statistics.h"
#include "base/user_error.h"
#include "bench/evaluation/measures/regions.h"
#include "bench/evaluation/truth/shadows.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

AccuracyBound bound_of(const std::string& name,
                       Evaluator& evaluator,
                       const render::RenderOptions& options) {
  const ResolvedScene& scene = evaluator.scene();
  const TrueView& view = evaluator.truth(options);
  const Image<std::uint8_t> band = silhouette_band(view.truth, view.camera);
  const auto counted = [&](int column, int row) { return band.at(column, row) == 0; };
  const phantoms::PlacedPhantom& subject = evaluator.subject();
  const PictureBound bound = picture_bound(view.truth,
                                           view.camera,
                                           scene.plan(),
                                           scene.simulation(),
                                           brightest_target_db(subject.phantom),
                                           counted);
  const StickRanges sticks = stick_ranges_m(subject, scene.plan(), render::make_view(options));
  const SpacingError spacing =
      spacing_error(view.truth, view.camera, scene.plan(), sticks, counted);
  return {name, bound.between_sticks_m, spacing};
}

/// Working state of measure_accuracy().
class Study {
 public:
  Study(render::GlContext& context,
        PhantomCache& cache,
        std::size_t parts,
        const PartDone& done,
        const AccuracyNote& note)
      : context_(context), cache_(cache), parts_(parts, done), note_(note) {}

  void measure(const AccuracyScene& planned) {
    if (!planned.drawn) return measure_scene(planned);
    try {
      measure_scene(planned);
      pictured_.insert(planned.name);
    } catch (const UserError& error) {
      note_refusal(planned, error.what());
    } catch (const phantoms::InvalidPhantom& error) {
      note_refusal(planned, std::string("phantom.") + error.what());
    }
  }

  AccuracyResults results;

 private:
  void measure_scene(const AccuracyScene& planned) {
    Evaluator evaluator(planned.settings.front().scene, context_, cache_);
    for (const sim::Rung rung : planned.rungs) {
      for (const std::uint64_t seed : planned.seeds) {
        evaluator.scan(rung, seed);
        for (const auto& setting : planned.settings) measure(planned, setting, seed, evaluator);
      }
    }
    if (planned.drawn) return;
    const AccuracyBound bound = bound_of(
        planned.name, evaluator, evaluator.render_setting(planned.settings.front().scene).options);
    if (bound.spacing.n > 0) results.bounds.push_back(bound);
  }

  void note_refusal(const AccuracyScene& planned, const std::string& line) {
    results.notes.push_back("A scene of " + planned.name + " (seed " +
                            std::to_string(planned.seeds.front()) + ") is refused: " + line);
  }

  void measure(const AccuracyScene& planned,
               const AccuracyScene::Setting& setting,
               std::uint64_t seed,
               Evaluator& evaluator) {
    const std::string rung = sim::to_string(evaluator.rung());
    if (note_) note_(planned.name + " " + rung + " " + setting.name);
    const RenderSetting rendered = evaluator.render_setting(setting.scene);
    const render::RenderOptions& options = rendered.options;
    Evaluation evaluation = evaluator.evaluate(rendered, {.measures = {}, .picture_time = true});
    const double render_ms = evaluation.picture_time.volume_ms;
    add_rows({planned.name, rung, setting.name, seed, {}, render_ms}, evaluation);
    add_times(evaluation.times);
    parts_.finish_one();
    if (seed != planned.seeds.front() || pictured_.contains(planned.name)) return;
    note_missing_surface(planned.name, rung, evaluation.measures.raw);
    if (&setting == &planned.settings.front()) {
      auto shaded = shade_truth(evaluator.truth(options).truth, options, evaluation.picture.volume);
      if (!shaded.pixels.empty()) {
        results.pictures.push_back({planned.name, rung, "truth", std::move(shaded)});
      }
    }
    results.pictures.push_back(
        {planned.name, rung, setting.name, std::move(evaluation.picture.surface)});
    results.commands[{planned.name, rung, setting.name}] =
        setting.command + " --set simulation.fidelity=" + rung +
        " --set simulation.seed=" + std::to_string(seed);
  }

  void add_rows(AccuracyRow row, const Evaluation& evaluation) {
    for (MeasureRow& measures : measure_rows(evaluation.measures)) {
      row.measures = std::move(measures);
      results.rows.push_back(row);
      row.render_ms = kUnset;
    }
  }

  void add_times(const EvaluationTimes& times) {
    ++results.evaluations;
    for (const auto part : {&EvaluationTimes::renderer_ms,
                            &EvaluationTimes::render_ms,
                            &EvaluationTimes::truth_ms,
                            &EvaluationTimes::measure_ms,
                            &EvaluationTimes::registration_ms}) {
      results.times.*part += times.*part;
    }
  }

  void note_missing_surface(const std::string& scene,
                            const std::string& rung,
                            const DepthError& error) {
    if (error.surface_in_view()) return;
    const std::string note =
        scene + " on " + rung + ": no surface in view: " + why_no_surface(error);
    if (results.notes.empty() || results.notes.back() != note) results.notes.push_back(note);
  }

  render::GlContext& context_;
  PhantomCache& cache_;
  PartCount parts_;
  const AccuracyNote& note_;
  std::set<std::string> pictured_;  ///< strata whose pictures are there
};

/// Scene, rung, group, region and setting of a summary.
using Key = std::array<std::string, 5>;
/// The rows of one summary by seed.
using SeedRows = std::map<std::uint64_t, const AccuracyRow*>;

Key key_of(const AccuracyRow& row) {
  return {row.scene, row.rung, row.measures.group, row.measures.region, row.setting};
}

template <class Value>
std::vector<double> values_of(const SeedRows& rows, const Value& value) {
  std::vector<double> values;
  for (const auto& [seed, row] : rows) values.push_back(value(*row));
  return values;
}

std::vector<double> column(const SeedRows& rows, std::size_t measure) {
  return values_of(rows, [&](const AccuracyRow& row) { return row.measures.values[measure]; });
}

/// The rows whose seeds `others` has, too: a region may be empty for one of two settings.
SeedRows common(const SeedRows& rows, const SeedRows& others) {
  SeedRows result = rows;
  std::erase_if(result, [&](const auto& row) { return !others.contains(row.first); });
  return result;
}

/// Differences to the first setting and the ratio of times, seed by seed.
void compare(const SeedRows& rows, const SeedRows& references, AccuracySummary& summary) {
  const SeedRows mine = common(rows, references), theirs = common(references, rows);
  for (std::size_t i = 0; i < picture_measures().size(); ++i) {
    summary.differences.push_back(paired_difference(column(mine, i), column(theirs, i)));
  }
  summary.render_ratio = mean_interval(values_of(mine, [&](const AccuracyRow& row) {
    return row.render_ms / theirs.at(row.seed)->render_ms;
  }));
}

AccuracySummary summary_of(const Key& key, const SeedRows& rows) {
  const auto& [scene, rung, group, region, setting] = key;
  AccuracySummary summary{scene, rung, setting, group, region, {}, {}, {}, {}};
  for (std::size_t i = 0; i < picture_measures().size(); ++i) {
    summary.means.push_back(mean_interval(column(rows, i)));
  }
  summary.render_ms =
      mean_interval(values_of(rows, [](const AccuracyRow& row) { return row.render_ms; }));
  return summary;
}

}  // namespace

std::size_t accuracy_parts(const std::vector<AccuracyScene>& scenes) {
  std::size_t parts = 0;
  for (const AccuracyScene& scene : scenes) {
    parts += scene.rungs.size() * scene.seeds.size() * scene.settings.size();
  }
  return parts;
}

std::vector<AccuracySummary> summarise(const std::vector<AccuracyRow>& rows,
                                       const std::string& reference) {
  std::map<Key, SeedRows> by_key;
  std::vector<Key> order;
  for (const AccuracyRow& row : rows) {
    SeedRows& same = by_key[key_of(row)];
    if (same.empty()) order.push_back(key_of(row));
    same[row.seed] = &row;
  }
  std::vector<AccuracySummary> summaries;
  for (const Key& key : order) {
    summaries.push_back(summary_of(key, by_key.at(key)));
    Key other = key;
    other.back() = reference;
    if (key == other || !by_key.contains(other)) continue;
    compare(by_key.at(key), by_key.at(other), summaries.back());
  }
  return summaries;
}

AccuracyResults measure_accuracy(const std::vector<AccuracyScene>& scenes,
                                 render::GlContext& context,
                                 PhantomCache& cache,
                                 const PartDone& done,
                                 const AccuracyNote& note) {
  Study study(context, cache, accuracy_parts(scenes), done, note);
  for (const AccuracyScene& scene : scenes) study.measure(scene);
  if (study.results.rows.empty()) throw UserError(study.results.notes.front());
  study.results.seeds = scenes.front().seeds;
  study.results.of_population = scenes.front().drawn;
  study.results.summaries = summarise(study.results.rows, scenes.front().settings.front().name);
  return std::move(study.results);
}

}  // namespace wobblebench::bench
