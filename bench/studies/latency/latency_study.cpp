#include "bench/studies/latency/latency_study.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "base/duration.h"
#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "bench/pipeline/stream/stream.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

constexpr int kDraws = 200;  ///< of virtual streams, for one prediction
/// Streams of each setting, all settings in turn: a machine whose speed drifts within minutes
/// is as fast for those that the model is made on as for those that it is held against.
constexpr int kRounds = 3;
constexpr double kStalls_ms[] = {10, 100, 500};
constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

/// The first volumes warm caches up; they are left out of records and spans.
constexpr std::uint32_t kWarmUpVolumes = 2;

struct WallSetting {
  Scene scene;  ///< volumes and all
  QueueOptions queue;
  std::string faults;  ///< as --board takes them; empty: none
};

std::string board_text(const WallSetting& setting) {
  const std::string board = "sim,pace=realtime";
  return setting.faults.empty() ? board : board + ",faults=" + setting.faults;
}

/// Streams all volumes through the board, the queue and the renderer; pictures go nowhere. Throws
/// what they throw, and std::runtime_error where the stream breaks off.
StreamResult run_wall_stream(const WallSetting& setting,
                             render::GlContext& context,
                             PhantomCache& cache) {
  BoardConnection connection(parse_board(board_text(setting)));
  const ResolvedScene scene = resolve_scene(setting.scene, cache.phantom(setting.scene.phantom));
  render::Renderer renderer(context, scene.plan(), scene.render());
  renderer.compile();
  const StreamSource source = connection.connect(scene, kept_maps(cache.tissue_maps()));
  GlStreamRenderer passes(renderer);
  StreamResult result = run_stream(
      source, passes, {.queue = setting.queue}, [](const ShownPicture&) {}, [] { return false; });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  std::erase_if(result.records,
                [](const PictureTimes& times) { return times.volume < kWarmUpVolumes; });
  std::erase_if(result.spans, [](const StreamSpan& span) { return span.volume < kWarmUpVolumes; });
  return result;
}

struct Variant {
  std::string name;
  std::function<void(hw::AcquisitionOptions&)> change;
};

std::vector<Variant> variants() {
  return {{"the scene", [](auto&) {}},
          {"half the frames",
           [](auto& of) { of.frames_per_volume = std::max(of.frames_per_volume / 2, 2); }},
          {"3/4 of the frames",
           [](auto& of) { of.frames_per_volume = std::max(of.frames_per_volume * 3 / 4, 2); }},
          {"3/2 of the lines", [](auto& of) { of.sticks_per_frame = of.sticks_per_frame * 3 / 2; }},
          {"3/4 of the depth", [](auto& of) { of.depth_m *= 0.75; }}};
}

/// Those that service times are measured at.
constexpr std::size_t kCalibrations = 2;

/// An age and when it was reached, seconds after the stream's first stick was fired.
struct Aged {
  double ready_s, age_s;
};

std::vector<Aged> wall_ages(const StreamResult& result, const hw::AcquisitionPlan& plan) {
  std::vector<Aged> ages;
  for (const PictureTimes& times : result.records) {
    const auto fired = plan.stick_time(plan.first_sequence(times.volume)).time_since_epoch();
    const auto epoch = *times.first.fired - fired;
    ages.push_back({to_seconds(times.ready - epoch), to_seconds(times.ready - *times.last.fired)});
  }
  return ages;
}

std::vector<Aged> wall_ages(const std::vector<StreamResult>& rounds,
                            const hw::AcquisitionPlan& plan) {
  std::vector<Aged> ages;
  for (const StreamResult& round : rounds) {
    const auto of_round = wall_ages(round, plan);
    ages.insert(ages.end(), of_round.begin(), of_round.end());
  }
  return ages;
}

std::vector<Aged> virtual_ages(const VirtualResult& result) {
  std::vector<Aged> ages;
  for (const VirtualPicture& picture : result.pictures) {
    if (picture.volume >= kWarmUpVolumes) ages.push_back({picture.ready_s, picture.age_newest_s()});
  }
  return ages;
}

Percentiles age_percentiles(const std::vector<Aged>& ages) {
  std::vector<double> values_ms;
  for (const Aged& aged : ages) values_ms.push_back(1e3 * aged.age_s);
  return percentiles_of(values_ms);
}

double rate_of(const std::vector<Aged>& ages) {
  if (ages.size() < 2) return kNever;
  return static_cast<double>(ages.size() - 1) / (ages.back().ready_s - ages.front().ready_s);
}

/// Mean over the rounds.
double wall_rate(const std::vector<StreamResult>& rounds, const hw::AcquisitionPlan& plan) {
  double sum = 0;
  for (const StreamResult& round : rounds) sum += rate_of(wall_ages(round, plan));
  return sum / static_cast<double>(rounds.size());
}

struct Recovery {
  double after_ms, worst_ms;
};

