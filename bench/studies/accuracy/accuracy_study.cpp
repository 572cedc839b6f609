#include "bench/studies/accuracy/accuracy_study.h"

#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "bench/evaluation/measures/regions.h"
#include "bench/evaluation/truth/shadows.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

AccuracyBound bound_of(const std::string& name,
                       Evaluator& evaluator,
                       const render::RenderOptions& options) {
  const Scene& scene = evaluator.scene();
  const TrueView& view = evaluator.truth(options);
  const Image<std::uint8_t> band = silhouette_band(view.truth, view.camera);
  const auto counted = [&](int column, int row) { return band.at(column, row) == 0; };
  const phantoms::PlacedPhantom& subject = evaluator.subject();
  const PictureBound bound = picture_bound(view.truth,
                                           view.camera,
                                           scene.plan(),
                                           scene.simulation,
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
    Evaluator evaluator(planned.settings.front().scene, context_, cache_);
    for (const sim::Rung rung : planned.rungs) {
      for (const std::uint64_t seed : planned.seeds) {
        evaluator.scan(rung, seed);
        for (const auto& setting : planned.settings) measure(planned, setting, seed, evaluator);
      }
    }
    const AccuracyBound bound =
        bound_of(planned.name, evaluator, evaluator.render_options(planned.settings.front().scene));
    if (bound.spacing.n > 0) results.bounds.push_back(bound);
  }

  AccuracyResults results;

 private:
  void measure(const AccuracyScene& planned,
               const AccuracyScene::Setting& setting,
               std::uint64_t seed,
               Evaluator& evaluator) {
    const std::string rung = sim::to_string(evaluator.rung());
    if (note_) note_(planned.name + " " + rung + " " + setting.name);
    const render::RenderOptions options = evaluator.render_options(setting.scene);
    Evaluation evaluation = evaluator.evaluate(options);
    const double render_ms = evaluator.time_picture(options).volume_ms;
    add_rows({planned.name, rung, setting.name, seed, {}, render_ms}, evaluation);
    add_times(evaluation.times);
    parts_.finish_one();
    if (seed != planned.seeds.front()) return;
    note_missing_surface(planned.name, rung, evaluation.measures.raw);
    if (&setting == &planned.settings.front()) {
      auto shaded = shade_truth(evaluator.truth(options).truth, options, evaluation.picture.volume);
      if (!shaded.pixels.empty()) {
        results.pictures.push_back({planned.name, rung, "truth", std::move(shaded)});
      }
    }
    results.pictures.push_back(
        {planned.name, rung, setting.name, std::move(evaluation.picture.surface)});
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
};

/// What the rows of one summary have in common, but for the setting.
using Place = std::tuple<std::string, std::string, std::string, std::string>;

Place place_of(const AccuracyRow& row) {
  return {row.scene, row.rung, row.measures.group, row.measures.region};
}

/// For each seed the values of the measures.
using BySeed = std::map<std::uint64_t, std::vector<double>>;

/// For each seed the time of the picture.
using TimeBySeed = std::map<std::uint64_t, double>;

/// Over those of another setting, rendered in turn: seed by seed.
MeanInterval mean_ratio(const TimeBySeed& times, const TimeBySeed& references) {
  std::vector<double> ratios;
  for (const auto& [seed, ms] : times) {
    const auto other = references.find(seed);
    if (other != references.end()) ratios.push_back(ms / other->second);
  }
  return mean_interval(ratios);
}

MeanInterval mean_time(const TimeBySeed& times) {
  std::vector<double> values;
  for (const auto& [seed, ms] : times) values.push_back(ms);
  return mean_interval(values);
}

std::vector<double> column(const BySeed& values, std::size_t measure) {
  std::vector<double> result;
  for (const auto& [seed, row] : values) result.push_back(row[measure]);
  return result;
}

/// Of the seeds that both have: a region may be empty for one of them.
std::vector<MeanInterval> differences(const BySeed& values, const BySeed& references) {
  BySeed mine, theirs;
  for (const auto& [seed, row] : values) {
    const auto other = references.find(seed);
    if (other == references.end()) continue;
    mine[seed] = row;
    theirs[seed] = other->second;
  }
  std::vector<MeanInterval> result;
  for (std::size_t i = 0; i < measure_names().size(); ++i) {
    result.push_back(paired_difference(column(mine, i), column(theirs, i)));
  }
  return result;
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
  std::map<std::pair<Place, std::string>, BySeed> values;
  std::map<std::pair<Place, std::string>, TimeBySeed> times_ms;
  std::vector<std::pair<Place, std::string>> order;
  for (const AccuracyRow& row : rows) {
    const std::pair key{place_of(row), row.setting};
    if (!values.contains(key)) order.push_back(key);
    values[key][row.seed] = row.measures.values;
    times_ms[key][row.seed] = row.render_ms;
  }
  std::vector<AccuracySummary> summaries;
  for (const auto& key : order) {
    const auto& [scene, rung, group, region] = key.first;
    AccuracySummary summary{scene, rung, key.second, group, region, {}, {}, {}, {}};
    summary.render_ms = mean_time(times_ms.at(key));
    const BySeed& mine = values.at(key);
    for (std::size_t i = 0; i < measure_names().size(); ++i) {
      summary.means.push_back(mean_interval(column(mine, i)));
    }
    const auto other = values.find({key.first, reference});
    if (key.second != reference && other != values.end()) {
      summary.differences = differences(mine, other->second);
      summary.render_ratio = mean_ratio(times_ms.at(key), times_ms.at(other->first));
    }
    summaries.push_back(std::move(summary));
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
  study.results.seeds = scenes.front().seeds;
  study.results.summaries = summarise(study.results.rows, scenes.front().settings.front().name);
  return std::move(study.results);
}

}  // namespace wobblebench::bench
