#include "sim/probe_simulator.h"

#include <algorithm>
#include <optional>

#include "base/parallel.h"
#include "hw/probe/clock.h"
#include "sim/echo/stick_echoes.h"
#include "sim/math/random.h"
#include "sim/receive/losses.h"

namespace wobblebench::sim {

namespace {

double milliseconds_since(hw::HostTime start) {
  return std::chrono::duration<double, std::milli>(hw::HostClock::now() - start).count();
}

std::span<float> stick_of(VolumeSamples& volume, int place, int samples) {
  const auto count = static_cast<std::size_t>(samples);
  return {volume.data() + static_cast<std::size_t>(place) * count, count};
}

}  // namespace

ProbeSimulator::ProbeSimulator(const phantoms::PlacedPhantom& subject,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options)
    : plan_(plan), options_(options) {
  check_options(options);
  fidelity_ = choose_fidelity(options, plan, !subject.motion.still());
  const auto begin = hw::HostClock::now();
  subject_ = {std::make_shared<const TissueMap>(
                  subject.phantom, StickEchoes::reach_m(plan, fidelity_.rung), options.threads),
              subject.phantom.materials(),
              subject.placement,
              subject.motion};
  map_ms_ = milliseconds_since(begin);
  const auto mapped = hw::HostClock::now();
  if (fidelity_.rung != Rung::geometry) prepare_echoes();
  once_ms_ = milliseconds_since(mapped);
}

void ProbeSimulator::prepare_echoes() {
  fresh_receiver_.emplace(plan_, options_, iq_oversampling(plan_));
  source_ = std::make_shared<StickEchoes>(subject_, plan_, options_, fidelity_.rung);
  same_in_each_volume_ =
      subject_.motion.still() && plan_.acquisition().motor != hw::MotorMode::alternating;
  if (!same_in_each_volume_) return;
  echoes_ = make_iq_field(plan_);
  parallel_ranges(plan_.sticks_per_volume(), options_.threads, [&](int first, int last) {
    auto worker = source_->make_worker();
    for (int place = first; place < last; ++place) {
      const auto index = plan_.index(static_cast<std::uint64_t>(place));
      source_->make(index,
                    worker,
                    echoes_.stick(static_cast<int>(index.frame), static_cast<int>(index.line)));
    }
  });
  source_.reset();
}

VolumeSamples ProbeSimulator::volume(std::uint32_t index) const {
  if (fidelity_.rung == Rung::geometry) return geometry_volume(index);
  const int samples = plan_.acquisition().samples_per_stick, sticks = plan_.sticks_per_volume();
  VolumeSamples result(static_cast<std::size_t>(sticks) * static_cast<std::size_t>(samples));
  const auto first_sequence =
      static_cast<std::uint64_t>(index) * static_cast<std::uint64_t>(sticks);
  parallel_ranges(sticks, options_.threads, [&](int first, int last) {
    Receiver receiver = *fresh_receiver_;
    std::optional<StickEchoes::Worker> worker;
    std::vector<std::complex<float>> made;
    if (!same_in_each_volume_) {
      worker = source_->make_worker();
      made.resize(static_cast<std::size_t>(source_->samples()));
    }
    for (int place = first; place < last; ++place) {
      const auto stick = plan_.index(first_sequence + static_cast<std::uint64_t>(place));
      std::span<const std::complex<float>> iq = made;
      if (worker) {
        source_->make(stick, *worker, made);
      } else {
        iq = echoes_.stick(static_cast<int>(stick.frame), static_cast<int>(stick.line));
      }
      const auto noise_key =
          random_key(options_.seed, RandomStream::noise, index, static_cast<std::uint64_t>(place));
      receiver.detect(iq, noise_key, stick_of(result, place, samples));
    }
  });
  return result;
}

VolumeSamples ProbeSimulator::geometry_volume(std::uint32_t index) const {
  const int samples = plan_.acquisition().samples_per_stick, sticks = plan_.sticks_per_volume();
  std::vector<float> shown;
  for (const auto& material : subject_.materials) {
    const double mean = amplitude_of_db(material.backscatter_db);
    shown.push_back(options_.output == hw::SampleScale::linear_envelope
                        ? static_cast<float>(mean / amplitude_of_db(options_.full_scale_db))
                        : log_compressed(mean, options_));
  }
  VolumeSamples result(static_cast<std::size_t>(sticks) * static_cast<std::size_t>(samples));
  const auto first_sequence =
      static_cast<std::uint64_t>(index) * static_cast<std::uint64_t>(sticks);
  parallel_ranges(sticks, options_.threads, [&](int first, int last) {
    StickTrack track;
    for (int place = first; place < last; ++place) {
      const auto stick = plan_.index(first_sequence + static_cast<std::uint64_t>(place));
      follow(
          subject_, sightline(plan_, stick), plan_.acquisition().depth_m, track, Surfaces::crossed);
      const auto values = stick_of(result, place, samples);
      int k = 0;
      for (const Stretch& stretch : track.stretches) {
        const bool is_last = &stretch == &track.stretches.back();
        while (k < samples && (is_last || plan_.sample_range_m(k) < stretch.to_m)) {
          values[static_cast<std::size_t>(k++)] = shown[static_cast<std::size_t>(stretch.material)];
        }
      }
    }
  });
  return result;
}

std::vector<std::string> ProbeSimulator::effects() const {
  std::vector<std::string> ran;
  for (const Effect& effect : fidelity_.effects) {
    if (effect.left_out.empty()) ran.push_back(effect.name);
  }
  return ran;
}

}  // namespace wobblebench::sim
