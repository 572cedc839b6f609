#include "sim/aperture/aperture_losses.h"

#include <algorithm>

#include "sim/aperture/cone_mean.h"

namespace wobblebench::sim {

bool has_aperture_losses(const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials) {
  if (!options.aperture_losses) return false;
  return std::ranges::any_of(materials, [&](const phantoms::Material& material) {
    const phantoms::Material& first = materials.front();
    const bool absorbs = material.attenuation_db_per_cm_mhz != first.attenuation_db_per_cm_mhz;
    const bool reflects = material.impedance_rayl != first.impedance_rayl ||
                          material.sound_speed_m_s != first.sound_speed_m_s;
    return (options.attenuation && absorbs) || (options.transmission_loss && reflects);
  });
}

ApertureLosses::ApertureLosses(const ScannedTissue& tissue,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options,
                               double depth_m)
    : tissue_(&tissue),
      plan_(plan),
      geometry_(plan.geometry()),
      depth_m_(depth_m),
      losses_(plan, options, tissue.materials),
      band_(plan.probe()),
      grid_(LossGrid::of(plan, depth_m)),
      cone_(plan, grid_),
      places_(plan, grid_, cone_) {}

double ApertureLosses::bytes(const hw::AcquisitionPlan& plan) {
  const LossGrid grid = LossGrid::of(plan, plan.acquisition().depth_m);
  const double nodes = 1.0 * grid.frames * grid.lines * grid.nodes;
  const double parts = 1.0 * grid.frames * static_cast<double>(ConeMean::parts_size(grid));
  constexpr int kTables = 5;  // three of LossTable, two of corrections
  return kRecent * sizeof(float) * (kTables * nodes + parts);
}

std::shared_ptr<const VolumeCorrections> ApertureLosses::volume(std::uint32_t number) const {
  const std::scoped_lock lock(mutex_);
  for (const auto& kept : recent_) {
    if (kept->number() == number) return kept;
  }
  if (recent_.size() == kRecent) recent_.erase(recent_.begin());
  recent_.push_back(std::make_shared<const VolumeCorrections>(*this, number));
  return recent_.back();
}

void OncePerFrame::run(int first, int last, const std::function<void(int)>& work) {
  const auto once = [&](int frame) {
    std::call_once(done_[static_cast<std::size_t>(frame)], work, frame);
  };
  for (int frame = first; frame <= last; ++frame) {
    if (!begun_[static_cast<std::size_t>(frame)].exchange(true)) once(frame);
  }
  for (int frame = first; frame <= last; ++frame) once(frame);
}

VolumeCorrections::VolumeCorrections(const ApertureLosses& source, std::uint32_t number)
    : source_(source),
      number_(number),
      table_(source.grid_),
      traced_(source.grid_.frames),
      followed_(source.grid_.frames),
      computed_(source.grid_.frames),
      differs_(static_cast<std::size_t>(source.grid_.frames)) {
  const LossGrid& grid = source.grid_;
  log_gain_.resize(static_cast<std::size_t>(grid.frames) * grid.lines * grid.nodes);
  frequency_.resize(log_gain_.size());
  parts_.resize(static_cast<std::size_t>(grid.frames) * ConeMean::parts_size(grid));
}

ApertureCorrection VolumeCorrections::of(const hw::StickIndex& index) const {
  const LossGrid& grid = source_.grid_;
  const auto frame = static_cast<int>(index.frame);
  computed_.run(frame, frame, [this](int each) { compute(each); });
  if (differs_[index.frame] == 0) return {};
  const auto nodes = static_cast<std::size_t>(grid.nodes);
  const auto first =
      (static_cast<std::size_t>(index.frame) * static_cast<std::size_t>(grid.lines) + index.line) *
      nodes;
  const auto log_gain = std::span<const float>(log_gain_).subspan(first, nodes);
  if (std::ranges::all_of(log_gain, [](float value) { return value == 0; })) return {};
  return {grid.step_m, log_gain, std::span<const float>(frequency_).subspan(first, nodes)};
}

void VolumeCorrections::trace(int frame) const {
  StickTrack track;
  for (int line = 0; line < source_.grid_.lines; ++line) {
    const hw::StickIndex index{
        number_, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)};
    sim::follow(*source_.tissue_,
                stick_ray(source_.plan_, source_.geometry_, index),
                source_.depth_m_,
                track,
                Surfaces::crossed);
    table_.record(frame, line, track, source_.losses_);
  }
  table_.finish(frame);
}

std::span<float> VolumeCorrections::nodes_of(int frame, std::vector<float>& values) const {
  const std::size_t size = values.size() / static_cast<std::size_t>(source_.grid_.frames);
  return std::span(values).subspan(static_cast<std::size_t>(frame) * size, size);
}

void VolumeCorrections::follow(int frame, ConeMean& mean) const {
  mean.follow(
      frame, nodes_of(frame, log_gain_), nodes_of(frame, frequency_), nodes_of(frame, parts_));
}

void VolumeCorrections::compute(int frame) const {
  const int last = source_.grid_.frames - 1;
  // Ways, and places, lie between two frames.
  const int ways = source_.cone_.most_frames() + 1, places = source_.places_.most_frames() + 1;
  const int reach = ways + places;
  traced_.run(
      std::max(frame - reach, 0), std::min(frame + reach, last), [this](int near) { trace(near); });
  ConeMean mean(source_.cone_, source_.places_, source_.grid_, table_, source_.band_);
  if (!mean.uneven(frame)) return;
  followed_.run(std::max(frame - places, 0), std::min(frame + places, last), [&](int near) {
    follow(near, mean);
  });
  mean.add_elevation(frame, parts_, nodes_of(frame, log_gain_));
  differs_[static_cast<std::size_t>(frame)] = 1;
}

}  // namespace wobblebench::sim