Recovery recovery_of(const std::vector<Aged>& ages, double stall_at_s, double stall_end_s) {
  std::vector<double> before;
  for (const Aged& aged : ages) {
    if (aged.ready_s < stall_at_s) before.push_back(aged.age_s);
  }
  const double usual = quantile(before, 0.9);
  Recovery recovery{kNever, 0};
  for (const Aged& aged : ages) {
    if (aged.ready_s < stall_at_s) continue;
    recovery.worst_ms = std::max(recovery.worst_ms, 1e3 * aged.age_s);
    const bool is_back = aged.ready_s >= stall_end_s && aged.age_s <= usual;
    if (is_back && std::isnan(recovery.after_ms)) {
      recovery.after_ms = 1e3 * (aged.ready_s - stall_end_s);
    }
  }
  return recovery;
}

class Study {
 public:
  Study(const Scene& scene,
        int volumes,
        StreamPolicy policy,
        const std::vector<KnownTimes>& known,
        render::GlContext& context,
        PhantomCache& cache,
        const PartDone& done)
      : scene_(scene),
        known_(known),
        context_(context),
        cache_(cache),
        parts_(kRounds * variants().size() + std::size(kStalls_ms) + 1, done) {
    scene_.acquisition.volumes = volumes;
    result_.volumes = volumes;
    result_.rounds = kRounds;
    result_.policy = policy;
  }

  LatencyStudy run();

 private:
  Scene scene_of(const Variant& variant) const;
  VirtualSetting virtual_setting(const hw::AcquisitionPlan& plan) const;
  Prediction predict(const VirtualSetting& setting) const;
  WhatIf what_if(const KnownTimes& known) const;
  using Rounds = std::vector<StreamResult>;
  std::vector<Rounds> stream(const std::vector<Variant>& all);
  LatencyCheck check(const Variant& variant, const Rounds& wall, const Scene& scene) const;
  StallRecovery recover(double stall_ms);
  void add_curves(const KnownTimes& known);

  Scene scene_;
  const std::vector<KnownTimes>& known_;
  render::GlContext& context_;
  PhantomCache& cache_;
  PartCount parts_;
  sim::CardOptions card_;
  ServiceTimes times_[kCalibrations];
  int frames_[kCalibrations] = {};
  LatencyStudy result_;
};

Scene Study::scene_of(const Variant& variant) const {
  Scene scene = scene_;
  variant.change(scene.acquisition);
  static_cast<void>(scene.plan());  // throws for what it cannot be
  return scene;
}

VirtualSetting Study::virtual_setting(const hw::AcquisitionPlan& plan) const {
  return {.plan = plan,
          .card = card_,
          .times = KnownTimes{"", times_[0], frames_[0], times_[1], frames_[1]}.at(
              plan.acquisition().frames_per_volume),
          .queue = {.policy = result_.policy},
          .volumes = kRounds * result_.volumes};
}

Prediction Study::predict(const VirtualSetting& setting) const {
  std::vector<double> p50, p99, rate;
  VirtualSetting drawn = setting;
  for (int seed = 1; seed <= kDraws; ++seed) {
    drawn.seed = static_cast<std::uint64_t>(seed);
    const auto ages = virtual_ages(run_virtual_stream(drawn));
    const Percentiles percentiles = age_percentiles(ages);
    p50.push_back(percentiles.p50);
    p99.push_back(percentiles.p99);
    rate.push_back(rate_of(ages));
  }
  const auto of = [](const std::vector<double>& values) {
    return Drawn{quantile(values, 0.5), quantile(values, 0.025), quantile(values, 0.975)};
  };
  const int frames = setting.plan.acquisition().frames_per_volume;
  return {of(p50), of(p99), quantile(rate, 0.5), 1e3 * setting.times.renderer_s(frames)};
}

WhatIf Study::what_if(const KnownTimes& known) const {
  const auto plan = scene_.plan();
  VirtualSetting setting = virtual_setting(plan);
  setting.times = known.at(plan.acquisition().frames_per_volume);
  return {known.name, predict(setting)};
}

/// The rounds of each variant.
std::vector<Study::Rounds> Study::stream(const std::vector<Variant>& all) {
  std::vector<Rounds> walls(all.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Scene scene = scene_of(all[i]);
      walls[i].push_back(
          run_wall_stream({scene, {.policy = result_.policy}, ""}, context_, cache_));
      parts_.finish_one();
    }
  }
  return walls;
}

LatencyCheck Study::check(const Variant& variant, const Rounds& wall, const Scene& scene) const {
  const auto plan = scene.plan();
  const int frames = plan.acquisition().frames_per_volume;
  return {.name = variant.name,
          .calibrated_on = false,
          .sound_ms = to_milliseconds(plan.volume_duration()),
          .wall = age_percentiles(wall_ages(wall, plan)),
          .wall_volumes_per_s = wall_rate(wall, plan),
          .wall_renderer_ms = 1e3 * measured_times(wall, plan, card_).renderer_s(frames),
          .predicted = predict(virtual_setting(plan))};
}

