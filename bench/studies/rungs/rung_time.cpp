#include "bench/studies/rungs/rung_comparison.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>

#include "base/duration.h"
#include "base/units.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

namespace {

using Clock = std::chrono::steady_clock;

/// About a millimetre per volume: all volumes of a study show the same part of the phantom.
phantoms::MotionOptions slow() {
  phantoms::MotionOptions options;
  options.velocity_m_s = {1e-3, -0.7e-3, 1.6e-3};
  return options;
}

double milliseconds_since(Clock::time_point begin) {
  return to_milliseconds(Clock::now() - begin);
}

double volume_ms(const sim::ProbeSimulator& simulator, std::uint32_t index) {
  const auto begin = Clock::now();
  const auto volume = simulator.volume(index);
  return milliseconds_since(begin);
}

/// Mean over kVolumesInARow consecutive volumes.
double moving_volume_ms(const sim::ProbeSimulator& simulator, int repeat) {
  double sum_ms = 0;
  for (int i = 0; i < kVolumesInARow; ++i) {
    sum_ms += volume_ms(simulator, static_cast<std::uint32_t>(repeat * kVolumesInARow + i));
  }
  return sum_ms / kVolumesInARow;
}

sim::ProbeSimulator simulator(const RungScene& scene,
                              sim::Rung rung,
                              const phantoms::Motion& motion) {
  auto options = scene.options;
  options.fidelity = rung;
  return {{scene.subject.phantom, scene.subject.placement, motion}, scene.plan, options};
}

/// One rung under measurement; the simulators of moving phantoms are kept for all repeats.
struct TimedRung {
  sim::Rung rung;
  std::unique_ptr<sim::ProbeSimulator> moving;
  std::unique_ptr<sim::ProbeSimulator> bending;
  std::vector<double> map_ms, once_ms, still_ms, first_ms, moving_ms, bending_ms;

  void measure(const RungScene& scene, int repeat, bool counted) {
    const auto still = simulator(scene, rung, {});
    const double first = volume_ms(still, 0), further = volume_ms(still, 1);
    const double path = moving_volume_ms(*moving, repeat);
    const double bend = moving_volume_ms(*bending, repeat);
    if (!counted) return;
    map_ms.push_back(still.map_ms());
    once_ms.push_back(still.once_ms());
    first_ms.push_back(still.once_ms() + first);
    still_ms.push_back(further);
    moving_ms.push_back(path);
    bending_ms.push_back(bend);
  }

  RungTime result() const {
    return {rung,
            spread_of(map_ms),
            spread_of(once_ms),
            spread_of(still_ms),
            spread_of(first_ms),
            spread_of(moving_ms),
            spread_of(bending_ms)};
  }
};

}  // namespace

phantoms::Motion slow_path() {
  return {slow(), {}};
}

phantoms::Motion bending(const phantoms::Phantom& phantom) {
  phantoms::MotionOptions options = slow();
  if (phantom.joint()) options.head_turn_rad = 10 * kDegree;
  return {options, phantom.joint()};
}

std::vector<RungTime> measure_times(const RungScene& scene,
                                    const std::vector<sim::Rung>& rungs,
                                    int repeats,
                                    const PartDone& done) {
  PartCount parts(rungs.size() * (static_cast<std::size_t>(repeats) + 1), done);
  std::vector<TimedRung> timed;
  for (const sim::Rung rung : rungs) {
    TimedRung one{rung, nullptr, nullptr, {}, {}, {}, {}, {}, {}};
    one.moving = std::make_unique<sim::ProbeSimulator>(simulator(scene, rung, slow_path()));
    one.bending = std::make_unique<sim::ProbeSimulator>(
        simulator(scene, rung, bending(scene.subject.phantom)));
    timed.push_back(std::move(one));
  }
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    for (TimedRung& one : timed) {
      one.measure(scene, repeat, repeat > 0);
      parts.finish_one();
    }
  }
  std::vector<RungTime> results;
  for (const TimedRung& one : timed) results.push_back(one.result());
  return results;
}

VolumeTime measure_volume(const RungScene& scene, sim::Rung rung, int repeats) {
  const auto moving = simulator(scene, rung, slow_path());
  std::vector<double> first_ms, moving_ms;
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    const auto still = simulator(scene, rung, {});
    const double first = still.once_ms() + volume_ms(still, 0);
    const double path = moving_volume_ms(moving, repeat);
    if (repeat == 0) continue;
    first_ms.push_back(first);
    moving_ms.push_back(path);
  }
  return {spread_of(first_ms), spread_of(moving_ms)};
}

