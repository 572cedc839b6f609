#include "sim/rungs/mean_power.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hw/probe/acquisition_plan.h"
#include "sim/losses/losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/math/fast_math.h"
#include "sim/optics/pulse_band.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

namespace {

constexpr double kMaxReach_m = 4e-3;
/// Width of the vectorised loops; runs of samples are padded to multiples of it.
constexpr std::size_t kLanes = 16;

/// Positions of samples among a piece's nodes: the node before, and the fraction of the distance to
/// the next. `delay_m` may be null.
WOBBLEBENCH_SIMD void locate_samples(int first,
                                     int count,
                                     double spacing_m,
                                     const float* __restrict delay_m,
                                     double from_m,
                                     double per_node,
                                     double last,
                                     std::int32_t* __restrict node,
                                     float* __restrict share) {
  for (int i = 0; i < count; ++i) {
    const double delay = delay_m == nullptr ? 0.0 : static_cast<double>(delay_m[first + i]);
    const double true_m = (static_cast<double>(first + i) + 0.5) * spacing_m - delay;
    const double at = (true_m - from_m) * per_node;
    const double least = at < 0.0 ? 0.0 : at;
    const double position = least > last ? last : least;
    node[i] = static_cast<std::int32_t>(position);
    share[i] = static_cast<float>(position - static_cast<double>(node[i]));
  }
}

/// Blends one surface's tissue and interface over the power so far, in painter's order.
WOBBLEBENCH_SIMD void blend_surface(const MeanPower::NodePair* __restrict pair,
                                    const float* __restrict share,
                                    const float* __restrict inside,
                                    std::size_t count,
                                    float* __restrict tissue,
                                    float* __restrict interface_power) {
  for (std::size_t i = 0; i < count; ++i) {
    const float u = pair[i].near.distance_sigmas +
                    share[i] * (pair[i].far.distance_sigmas - pair[i].near.distance_sigmas);
    const float interface = pair[i].near.interface_power +
                            share[i] * (pair[i].far.interface_power - pair[i].near.interface_power);
    const Gaussian beam = gaussian(u);  // u > 0 is outside
    tissue[i] = tissue[i] * beam.distribution + inside[i] * (1.0f - beam.distribution);
    interface_power[i] = interface_power[i] * beam.distribution + interface * beam.density;
  }
}

WOBBLEBENCH_SIMD void sum_and_attenuate(const float* __restrict tissue,
                                        const float* __restrict interface_power,
                                        const float* __restrict remaining,
                                        const BeamAtSample* __restrict beam,
                                        std::size_t count,
                                        float* __restrict power) {
  for (std::size_t i = 0; i < count; ++i) {
    power[i] = (tissue[i] + interface_power[i]) * remaining[i] * remaining[i] * beam[i].level2;
  }
}

std::size_t padded(std::size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace

double MeanPower::reach_m(const hw::AcquisitionPlan& plan) {
  // Upper bound of the width: the first lobe plus the geometric shadow of the lens.
  const auto& probe = plan.probe();
  const double depth_m = plan.acquisition().depth_m;
  const double lobe_m = plan.acquisition().sound_speed_m_s / probe.center_frequency_hz * depth_m /
                        std::min(probe.element_height_m, receive_aperture_m(probe, depth_m));
  const double shadow_m =
      probe.element_height_m * std::max(1.0, depth_m / probe.elevation_focus_m - 1);
  return std::min(BeamNodes::kReachSigmas * power_sigma(lobe_m + shadow_m), kMaxReach_m);
}

MeanPower::MeanPower(const ProbeOptics& optics,
                     const SimulationOptions& options,
                     const std::vector<phantoms::Material>& materials,
                     double spacing_m,
                     int samples,
                     double reach_m)
    : spacing_m_(spacing_m),
      beam_(optics.plan(), optics.profile(), spacing_m, samples),
      gain_(optics, spacing_m, samples),
      nodes_(optics, options, materials, spacing_m, samples, reach_m) {
  for (const auto& material : materials) {
    const double mean = amplitude_of_db(material.backscatter_db);
    const bool echoes = material.backscatter_db > kZeroAmplitude_db;
    material_power_.push_back(echoes ? static_cast<float>(mean_power_gain(options) * mean * mean)
                                     : 0.0f);
  }
  // The last section is padded, wherever it ends.
  const std::size_t most = static_cast<std::size_t>(samples) + kLanes;
  node_.resize(most);
  for (auto* values : {&node_share_, &inside_, &tissue_, &interface_}) values->resize(most);
  node_pair_.resize(most);
}

bool MeanPower::Section::clear() const {
  return piece->layers == 0 && count >= kLanes;
}

bool MeanPower::compute(const StickTrack& track,
                        const StickLosses& losses,
                        double theta_rad,
                        std::span<float> power) {
  const std::size_t end = losses.remaining().size();
  find_sections(track, losses);
  const bool anechoic = std::ranges::all_of(sections_, [this](const Section& section) {
    return section.piece->layers == 0 && base_power(section) == 0;
  });
  if (anechoic) {
    std::fill(power.begin(), power.end(), 0.0f);
    return false;
  }
  const BeamAtSample* beam = beam_.of(theta_rad);
  nodes_.compute(track, losses, beam);
  gain_.apply(losses, remaining_);
  for (const Section& section : sections_) begin_section(track, section);
  std::fill_n(interface_.begin(), end, 0.0f);
  blend_first_layers();
  for (const Section& section : sections_) {
    for (int layer = 1; layer < section.piece->layers; ++layer) blend_layer(track, section, layer);
  }
  sum_and_attenuate(tissue_.data(), interface_.data(), remaining_.data(), beam, end, power.data());
  std::fill(power.begin() + static_cast<std::ptrdiff_t>(end), power.end(), 0.0f);
  return true;
}

void MeanPower::find_sections(const StickTrack& track, const StickLosses& losses) {
  sections_.clear();
  const auto end = static_cast<int>(losses.remaining().size());
  const float* delay_m = losses.delay_m().empty() ? nullptr : losses.delay_m().data();
  int first = 0;
  for (const TrackPiece& piece : track.pieces) {
    const bool is_last = &piece == &track.pieces.back();
    const int next = is_last ? end : losses.samples_before(losses.apparent_m(track, piece.to_m));
    const int count = std::min(next, end) - first;
    if (count <= 0) continue;
    sections_.push_back({&piece, static_cast<std::size_t>(first), static_cast<std::size_t>(count)});
    if (piece.layers > 0) {
      locate_samples(first,
                     count,
                     spacing_m_,
                     delay_m,
                     piece.from_m,
                     (piece.nodes - 1) / (piece.to_m - piece.from_m),
                     static_cast<double>(piece.nodes - 1),
                     node_.data() + first,
                     node_share_.data() + first);
    }
    first += count;
  }
}

void MeanPower::begin_section(const StickTrack& track, const Section& section) {
  if (section.clear()) return;
  const auto first = static_cast<std::ptrdiff_t>(section.first);
  const float base = base_power(section);
  std::fill_n(tissue_.begin() + first, section.count, base);
  if (section.piece->layers > 0) {
    load_layer(track, section, 0);
    return;
  }
  std::fill_n(inside_.begin() + first, section.count, base);
  std::fill_n(node_pair_.begin() + first, section.count, NodePair());
  std::fill_n(node_share_.begin() + first, section.count, 0.0f);
}

void MeanPower::load_layer(const StickTrack& track, const Section& section, int layer) {
  const auto& surface = track.layers[static_cast<std::size_t>(section.piece->first_layer + layer)];
  const BeamNodes::Node* nodes = nodes_.of(surface);
  for (std::size_t i = 0; i < section.count; ++i) {
    // Adjacent nodes, copied as a pair: a vectorised loop would gather each member separately.
    const BeamNodes::Node* near = nodes + node_[section.first + i];
    node_pair_[section.first + i] = {near[0], near[1]};
  }
  std::fill_n(inside_.begin() + static_cast<std::ptrdiff_t>(section.first),
              section.count,
              material_power_[static_cast<std::size_t>(surface.inside)]);
  restore_fronts(surface, section);
}

/// The part of an interface's echo that the beam spreads to samples behind the interface has not
/// crossed it: its amplitude is the one that remains before the interface.
void MeanPower::restore_fronts(const TrackLayer& surface, const Section& section) {
  constexpr float kMostGain = 1e15F;  // its square is a finite float
  const auto fronts = nodes_.fronts_of(surface, section.piece->nodes);
  auto front = fronts.begin();
  const std::size_t end = section.first + section.count;
  for (std::size_t i = section.first; i < end && front != fronts.end(); ++i) {
    // The nodes of the next sample are the same or farther away.
    const int near = surface.first_node + node_[i];
    while (front != fronts.end() && front->node < near) ++front;
    if (front == fronts.end() || front->node > near + 1) continue;
    if (static_cast<int>(i) <= front->before) continue;
    const float gain = remaining_[static_cast<std::size_t>(front->before)] / remaining_[i];
    const float bounded = std::min(gain, kMostGain);
    node_pair_[i].near.interface_power *= bounded * bounded;
    node_pair_[i].far.interface_power *= bounded * bounded;
  }
}

/// Blends the first surface of every section; adjacent sections are processed together. Few
/// sections have more than one surface.
void MeanPower::blend_first_layers() {
  for (auto section = sections_.begin(); section != sections_.end(); ++section) {
    const auto clear = std::find_if(section, sections_.end(), std::mem_fn(&Section::clear));
    if (clear != section) {
      const Section& last = clear[-1];
      blend(section->first, padded(last.first + last.count - section->first));
    }
    if (clear == sections_.end()) return;
    const auto first = static_cast<std::ptrdiff_t>(clear->first);
    std::fill_n(tissue_.begin() + first, clear->count, base_power(*clear));
    std::fill_n(interface_.begin() + first, clear->count, 0.0f);
    section = clear;
  }
}

void MeanPower::blend_layer(const StickTrack& track, const Section& section, int layer) {
  load_layer(track, section, layer);
  blend(section.first, section.count);
}

void MeanPower::blend(std::size_t first, std::size_t count) {
  blend_surface(node_pair_.data() + first,
                node_share_.data() + first,
                inside_.data() + first,
                count,
                tissue_.data() + first,
                interface_.data() + first);
}

}  // namespace wobblebench::sim
