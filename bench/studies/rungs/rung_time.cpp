#include "bench/studies/rungs/rung_time.h"

#include <chrono>
#include <memory>

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

}  // namespace wobblebench::bench