/// The stall begins with the first stick of the volume in the middle.
StallRecovery Study::recover(double stall_ms) {
  const auto plan = scene_.plan();
  const int middle = result_.volumes / 2;
  const auto packet = static_cast<std::uint64_t>(middle) *
                      (static_cast<std::uint64_t>(plan.sticks_per_volume()) + 2);
  const std::string faults =
      "stall@" + std::to_string(packet) + "+stall_ms:" + std::to_string(static_cast<int>(stall_ms));
  const StreamResult wall =
      run_wall_stream({scene_, {.policy = result_.policy}, faults}, context_, cache_);
  const auto first = plan.first_sequence(static_cast<std::uint32_t>(middle));
  const double at_s = 1e-3 * to_milliseconds(plan.stick_time(first).time_since_epoch());
  const double end_s = at_s + 1e-3 * stall_ms;
  VirtualSetting setting = virtual_setting(plan);
  setting.volumes = result_.volumes;
  setting.stall = Stall{at_s, 1e-3 * stall_ms};
  const Recovery measured = recovery_of(wall_ages(wall, plan), at_s, end_s);
  const Recovery predicted = recovery_of(virtual_ages(run_virtual_stream(setting)), at_s, end_s);
  return {.stall_ms = stall_ms,
          .wall_ms = measured.after_ms,
          .predicted_ms = predicted.after_ms,
          .wall_worst_ms = measured.worst_ms,
          .predicted_worst_ms = predicted.worst_ms};
}

void Study::add_curves(const KnownTimes& known) {
  const auto curves = crossover_curves(known, scene_.plan());
  result_.crossovers.insert(result_.crossovers.end(), curves.begin(), curves.end());
}

LatencyStudy Study::run() {
  const auto all = variants();
  const std::vector<Rounds> walls = stream(all);
  for (std::size_t i = 0; i < kCalibrations; ++i) {
    const Scene scene = scene_of(all[i]);
    times_[i] = measured_times(walls[i], scene.plan(), card_);
    frames_[i] = scene.acquisition.frames_per_volume;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    result_.checks.push_back(check(all[i], walls[i], scene_of(all[i])));
    result_.checks.back().calibrated_on = i < kCalibrations;
  }
  const auto plan = scene_.plan();
  result_.times = times_[0];
  result_.summary = summarize(walls[0].front(),
                              to_milliseconds(plan.volume_duration()),
                              /*simulator_ms=*/0,
                              card_delays(plan, card_));
  for (const double stall_ms : kStalls_ms) {
    result_.stalls.push_back(recover(stall_ms));
    parts_.finish_one();
  }
  add_curves({"this machine", times_[0], frames_[0], times_[1], frames_[1]});
  add_curves(paper_times());
  for (const KnownTimes& known : known_) {
    add_curves(known);
    result_.what_ifs.push_back(what_if(known));
  }
  result_.line_rates = first_losses(virtual_setting(plan));
  result_.scene_line_rate_per_s = 1 / plan.stick_period_s();
  parts_.finish_one();
  return std::move(result_);
}

/// Where frames * lines * period = renderer_s(frames), which grows linearly.
double least_frames(const KnownTimes& known, double frame_s) {
  const double at_one = known.one.renderer_s(known.frames_of_one);
  const double slope = (known.other.renderer_s(known.frames_of_other) - at_one) /
                       (known.frames_of_other - known.frames_of_one);
  const double fixed_s = at_one - slope * known.frames_of_one;
  if (slope >= frame_s) return kNever;
  return std::max(fixed_s / (frame_s - slope), 0.0);
}

}  // namespace

std::vector<CrossoverCurve> crossover_curves(const KnownTimes& known,
                                             const hw::AcquisitionPlan& plan) {
  std::vector<CrossoverCurve> curves;
  for (const int lines : {32, 64, 128}) {
    CrossoverCurve curve{.times = known.name, .lines = lines, .depth_mm = {}, .frames = {}};
    for (int tens = 4; tens <= 24; ++tens) {
      const double depth_mm = 10.0 * tens;
      hw::AcquisitionOptions of = plan.acquisition();
      of.depth_m = depth_mm * kMillimetre;
      const double frame_s = lines * hw::AcquisitionPlan(plan.probe(), of).stick_period_s();
      curve.depth_mm.push_back(depth_mm);
      curve.frames.push_back(least_frames(known, frame_s));
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

LatencyStudy study_latency(const Scene& scene,
                           int volumes,
                           StreamPolicy policy,
                           const std::vector<KnownTimes>& known,
                           render::GlContext& context,
                           PhantomCache& cache,
                           const PartDone& done) {
  return Study(scene, volumes, policy, known, context, cache, done).run();
}

}  // namespace wobblebench::bench
