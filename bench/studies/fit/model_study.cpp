#include "bench/studies/fit/model_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/statistics.h"
#include "base/units.h"
#include "bench/studies/evaluator/evaluator.h"
#include "bench/studies/fit/fit_scans.h"

namespace wobblebench::bench {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Training takes every second pixel of every second row: errors of neighbours are correlated.
constexpr int kTrainingStride = 2;
constexpr EvaluationChoice kDepthsAlone = {{.shaded = false, .distance = false}, false};

/// One scan: its picture, the errors of that, and what was measured of its pixels.
struct Scan {
  Image<float> error_m;  ///< NaN: no error
  Image<PixelTerms> terms;
  double other_surface_percent = 0;
  Evaluation scored;
};

/// Quantities by which errors are averaged, in bins of equal width.
struct BinnedQuantity {
  const char* name;
  double low, high;
  int count;
};
constexpr std::array<BinnedQuantity, 3> kBinned = {
    {{"incidence_deg", 0, 75, 15}, {"range_mm", 20, 160, 14}, {"contrast", 0, 0.45, 9}}};
constexpr int kLeastPixels = 50;  // of a bin

std::array<double, kBinned.size()> binned_values(const PixelTerms& pixel) {
  return {static_cast<double>(pixel.incidence_rad) / kDegree,
          static_cast<double>(pixel.x[kDepthTerm]) + 75,
          static_cast<double>(pixel.x[kContrastTerm])};
}

/// Correlation over the pixels that both have; NaN where one does not vary.
double picture_correlation(const Image<float>& one, const Image<float>& other) {
  std::vector<double> a, b;
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    if (!std::isfinite(one.pixels[i]) || !std::isfinite(other.pixels[i])) continue;
    a.push_back(static_cast<double>(one.pixels[i]));
    b.push_back(static_cast<double>(other.pixels[i]));
  }
  return correlation(a, b);
}

/// Adds the errors of one of 1 / `share` scans.
void add_effect(const PictureMeasures& measures, double share, PictureEffect& effect) {
  effect.median_mm += share * measures.raw.depth.median_m / kMillimetre;
  effect.p95_mm += share * measures.raw.depth.p95_m / kMillimetre;
  effect.missed_percent += share * measures.raw.missed_percent();
  effect.false_percent += share * measures.raw.false_percent();
  for (const RegionError& region : measures.regions) {
    if (region.group != "silhouette" || region.name != "outside") continue;
    effect.outside_rms_mm += share * region.depth.rms_m / kMillimetre;
  }
}

/// Mean correlation of the errors of two scans.
double reproducible_variance(const std::vector<Scan>& scans) {
  double sum = 0, pairs = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (std::size_t j = i + 1; j < scans.size(); ++j, ++pairs) {
      sum += picture_correlation(scans[i].error_m, scans[j].error_m);
    }
  }
  return pairs > 0 ? sum / pairs : kNone;
}

Judgement judge(const std::string& name,
                const std::string& of,
                const std::vector<ErrorRow>& rows,
                const DetectionModel& model) {
  Judgement result{.name = name, .of = of, .pixels = static_cast<int>(rows.size())};
  if (rows.empty()) return result;
  const auto n = static_cast<double>(rows.size());
  double sum = 0, squares = 0, left_sum = 0, left_squares = 0, one = 0, two = 0;
  for (const ErrorRow& row : rows) {
    const double e = static_cast<double>(row.error_m) / kMillimetre;
    const double left = e - model.bias_m(row.pixel) / kMillimetre;
    const double spread = model.spread_m(row.pixel) / kMillimetre;
    sum += e, squares += e * e, left_sum += left, left_squares += left * left;
    one += std::abs(left) <= spread, two += std::abs(left) <= 2 * spread;
  }
  result.mean_before_mm = sum / n;
  result.mean_after_mm = left_sum / n;
  result.rms_before_mm = std::sqrt(squares / n);
  result.rms_after_mm = std::sqrt(left_squares / n);
  result.explained_variance = 1 - left_squares / (squares - sum * sum / n);
  result.removed_mean_square = 1 - left_squares / squares;
  result.reproducible_variance = kNone;
  result.within_one_percent = 100 * one / n;
  result.within_two_percent = 100 * two / n;
  return result;
}

ResidualPicture residual_picture(const std::string& name,
                                 const Scan& scan,
                                 const DetectionModel& model) {
  ResidualPicture result{name, scan.error_m, scan.error_m, scan.error_m};
  for (std::size_t i = 0; i < scan.error_m.pixels.size(); ++i) {
    if (!std::isfinite(scan.error_m.pixels[i])) continue;
    result.bias_m.pixels[i] = static_cast<float>(model.bias_m(scan.terms.pixels[i]));
    result.left_m.pixels[i] = scan.error_m.pixels[i] - result.bias_m.pixels[i];
  }
  return result;
}

/// Mean errors in the bins of one quantity that have kLeastPixels.
std::vector<ResidualBin> residual_bins(std::size_t number,
                                       const std::vector<ErrorRow>& rows,
                                       const DetectionModel& model) {
  const BinnedQuantity& quantity = kBinned[number];
  const double width = (quantity.high - quantity.low) / quantity.count;
  std::vector<ResidualBin> bins;
  for (int i = 0; i < quantity.count; ++i) {
    bins.push_back({.quantity = quantity.name, .at = quantity.low + (i + 0.5) * width});
  }
  for (const ErrorRow& row : rows) {
    const double bin_at = (binned_values(row.pixel)[number] - quantity.low) / width;
    if (!(bin_at >= 0) || bin_at >= quantity.count) continue;
    ResidualBin& bin = bins[static_cast<std::size_t>(bin_at)];
    const double before_mm = static_cast<double>(row.error_m) / kMillimetre;
    ++bin.pixels;
    bin.before_mm += before_mm;
    bin.after_mm += before_mm - model.bias_m(row.pixel) / kMillimetre;
  }
  std::erase_if(bins, [](const ResidualBin& bin) { return bin.pixels < kLeastPixels; });
  for (ResidualBin& bin : bins) {
    bin.before_mm /= bin.pixels;
    bin.after_mm /= bin.pixels;
  }
  return bins;
}