namespace {

/// A block wider and deeper than the field.
const glm::dvec3 kHalf_m{0.14, 0.13, 0.11};
constexpr double kVoxel_m = 4e-3;  // flat faces are exact at any voxel size

RungScene scene_with(const phantoms::Phantom& body,
                     double front_mm,
                     const hw::AcquisitionOptions& acquisition,
                     const sim::SimulationOptions& options) {
  const hw::AcquisitionPlan plan({}, acquisition);
  const double middle_m = plan.probe().radius_m + front_mm * kMillimetre + kHalf_m.z;
  return {phantoms::still_at(body, {0, 0, middle_m}), plan, options};
}

/// Fraction of the samples of a volume that are tissue, by rung `geometry`.
double tissue_fraction(const RungScene& scene) {
  auto options = scene.options;
  options.fidelity = sim::Rung::geometry;
  const auto samples = sim::ProbeSimulator(scene.subject, scene.plan, options).volume(0);
  const auto shown = std::count_if(samples.begin(), samples.end(), [](float v) { return v > 0; });
  return static_cast<double>(shown) / static_cast<double>(samples.size());
}

std::size_t number_of_points(const std::vector<sim::Rung>& rungs, const GrowthInputs& inputs) {
  const std::size_t on_each_rung =
      inputs.sticks.size() + inputs.frames.size() + inputs.samples.size() + inputs.front_mm.size();
  return rungs.size() * on_each_rung + inputs.scatterers.size();
}

class Growth {
 public:
  Growth(const std::vector<sim::Rung>& rungs,
         const sim::SimulationOptions& options,
         const GrowthInputs& inputs,
         const PartDone& done)
      : rungs_(rungs),
        options_(options),
        inputs_(inputs),
        body_(block(kHalf_m, kVoxel_m)),
        parts_(number_of_points(rungs, inputs), done) {}

  void vary(const std::string& what,
            const std::vector<int>& sizes,
            int hw::AcquisitionOptions::*field) {
    for (const int size : sizes) {
      auto acquisition = inputs_.acquisition;
      acquisition.*field = size;
      add(what, size, scene_with(body_, inputs_.base_front_mm, acquisition, options_));
    }
  }
  void vary_scatterers() {
    for (const double number : inputs_.scatterers) {
      auto options = options_;
      options.scatterers_per_cell = number;
      const auto scene = scene_with(body_, inputs_.base_front_mm, inputs_.acquisition, options);
      measure("scatterers", number, scene, sim::Rung::scatterers);
    }
  }
  void vary_tissue() {
    for (const double front : inputs_.front_mm) {
      const auto scene = scene_with(body_, front, inputs_.acquisition, options_);
      add("tissue", tissue_fraction(scene), scene);
    }
  }
  std::vector<GrowthPoint> take() { return std::move(points_); }

 private:
  void add(const std::string& what, double size, const RungScene& scene) {
    for (const sim::Rung rung : rungs_) measure(what, size, scene, rung);
  }
  void measure(const std::string& what, double size, const RungScene& scene, sim::Rung rung) {
    points_.push_back({what, size, rung, measure_volume(scene, rung, inputs_.repeats)});
    parts_.finish_one();
  }

  const std::vector<sim::Rung>& rungs_;
  sim::SimulationOptions options_;
  const GrowthInputs& inputs_;
  phantoms::Phantom body_;
  PartCount parts_;
  std::vector<GrowthPoint> points_;
};

}  // namespace

std::vector<GrowthPoint> measure_growth(const std::vector<sim::Rung>& rungs,
                                        const sim::SimulationOptions& options,
                                        const GrowthInputs& inputs,
                                        const PartDone& done) {
  Growth growth(rungs, options, inputs, done);
  growth.vary("sticks", inputs.sticks, &hw::AcquisitionOptions::sticks_per_frame);
  growth.vary("frames", inputs.frames, &hw::AcquisitionOptions::frames_per_volume);
  growth.vary("samples", inputs.samples, &hw::AcquisitionOptions::samples_per_stick);
  growth.vary_scatterers();
  growth.vary_tissue();
  return growth.take();
}

namespace {

/// Of the line of least squares.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const auto mean = [](const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  const double mean_x = mean(x), mean_y = mean(y);
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  return xy / xx;
}

}  // namespace

double growth_exponent(const std::vector<GrowthPoint>& points,
                       const std::string& what,
                       sim::Rung rung,
                       Spread VolumeTime::*time) {
  std::vector<double> x, y;
  for (const GrowthPoint& point : points) {
    if (point.what != what || point.rung != rung) continue;
    x.push_back(std::log(point.size));
    y.push_back(std::log((point.time.*time).median));
  }
  return slope(x, y);
}

}  // namespace wobblebench::bench
