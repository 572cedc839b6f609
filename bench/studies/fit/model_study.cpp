#include "bench/studies/fit/model_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bench/evaluation/registration.h"
#include "bench/studies/validate/seeds.h"

namespace wobblebench::bench {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kHeldOutSeeds = 2;
constexpr std::uint64_t kHeldOutOffset = 200'000;
/// Training takes every second pixel each way: neighbours say the same.
constexpr int kTrainingStride = 2;
constexpr double kTrainingView_rad = -20 * kDegree;
constexpr double kHeldOutView_rad = 25 * kDegree;

/// One scene at one pose, with its seeds.
struct ScanSet {
  std::string name;
  std::string of;
  Scene scene;
  std::vector<std::uint64_t> seeds;
};

/// One scan's errors, and what is known of its pixels.
struct ScannedErrors {
  Image<float> error_m;  ///< NaN: no error
  Image<PixelTerms> terms;
  int set = 0;
  double other_surface_percent = 0;
};

Scene turned(Scene scene, double about_x_rad, double about_y_rad) {
  scene.placement.rotation_rad += glm::dvec3(about_x_rad, about_y_rad, 0);
  return scene;
}

ScanSet training_variant(const std::string& name, Scene scene, std::vector<std::uint64_t> seeds) {
  return {name, "training", std::move(scene), std::move(seeds)};
}

std::vector<ScanSet> training_sets(const Scene& scene, int count) {
  const auto seeds = seeds_from(scene.simulation.seed, count);
  std::vector<ScanSet> sets = {
      training_variant("pose 1", scene, seeds),
      training_variant("pose 2", turned(scene, 0, 12 * kDegree), seeds),
      training_variant("pose 3", turned(scene, -10 * kDegree, -6 * kDegree), seeds)};
  const std::vector<std::uint64_t> few(seeds.begin(), seeds.begin() + (count + 1) / 2);
  auto buffer = scene, frames = scene, sticks = scene;
  Scene view = scene;
  view.render.view.yaw_rad += kTrainingView_rad;
  auto& n = buffer.render.ray_casting.buffer_length;
  n = n <= 32 ? 2 * n : n / 4 * 2;
  frames.acquisition.frames_per_volume = std::max(2, scene.acquisition.frames_per_volume / 2);
  sticks.acquisition.sticks_per_frame = std::max(2, scene.acquisition.sticks_per_frame / 2);
  sets.push_back(training_variant("view", view, few));
  sets.push_back(training_variant("buffer", buffer, few));
  sets.push_back(training_variant("half the frames", frames, few));
  sets.push_back(training_variant("half the sticks", sticks, few));
  return sets;
}

std::vector<ScanSet> held_out_sets(const Scene& scene) {
  const auto seeds = seeds_from(scene.simulation.seed + kHeldOutOffset, kHeldOutSeeds);
  Scene view = scene;
  view.render.view.yaw_rad += kHeldOutView_rad;
  return {{"seeds", "seeds", scene, seeds},
          {"pose", "seeds and pose", turned(scene, 8 * kDegree, -12 * kDegree), seeds},
          {"view", "seeds and view", view, seeds}};
}

/// Phantoms that the model never saw.
std::vector<ScanSet> other_phantoms(const Scene& scene) {
  std::vector<ScanSet> sets;
  for (const char* name : {"sphere", "plane", "steps"}) {
    if (scene.phantom.name == name) continue;
    Scene other = scene;
    other.phantom = {.name = name};
    if (other.phantom.name == "plane") other.phantom.tilt_y_rad = 20 * kDegree;
    other.placement = {};
    for (const char* key : {"placement.position_mm",
                            "placement.rotation_deg",
                            "render.volume_of_interest.center_mm",
                            "render.volume_of_interest.size_mm"}) {
      other.given.erase(key);
    }
    const auto seeds = seeds_from(scene.simulation.seed + kHeldOutOffset, kHeldOutSeeds);
    sets.push_back({name, "seeds and phantom", std::move(other), seeds});
  }
  return sets;
}

ScannedErrors compare(const render::Picture& picture,
                      const Truth& truth,
                      Image<PixelTerms> terms,
                      int set) {
  ScannedErrors result{{terms.width, terms.height, kNoSurface}, std::move(terms), set, 0};
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

/// Scans and renders all seeds of a set.
std::vector<ScannedErrors> scan_set(const ScanSet& set,
                                    int number,
                                    const LoadedPhantom& phantom,
                                    render::GlContext& context,
                                    PartCount& parts) {
  const Scene scene = fit_scene(set.scene, phantom.phantom);
  const auto subject = scene.place(phantom.phantom);
  const auto plan = scene.plan();
  const Truth truth = trace_truth(subject, plan, render::make_view(scene.render));
  const TermMeter meter(plan, scene.simulation, scene.render);
  render::Renderer renderer(context, plan, scene.render);
  std::vector<ScannedErrors> scans;
  for (const std::uint64_t seed : set.seeds) {
    const auto volume = scan_with_seed(scene, seed, subject, phantom.maps);
    const auto picture = render_frames(renderer, volume);
    scans.push_back(
        compare(picture, truth, meter.measure(picture.filtered_depth_m, volume), number));
    parts.finish_one();
  }
  return scans;
}

void add_rows(const ScannedErrors& scan,
              const render::Camera& camera,
              int stride,
              std::vector<ErrorRow>& rows) {
  for (int row = 0; row < scan.error_m.height; row += stride) {
    for (int column = 0; column < scan.error_m.width; column += stride) {
      const float error = scan.error_m.at(column, row);
      if (!std::isfinite(error)) continue;
      // One block for all seeds at a place: what the model leaves there is the same in each.
      const std::int64_t block = error_block(camera, column, row) + (std::int64_t{scan.set} << 48);
      rows.push_back({scan.terms.at(column, row), error, block});
    }
  }
}

double reproducible_variance(const std::vector<ScannedErrors>& scans) {
  if (scans.size() < 2) return kNone;
  const auto &a = scans[0].error_m.pixels, &b = scans[1].error_m.pixels;
  double n = 0, sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
    const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    n += 1, sa += x, sb += y, aa += x * x, bb += y * y, ab += x * y;
  }
  const double scale = std::sqrt((aa - sa * sa / n) * (bb - sb * sb / n));
  return scale > 0 ? (ab - sa * sb / n) / scale : kNone;
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
                                 const ScannedErrors& scan,
                                 const DetectionModel& model) {
  ResidualPicture result{name, scan.error_m, scan.error_m, scan.error_m};
  for (std::size_t i = 0; i < scan.error_m.pixels.size(); ++i) {
    if (!std::isfinite(scan.error_m.pixels[i])) continue;
    result.bias_m.pixels[i] = static_cast<float>(model.bias_m(scan.terms.pixels[i]));
    result.left_m.pixels[i] = scan.error_m.pixels[i] - result.bias_m.pixels[i];
  }
  return result;
}

/// Sums of errors in bins of equal width.
class Bins {
 public:
  Bins(std::string quantity, double low, double high, int count)
      : quantity_(std::move(quantity)), low_(low), width_((high - low) / count) {
    bins_.resize(static_cast<std::size_t>(count));
  }
  void add(double at, double before_mm, double after_mm) {
    const double place = (at - low_) / width_;
    if (!(place >= 0) || place >= static_cast<double>(bins_.size())) return;
    ResidualBin& bin = bins_[static_cast<std::size_t>(place)];
    ++bin.pixels;
    bin.before_mm += before_mm;
    bin.after_mm += after_mm;
  }
  void finish(std::vector<ResidualBin>& all) {
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      ResidualBin bin = bins_[i];
      if (bin.pixels < kLeastPixels) continue;
      bin.quantity = quantity_;
      bin.at = low_ + (static_cast<double>(i) + 0.5) * width_;
      bin.before_mm /= bin.pixels;
      bin.after_mm /= bin.pixels;
      all.push_back(bin);
    }
  }

