#include "bench/studies/validate/repeatability.h"

#include <algorithm>
#include <bit>
#include <span>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "hw/wire/crc32c.h"

namespace wobblebench::bench {

namespace {

/// A still phantom and its acquisition.
struct ScanSetup {
  phantoms::PlacedPhantom subject;
  hw::AcquisitionOptions acquisition;
};

/// So few sticks and scatterers that the sum over elements takes seconds.
ScanSetup small_scene() {
  hw::AcquisitionOptions acquisition{.depth_m = 0.08,
                                     .sector_rad = 4 * kDegree,
                                     .sticks_per_frame = 4,
                                     .samples_per_stick = 256,
                                     .frames_per_volume = 1};
  return {phantoms::still_at(block({6e-3, 6e-3, 1e-3}, 0.5e-3), {0, 0, 0.113}), acquisition};
}

ScanSetup whole_scene(const RepeatabilityInputs& inputs) {
  const auto phantom = phantoms::make_phantom({.name = inputs.phantom, .voxel_m = inputs.voxel_m});
  return {phantoms::still_at(phantom, phantom.suggested_position_m()), inputs.acquisition};
}

phantoms::Motion motion_of(const phantoms::Phantom& phantom, bool moving) {
  if (!moving) return {};
  phantoms::MotionOptions options;
  options.velocity_m_s = {4e-3, -3e-3, 8e-3};
  options.breath_amplitude_m = 3e-3;
  if (phantom.joint()) options.head_turn_rad = 10 * kDegree;
  return {options, phantom.joint()};
}

sim::VolumeSamples run(
    const ScanSetup& setup, sim::Rung rung, bool moving, std::uint64_t seed, int threads) {
  sim::SimulationOptions options;
  options.fidelity = rung;
  options.seed = seed;
  options.threads = threads;
  options.output = hw::SampleScale::linear_envelope;  // nothing is clipped
  auto subject = setup.subject;
  subject.motion = motion_of(subject.phantom, moving);
  return sim::ProbeSimulator(subject, {{}, setup.acquisition}, options).volume(0);
}

long differing(const sim::VolumeSamples& a, const sim::VolumeSamples& b) {
  long count = static_cast<long>(std::max(a.size(), b.size()) - std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    count += std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]);
  }
  return count;
}

RepeatabilityResult measure(const ScanSetup& setup,
                            sim::Rung rung,
                            bool moving,
                            const RepeatabilityInputs& inputs) {
  RepeatabilityResult result{rung, moving};
  const auto first = run(setup, rung, moving, inputs.seed, inputs.threads.front());
  std::vector<int> others(inputs.threads.begin() + 1, inputs.threads.end());
  others.push_back(inputs.threads.back());  // a second run
  for (const int threads : others) {
    result.differing += differing(first, run(setup, rung, moving, inputs.seed, threads));
  }
  result.runs = static_cast<int>(others.size()) + 1;
  result.samples = static_cast<long>(first.size());
  const auto other = run(setup, rung, moving, inputs.seed + 1, inputs.threads.back());
  result.other_seed =
      static_cast<double>(differing(first, other)) / static_cast<double>(first.size());
  result.crc32c = hw::crc32c(std::as_bytes(std::span(first)));
  return result;
}

}  // namespace

std::vector<RepeatabilityResult> measure_repeatability(const RepeatabilityInputs& inputs) {
  const ScanSetup whole = whole_scene(inputs), small = small_scene();
  std::vector<RepeatabilityResult> results;
  for (const sim::Rung rung :
       {sim::Rung::geometry, sim::Rung::field, sim::Rung::scatterers, sim::Rung::reference}) {
    const ScanSetup& setup = rung == sim::Rung::reference ? small : whole;
    for (const bool moving : {false, true}) results.push_back(measure(setup, rung, moving, inputs));
  }
  return results;
}

RepeatabilityResult measure_repeatability(sim::Rung rung,
                                          bool moving,
                                          const RepeatabilityInputs& inputs) {
  const ScanSetup setup = rung == sim::Rung::reference ? small_scene() : whole_scene(inputs);
  return measure(setup, rung, moving, inputs);
}

}  // namespace wobblebench::bench