/// Sets the errors of a scan that has its picture and its terms.
void compare(const Truth& truth, Scan& scan) {
  scan.error_m = {scan.terms.width, scan.terms.height, kNoSurface};
  int both = 0, other = 0;
  for (std::size_t i = 0; i < truth.depth_m.pixels.size(); ++i) {
    const float error = scan.scored.picture.depth_m.pixels[i] - truth.depth_m.pixels[i];
    if (!std::isfinite(error) || !scan.terms.pixels[i].measured) continue;
    ++both;
    const bool same = std::abs(static_cast<double>(error)) <= kOtherSurface_m;
    other += !same;
    if (same) scan.error_m.pixels[i] = error;
  }
  scan.other_surface_percent = both > 0 ? 100.0 * other / both : 0;
}

/// The scans of one set.
class SetScans {
 public:
  SetScans(const ScanSet& set, PhantomCache& cache, render::GlContext& context)
      : evaluator_(small(set.scene), context, cache),
        options_(evaluator_.scene().render()),
        meter_(evaluator_.scene().plan(), evaluator_.scene().simulation(), options_) {}

  render::Camera camera() const { return render::make_camera(options_); }

  Scan scan(sim::Rung rung, std::uint64_t seed) {
    evaluator_.scan(rung, seed);
    Scan scan;
    scan.scored = evaluator_.evaluate(options_, kDepthsAlone);
    scan.terms = meter_.measure(scan.scored.picture.filtered_depth_m, evaluator_.sticks());
    compare(evaluator_.truth(options_).truth, scan);
    return scan;
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

  Evaluator evaluator_;
  render::RenderOptions options_;
  TermMeter meter_;
};

void add_rows(const Scan& scan,
              const render::Camera& camera,
              int set,
              int stride,
              std::vector<ErrorRow>& rows) {
  for (int row = 0; row < scan.error_m.height; row += stride) {
    for (int column = 0; column < scan.error_m.width; column += stride) {
      const float error = scan.error_m.at(column, row);
      if (!std::isfinite(error)) continue;
      // Pixels at one position have one block for all seeds: their residuals are correlated.
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

/// Judges the scans of a held-out set on one rung, and adds their pixels to `all`.
void judge_set(const ScanSet& set,
               sim::Rung rung,
               const std::vector<Scan>& scans,
               SetScans& source,
               std::vector<ErrorRow>& all,
               ModelStudy& study) {
  std::vector<ErrorRow> rows;
  PictureEffect found, corrected;
  const double share = 1.0 / static_cast<double>(scans.size());
  double other = 0;
  for (const Scan& scan : scans) {
    add_rows(scan, source.camera(), 0, 1, rows);
    other += share * scan.other_surface_percent;
    add_effect(scan.scored.measures, share, found);
    const auto less = less_bias(scan.scored.picture, scan.terms, study.model);
    add_effect(source.measure(less), share, corrected);
  }
  Judgement judgement = judge(set.name, set.of, rows, study.model);
  judgement.rung = sim::to_string(rung);
  judgement.other_surface_percent = other;
  judgement.reproducible_variance = reproducible_variance(scans);
  judgement.found = found;
  judgement.corrected = corrected;
  study.held_out.push_back(judgement);
  all.insert(all.end(), rows.begin(), rows.end());
}

void train(const std::vector<ScanSet>& sets,
           PhantomCache& cache,
           render::GlContext& context,
           PartCount& parts,
           ModelStudy& study) {
  std::vector<ErrorRow> rows;
  double other = 0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    SetScans source(sets[i], cache, context);
    for (const sim::Rung rung : rungs_of_fit(sets[i].scene)) {
      for (const std::uint64_t seed : sets[i].seeds) {
        const Scan scan = source.scan(rung, seed);
        add_rows(scan, source.camera(), static_cast<int>(i), kTrainingStride, rows);
        other += scan.other_surface_percent;
        ++study.training_scans;
        parts.finish_one();
      }
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
  std::vector<ErrorRow> all;
  for (const ScanSet& set : held_out) {
    SetScans source(set, cache, context);
    for (const sim::Rung rung : rungs_of_fit(set.scene)) {
      std::vector<Scan> scans;
      for (const std::uint64_t seed : set.seeds) {
        scans.push_back(source.scan(rung, seed));
        parts.finish_one();
      }
      judge_set(set, rung, scans, source, all, study);
      if (rung != rungs_of_fit(set.scene).front()) continue;
      study.pictures.push_back(residual_picture(set.name, scans.front(), study.model));
    }
  }
  study.all_held_out = judge("all held out", "", all, study.model);
  study.all_held_out.reproducible_variance = kNone;
  for (std::size_t i = 0; i < kBinned.size(); ++i) {
    const auto bins = residual_bins(i, all, study.model);
    study.bins.insert(study.bins.end(), bins.begin(), bins.end());
  }
  return study;
}

}  // namespace wobblebench::bench