 private:
  static constexpr int kLeastPixels = 50;
  std::string quantity_;
  double low_, width_;
  std::vector<ResidualBin> bins_;
};

std::vector<ResidualBin> residual_bins(const std::vector<ErrorRow>& rows,
                                       const DetectionModel& model) {
  Bins incidence("incidence_deg", 0, 75, 15), range("range_mm", 20, 160, 14),
      contrast("contrast", 0, 0.45, 9);
  for (const ErrorRow& row : rows) {
    const double before = static_cast<double>(row.error_m) / kMillimetre;
    const double after = before - model.bias_m(row.pixel) / kMillimetre;
    incidence.add(static_cast<double>(row.pixel.incidence_rad) / kDegree, before, after);
    range.add(static_cast<double>(row.pixel.x[kDepthTerm]) + 75, before, after);
    contrast.add(static_cast<double>(row.pixel.x[kContrastTerm]), before, after);
  }
  std::vector<ResidualBin> all;
  for (Bins* bins : {&incidence, &range, &contrast}) bins->finish(all);
  return all;
}

std::size_t scans_in(const std::vector<ScanSet>& sets) {
  std::size_t count = 0;
  for (const ScanSet& set : sets) count += set.seeds.size();
  return count;
}

/// Collects the held-out sets, one after the other.
struct HeldOut {
  ModelStudy& study;
  std::vector<ErrorRow> all;

