#include "bench/studies/validate/repeatability.h"

#include <algorithm>
#include <bit>
#include <span>
#include <sstream>

#include "bench/studies/validate/common/scan.h"
#include "hw/wire/crc32c.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

/// A still phantom and its acquisition.
struct ScanSetup {
  phantoms::PlacedPhantom subject;
  hw::AcquisitionOptions acquisition;
};

/// Few sticks and scatterers, so that the sum over elements takes seconds.
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
  for (const sim::Rung rung : inputs.rungs) {
    const ScanSetup& setup = rung == sim::Rung::reference ? small : whole;
    for (const bool moving : {false, true}) results.push_back(measure(setup, rung, moving, inputs));
  }
  return results;
}

namespace {

std::string hexadecimal(std::uint32_t value) {
  std::ostringstream text;
  text << std::hex << value;
  return text.str();
}

}  // namespace

StudyReport repeatability_report() {
  const RepeatabilityInputs inputs;
  StudyReport report;
  Table table{.name = "repeatability",
              .columns = {{"rung"},
                          {"phantom"},
                          {"samples"},
                          {"crc32c", "CRC-32C"},
                          {"changed_percent", "samples that another seed changes", "%", 4}}};
  for (const RepeatabilityResult& found : measure_repeatability(inputs)) {
    const sim::Rung rung = found.rung;
    const bool moving = found.moving, is_small = rung == sim::Rung::reference;
    const std::string state = moving ? "moving" : "still";
    const std::string name = "repeatability." + sim::to_string(rung) + "." + state;
    report.check(name)
        .at_most(static_cast<double>(found.differing), 0, "samples")
        .from("bytes of 1, 2 and 4 threads and of a second run are the same")
        .over(found.samples,
              "samples in each of " + std::to_string(found.runs) + " runs",
              {inputs.seed});
    // At least half of them: fluid may be below the range of values with any seed.
    const bool random = rung != sim::Rung::geometry;
    Check& other = report.check(name + ".other_seed");
    if (random) {
      other.at_least(found.other_seed, 0.5, "of the samples");
    } else {
      other.at_most(found.other_seed, 0, "of the samples");
    }
    other
        .from(random ? "another seed means other speckle and noise"
                     : "nothing in this rung is random")
        .over(found.samples, "samples", {inputs.seed, inputs.seed + 1});
    table.add({sim::to_string(rung),
               (is_small ? "block" : inputs.phantom) + ", " + state,
               found.samples,
               hexadecimal(found.crc32c),
               100 * found.other_seed});
    report.point(name,
                 {"seed", static_cast<double>(inputs.seed)},
                 {"share_changed_by_other_seed", found.other_seed});
  }
  report.text =
      "A coarse scan of the phantom, and for `reference` a few sticks of a small block: made anew "
      "by 1, 2 and 4 threads, by 4 once more, and with another seed. Linear output with the "
      "default noise, so that nothing hides below the display. Moving: on a path, breathing, and "
      "with its head turning.";
  report.tables = {table};
  return report;
}

}  // namespace wobblebench::bench
