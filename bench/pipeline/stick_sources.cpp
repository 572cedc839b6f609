#include "bench/pipeline/stick_sources.h"

#include <utility>

#include "base/hash.h"
#include "bench/scene/resolved_scene.h"
#include "bench/scene/subject_hash.h"

namespace wobblebench::bench {

SimulatedScan simulated_scan(const Scene& given, PhantomCache cache) {
  const ResolvedScene scene = resolve_scene(given, cache.phantom(given.phantom));
  return {{scene.subject().value(), scene.plan(), scene.simulation(), cache.tissue_maps()},
          scene.options()};
}

MakeSticks simulated_sticks(SimulatedScan scan, std::shared_ptr<IqFile> iq) {
  const hw::SubjectHash subject = subject_hash(scan.scene);
  return [scan = std::move(scan), iq = std::move(iq), subject] {
    sim::IqSink write;
    if (iq) write = [iq](const hw::StickIndex& index, auto samples) { iq->write(index, samples); };
    return sim::stick_source(scan.simulator, subject, write);
  };
}

float synthetic_sample(std::uint64_t seed, std::uint64_t sequence, std::uint32_t sample) {
  // One multiplication a sample: cheap, and enough for sticks to differ.
  const std::uint64_t stick = (seed * kGoldenGamma + sequence + 1) * 0xBF58476D1CE4E5B9;
  const std::uint64_t bits = (stick ^ (stick >> 29)) * (2 * std::uint64_t{sample} + 1);
  return static_cast<float>(bits >> 40) * 0x1p-24F;
}

sim::StickSource synthetic_sticks(const hw::AcquisitionPlan& plan, std::uint64_t seed) {
  return {plan, hw::SampleScale::log_compressed, [plan, seed](std::uint64_t first) {
            const auto samples = static_cast<std::uint32_t>(plan.acquisition().samples_per_stick);
            const auto lines = static_cast<std::uint64_t>(plan.acquisition().sticks_per_frame);
            std::vector<float> frame;
            frame.reserve(lines * samples);
            for (std::uint64_t sequence = first; sequence < first + lines; ++sequence) {
              for (std::uint32_t k = 0; k < samples; ++k) {
                frame.push_back(synthetic_sample(seed, sequence, k));
              }
            }
            return frame;
          }};
}

}  // namespace wobblebench::bench