  void add(const ScanSet& set, const std::vector<ScannedErrors>& scans) {
    const render::Camera camera = render::make_camera(set.scene.render);
    std::vector<ErrorRow> rows;
    double other = 0;
    for (const ScannedErrors& scan : scans) {
      add_rows(scan, camera, 1, rows);
      other += scan.other_surface_percent / static_cast<double>(scans.size());
    }
    Judgement judgement = judge(set.name, set.of, rows, study.model);
    judgement.other_surface_percent = other;
    judgement.reproducible_variance = reproducible_variance(scans);
    study.held_out.push_back(judgement);
    study.pictures.push_back(residual_picture(set.name, scans.front(), study.model));
    all.insert(all.end(), rows.begin(), rows.end());
  }
};

}  // namespace

ModelStudy study_detection_model(const Scene& scene,
                                 const LoadedPhantom& phantom,
                                 int seeds,
                                 PhantomCache& cache,
                                 render::GlContext& context,
                                 const PartDone& done) {
  const auto training = training_sets(scene, seeds);
  const auto held_out = held_out_sets(scene), others = other_phantoms(scene);
  PartCount parts(scans_in(training) + scans_in(held_out) + scans_in(others), done);
  ModelStudy study;
  study.step_mm = render::step_m(fit_scene(scene, phantom.phantom).render) / kMillimetre;
  std::vector<ErrorRow> rows;
  double other = 0;
  for (std::size_t i = 0; i < training.size(); ++i) {
    const auto camera = render::make_camera(fit_scene(training[i].scene, phantom.phantom).render);
    for (const auto& scan : scan_set(training[i], static_cast<int>(i), phantom, context, parts)) {
      add_rows(scan, camera, kTrainingStride, rows);
      other += scan.other_surface_percent;
      ++study.training_scans;
    }
  }
  study.model = fit_detection_model(rows);
  study.training = judge("training", "", rows, study.model);
  study.training.other_surface_percent = other / study.training_scans;
  HeldOut judged{study, {}};
  for (const ScanSet& set : held_out) judged.add(set, scan_set(set, 0, phantom, context, parts));
  for (const ScanSet& set : others) {
    const LoadedPhantom loaded = load_phantom(set.scene.phantom, cache);
    judged.add(set, scan_set(set, 0, loaded, context, parts));
  }
  study.all_held_out = judge("all held out", "", judged.all, study.model);
  study.bins = residual_bins(judged.all, study.model);
  return study;
}

}  // namespace wobblebench::bench
