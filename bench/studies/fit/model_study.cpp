#include "bench/studies/fit/model_study.h"

#include <cmath>
#include <utility>

#include "bench/evaluation/registration/registration.h"
#include "bench/studies/fit/scan_sets.h"

namespace wobblebench::bench {

namespace {

/// Training takes every second pixel each way: neighbours say the same.
constexpr int kTrainingStride = 2;

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
