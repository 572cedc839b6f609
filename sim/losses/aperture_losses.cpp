#include "sim/losses/aperture_losses.h"

#include <algorithm>

#include "base/parallel.h"
#include "sim/losses/cone_mean.h"

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
                               const ProbeOptics& optics,
                               const SimulationOptions& options,
                               double depth_m)
    : tissue_(&tissue),
      plan_(optics.plan()),
      geometry_(plan_.geometry()),
      threads_(options.threads),
      depth_m_(depth_m),
      losses_(plan_, options, tissue.materials),
      band_(plan_.probe()),
      grid_(LossGrid::of(plan_, depth_m)),
      cone_(optics, grid_),
      section_(optics, grid_, cone_) {}

double ApertureLosses::bytes(const hw::AcquisitionPlan& plan, double depth_m, int kept) {
  const LossGrid grid = LossGrid::of(plan, depth_m);
  const double nodes = 1.0 * grid.frames * grid.lines * grid.nodes;
  const double parts = 1.0 * grid.frames * static_cast<double>(ConeMean::parts_size(grid));
  constexpr int kCorrections = 2, kTables = 3;  // of LossTable
  return sizeof(float) * ((kept * kCorrections + kTables) * nodes + parts);
}

std::shared_ptr<const VolumeCorrections> ApertureLosses::volume(std::uint32_t number) const {
  return recent_.of(number,
                    [&] { return std::make_shared<const VolumeCorrections>(*this, number); });
}

/// Computes the corrections of a volume in three steps; each needs the results of the step before
/// in neighbouring frames.
class CorrectionMaker {
 public:
  CorrectionMaker(const ApertureLosses& source, std::uint32_t number)
      : source_(source), number_(number), table_(source.grid_) {
    const auto frames = static_cast<std::size_t>(source.grid_.frames);
    is_read_.resize(frames);
    parts_.resize(frames * ConeMean::parts_size(source.grid_));
  }

  /// Fills both arrays, [frame][line][node].
  void fill(std::vector<float>& log_gain, std::vector<float>& frequency) {
    const int frames = source_.grid_.frames;
    parallel_ranges(frames, source_.threads_, [&](int first, int last) {
      StickTrack track;
      for (int frame = first; frame < last; ++frame) trace(frame, track);
    });
    find_read();
    parallel_ranges(frames, source_.threads_, [&](int first, int last) {
      ConeMean mean = cone_mean();
      for (int frame = first; frame < last; ++frame) {
        if (is_read_[static_cast<std::size_t>(frame)] == 0) continue;
        mean.follow(
            frame, of_frame(frame, log_gain), of_frame(frame, frequency), of_frame(frame, parts_));
      }
    });
    parallel_ranges(frames, source_.threads_, [&](int first, int last) {
      ConeMean mean = cone_mean();
      for (int frame = first; frame < last; ++frame) {
        mean.add_elevation(frame, parts_, of_frame(frame, log_gain));
        mean.lift_lone_sticks(frame, of_frame(frame, log_gain));
      }
    });
  }

 private:
  ConeMean cone_mean() const {
    return {source_.cone_, source_.section_, source_.grid_, table_, source_.band_};
  }

  /// Finds the frames that the third step reads: those around each frame with corrections.
  void find_read() {
    const ConeMean mean = cone_mean();
    const int reach = source_.section_.most_frames() + 1;  // points lie between two frames
    const int frames = source_.grid_.frames;
    for (int frame = 0; frame < frames; ++frame) {
      if (!mean.differs(frame)) continue;
      const int from = std::max(frame - reach, 0), to = std::min(frame + reach + 1, frames);
      std::fill(is_read_.begin() + from, is_read_.begin() + to, char{1});
    }
  }

  std::span<float> of_frame(int frame, std::vector<float>& values) const {
    const std::size_t size = values.size() / static_cast<std::size_t>(source_.grid_.frames);
    return std::span(values).subspan(static_cast<std::size_t>(frame) * size, size);
  }

  void trace(int frame, StickTrack& track) {
    for (int line = 0; line < source_.grid_.lines; ++line) {
      const hw::StickIndex index{
          number_, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)};
      follow(*source_.tissue_,
             stick_ray(source_.plan_, source_.geometry_, index),
             source_.depth_m_,
             track,
             Surfaces::crossed);
      table_.record(frame, line, track, source_.losses_);
    }
    table_.finish(frame);
  }

  const ApertureLosses& source_;
  std::uint32_t number_;
  LossTable table_;
  std::vector<char> is_read_;  ///< of each frame
  std::vector<float> parts_;   ///< [frame][node][part][line], as in ConeMean::follow()
};

VolumeCorrections::VolumeCorrections(const ApertureLosses& source, std::uint32_t number)
    : grid_(source.grid_), number_(number) {
  const auto sticks =
      static_cast<std::size_t>(grid_.frames) * static_cast<std::size_t>(grid_.lines);
  const auto nodes = static_cast<std::size_t>(grid_.nodes);
  log_gain_.resize(sticks * nodes);
  frequency_.resize(sticks * nodes);
  CorrectionMaker(source, number).fill(log_gain_, frequency_);
  for (std::size_t stick = 0; stick < sticks; ++stick) {
    const auto gains = std::span(log_gain_).subspan(stick * nodes, nodes);
    differs_.push_back(std::ranges::any_of(gains, [](float value) { return value != 0; }));
  }
}

ApertureCorrection VolumeCorrections::of(const hw::StickIndex& index) const {
  const std::size_t stick =
      static_cast<std::size_t>(index.frame) * static_cast<std::size_t>(grid_.lines) + index.line;
  if (differs_[stick] == 0) return {};
  const auto nodes = static_cast<std::size_t>(grid_.nodes);
  return {grid_.step_m,
          std::span(log_gain_).subspan(stick * nodes, nodes),
          std::span(frequency_).subspan(stick * nodes, nodes)};
}

}  // namespace wobblebench::sim
