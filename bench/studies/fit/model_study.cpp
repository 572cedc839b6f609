#include "bench/studies/fit/model_study.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/evaluation/evaluator.h"
#include "bench/studies/fit/fit_scans.h"
#include "bench/studies/fit/scan_sets.h"

namespace wobblebench::bench {

namespace {

/// Training takes every second pixel each way: neighbours say the same.
constexpr int kTrainingStride = 2;
constexpr EvaluationChoice kDepthsAlone = {{.shaded = false, .distance = false}, false};

ScannedErrors compare(const render::Picture& picture, const Truth& truth, Image<PixelTerms> terms) {
  ScannedErrors result{{terms.width, terms.height, kNoSurface}, std::move(terms), 0};
  int both = 0, other = 0;
  for (std::size_t i = 0; i < truth.depth_m.pixels.size(); ++i) {
    const float error = picture.depth_m.pixels[i] - truth.depth_m.pixels[i];
    if (!std::isfinite(error) || !result.terms.pixels[i].measured) continue;
    ++both;
    const bool same = std::abs(static_cast<double>(error)) <= kOtherSurface_m;
    other += !same;
    if (same) result.error_m.pixels[i] = error;
  }
  result.other_surface_percent = both > 0 ? 100.0 * other / both : 0;
  return result;
}

/// The scans of one set.
class SetScans {
 public:
  SetScans(const ScanSet& set, PhantomCache& cache, render::GlContext& context)
      : set_(set),
        evaluator_(small(set.scene), context, cache),
        options_(evaluator_.scene().render()),
        meter_(evaluator_.scene().plan(), evaluator_.scene().simulation(), options_) {}

  render::Camera camera() const { return render::make_camera(options_); }
  double step_mm() const { return render::step_m(options_) / kMillimetre; }

  /// Calls body(errors, picture, measures) for each seed.
  template <class Body>
  void for_each_seed(sim::Rung rung, PartCount& parts, const Body& body) {
    for (const std::uint64_t seed : set_.seeds) {
      evaluator_.scan(rung, seed);
      const Evaluation scored = evaluator_.evaluate(options_, kDepthsAlone);
      body(compare(scored.picture,
                   evaluator_.truth(options_).truth,
                   meter_.measure(scored.picture.filtered_depth_m, evaluator_.sticks())),
           scored.picture,
           scored.measures);
      parts.finish_one();
    }
  }

  PictureMeasures measure(const render::Picture& picture) {
    return measure_picture(picture, evaluator_.truth(options_), options_, kDepthsAlone.measures);
  }

 private:
  static Scene small(Scene scene) {
    auto& casting = scene.render.ray_casting;
    casting.image_size = std::min(casting.image_size, kFitImageSize);
    casting.mode = render::RenderMode::surface;
    return scene;
  }

  const ScanSet& set_;
  Evaluator evaluator_;
  render::RenderOptions options_;
  TermMeter meter_;
};

void add_rows(const ScannedErrors& scan,
              const render::Camera& camera,
              int set,
              int stride,
              std::vector<ErrorRow>& rows) {
  for (int row = 0; row < scan.error_m.height; row += stride) {
    for (int column = 0; column < scan.error_m.width; column += stride) {
      const float error = scan.error_m.at(column, row);
      if (!std::isfinite(error)) continue;
      // One block for all seeds at a place: what the model leaves there is the same in each.
      const std::int64_t block = error_block(camera, column, row) + (std::int64_t{set} << 48);
      rows.push_back({scan.terms.at(column, row), error, block, set});
    }
  }
}

std::size_t scans_in(const std::vector<ScanSet>& sets) {
  std::size_t count = 0;
  for (const ScanSet& set : sets) count += set.seeds.size() * rungs_of_fit(set.scene).size();
  return count;
}

render::Picture less_bias(render::Picture picture,
                          const Image<PixelTerms>& terms,
                          const DetectionModel& model) {
  for (std::size_t i = 0; i < picture.depth_m.pixels.size(); ++i) {
    if (!terms.pixels[i].measured) continue;
    picture.depth_m.pixels[i] -= static_cast<float>(model.bias_m(terms.pixels[i]));
  }
  return picture;
}

/// Collects the held-out sets, one after the other.
struct HeldOut {
  ModelStudy& study;
  PartCount& parts;
  std::vector<ErrorRow> all;

  void add(const ScanSet& set, SetScans& scans) {
    for (const sim::Rung rung : rungs_of_fit(set.scene)) {
      std::vector<ErrorRow> rows;
      std::vector<ScannedErrors> errors;
      PictureEffect found, corrected;
      const double share = 1.0 / static_cast<double>(set.seeds.size());
      double other = 0;
      scans.for_each_seed(
          rung,
          parts,
          [&](ScannedErrors scan, const render::Picture& picture, const PictureMeasures& measures) {
            add_rows(scan, scans.camera(), 0, 1, rows);
            other += share * scan.other_surface_percent;
            found.add(measures, share);
            corrected.add(scans.measure(less_bias(picture, scan.terms, study.model)), share);
            errors.push_back(std::move(scan));
          });
      Judgement judgement = judge(set.name, set.of, rows, study.model);
      judgement.rung = sim::to_string(rung);
      judgement.other_surface_percent = other;
      judgement.reproducible_variance = reproducible_variance(errors);
      judgement.found = found;
      judgement.corrected = corrected;
      study.held_out.push_back(judgement);
      if (rung == rungs_of_fit(set.scene).front()) {
        study.pictures.push_back(residual_picture(set.name, errors.front(), study.model));
      }
      all.insert(all.end(), rows.begin(), rows.end());
    }
  }
};

void train(const std::vector<ScanSet>& sets,
           PhantomCache& cache,
           render::GlContext& context,
           PartCount& parts,
           ModelStudy& study) {
  std::vector<ErrorRow> rows;
  double other = 0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    SetScans scans(sets[i], cache, context);
    if (i == 0) study.step_mm = scans.step_mm();
    for (const sim::Rung rung : rungs_of_fit(sets[i].scene)) {
      scans.for_each_seed(
          rung,
          parts,
          [&](const ScannedErrors& scan, const render::Picture&, const PictureMeasures&) {
            add_rows(scan, scans.camera(), static_cast<int>(i), kTrainingStride, rows);
            other += scan.other_surface_percent;
            ++study.training_scans;
          });
    }
  }
  study.choice = choose_terms(rows, folds_of(sets));
  study.model = fit_detection_model(rows, study.choice.taken);
  study.training = judge("training", "", rows, study.model);
  study.training.other_surface_percent = other / study.training_scans;
}

}  // namespace

ModelStudy study_detection_model(const Scene& scene,
                                 const std::vector<std::pair<std::string, Scene>>& others,
                                 int seeds,
                                 PhantomCache& cache,
                                 render::GlContext& context,
                                 const PartDone& done) {
  const auto training = training_sets(scene, seeds);
  const auto held_out = held_out_sets(
      scene, others, std::max(training.back().seeds.back() + 1, scene.simulation.seed + 20), cache);
  PartCount parts(scans_in(training) + scans_in(held_out), done);
  ModelStudy study;
  train(training, cache, context, parts, study);
  HeldOut judged{study, parts, {}};
  for (const ScanSet& set : held_out) {
    SetScans scans(set, cache, context);
    judged.add(set, scans);
  }
  study.all_held_out = judge("all held out", "", judged.all, study.model);
  study.all_held_out.reproducible_variance = std::numeric_limits<double>::quiet_NaN();
  study.bins = residual_bins(judged.all, study.model);
  return study;
}

}  // namespace wobblebench::bench
