#include "sim/probe_simulator.h"

#include <algorithm>

#include "base/duration.h"
#include "base/parallel.h"
#include "hw/probe/clock.h"
#include "sim/clutter/particles.h"
#include "sim/receive/display.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::sim {

namespace {

double milliseconds_since(hw::HostTime start) {
  return to_milliseconds(hw::HostClock::now() - start);
}

}  // namespace

struct ProbeSimulator::Impl {
  hw::AcquisitionPlan plan;
  SimulationOptions options;
  Fidelity fidelity;
  std::unique_ptr<const EchoModel> model;
  double map_ms = 0;
  double once_ms = 0;
};

ProbeSimulator::ProbeSimulator(const phantoms::PlacedPhantom& subject,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options,
                               const TissueMapSource& maps,
                               const EchoStore& echoes) {
  hw::validate(plan.probe());
  check_options(options);
  check_options(options.clutter, "clutter.");
  check_options(options.display, "display.");
  auto impl = std::make_shared<Impl>(
      Impl{plan,
           options,
           choose_fidelity(
               options, plan, !subject.motion.still(), !subject.phantom.scatterers().empty()),
           nullptr});
  const Rung rung = impl->fidelity.rung;
  const auto begin = hw::HostClock::now();
  const double reach_m = echo_model_type(rung).reach_m(plan);
  ScannedTissue tissue{
      maps ? maps(subject.phantom, reach_m, options.threads)
           : std::make_shared<const TissueMap>(subject.phantom, reach_m, options.threads),
      subject.phantom.materials(),
      subject.placement,
      subject.motion,
      subject.phantom.shared_scatterers()};
  if (options.clutter.particles_per_cm3 > 0 && rung != Rung::geometry) {
    auto points = std::make_shared<phantoms::PointScatterers>(subject.phantom.scatterers());
    points->add(fluid_particles(subject, *tissue.map, plan, options));
    tissue.points = std::move(points);
  }
  impl->map_ms = milliseconds_since(begin);
  const auto mapped = hw::HostClock::now();
  impl->model = make_echo_model(rung, tissue, plan, before_show(options), echoes);
  impl->once_ms = milliseconds_since(mapped);
  impl_ = std::move(impl);
}

VolumeSamples ProbeSimulator::volume(std::uint32_t index, const IqSink& iq) const {
  const int sticks = plan().sticks_per_volume();
  const auto samples = static_cast<std::size_t>(plan().acquisition().samples_per_stick);
  const std::uint64_t first_sequence = plan().first_sequence(index);
  VolumeSamples volume(static_cast<std::size_t>(sticks) * samples);
  impl_->model->prepare(index);
  parallel_ranges(sticks, options().threads, [&](int first, int last) {
    const StickMaker make = impl_->model->stick_maker(iq);
    for (int i = first; i < last; ++i) {
      const std::uint64_t sequence = plan().sequence(stick_in_order(plan(), index, i));
      const auto stick = static_cast<std::size_t>(sequence - first_sequence);
      make(sequence, std::span(volume).subspan(stick * samples, samples));
    }
  });
  if (changes_samples(options())) {
    show(volume, plan().acquisition().frames_per_volume, plan(), options());
  }
  return volume;
}

std::vector<float> ProbeSimulator::block(std::uint64_t first_sequence) const {
  const auto lines = static_cast<std::uint64_t>(plan().acquisition().sticks_per_frame);
  const auto per_volume = static_cast<std::uint64_t>(plan().sticks_per_volume());
  const std::uint64_t left = per_volume - first_sequence % per_volume;
  // The first frame is averaged with the one before it in the volume.
  const bool averaged = options().display.persistence > 0 && left < per_volume;
  const std::uint64_t before = averaged ? 1 : 0;
  const std::uint64_t frames = std::min(std::uint64_t{kFramesTogether}, left / lines) + before;
  const std::uint64_t begin = first_sequence - before * lines;
  const auto samples = static_cast<std::size_t>(plan().acquisition().samples_per_stick);
  std::vector<float> block(frames * lines * samples);
  impl_->model->prepare(plan().index(first_sequence).volume);
  parallel_ranges(static_cast<int>(frames * lines), options().threads, [&](int first, int last) {
    const StickMaker make = impl_->model->stick_maker({});
    for (auto i = static_cast<std::uint64_t>(first); i < static_cast<std::uint64_t>(last); ++i) {
      const std::uint64_t stick = i % frames * lines + i / frames;
      make(begin + stick, std::span(block).subspan(stick * samples, samples));
    }
  });
  if (changes_samples(options())) show(block, static_cast<int>(frames), plan(), options());
  block.erase(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(before * lines * samples));
  return block;
}

const hw::AcquisitionPlan& ProbeSimulator::plan() const {
  return impl_->plan;
}

const SimulationOptions& ProbeSimulator::options() const {
  return impl_->options;
}

const Fidelity& ProbeSimulator::fidelity() const {
  return impl_->fidelity;
}

std::vector<std::string> ProbeSimulator::effects() const {
  std::vector<std::string> ran;
  for (const Effect& effect : fidelity().effects) {
    if (effect.left_out.empty()) ran.push_back(effect.name);
  }
  return ran;
}

double ProbeSimulator::map_ms() const {
  return impl_->map_ms;
}

double ProbeSimulator::once_ms() const {
  return impl_->once_ms;
}

}  // namespace wobblebench::sim
