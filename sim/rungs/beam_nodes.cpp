#include "sim/rungs/beam_nodes.h"

#include <algorithm>
#include <cmath>

#include "sim/losses/losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/math/fast_math.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::sim {

namespace {

/// Width of the vectorised loop; nodes are padded to multiples of it.
constexpr std::size_t kNodeLanes = 16;

float squared(double x) {
  return static_cast<float>(x * x);
}

/// Material outside the surface of `layer` at node `n`, given by the layers before it.
phantoms::MaterialIndex material_beneath(const StickTrack& track,
                                         const TrackPiece& piece,
                                         int layer,
                                         int n) {
  phantoms::MaterialIndex material = piece.base;
  for (int l = 0; l < layer; ++l) {
    const auto& other = track.layers[static_cast<std::size_t>(piece.first_layer + l)];
    const auto& node = track.nodes[static_cast<std::size_t>(other.first_node + n)];
    if (node.value_m < 0) material = other.inside;
  }
  return material;
}

/// True if the node is behind the surface, and close enough to belong to this crossing.
bool is_just_behind(const TrackNode& node) {
  constexpr auto kSameCrossing_m = static_cast<float>(StickLosses::kBehindInterface_m);
  return (node.axial < 0) == (node.value_m < 0) &&
         std::abs(node.value_m) < kSameCrossing_m * std::abs(node.axial);
}

/// Widens the beam for a lower centre frequency.
void widen(const std::vector<float>& frequency_ratio, int sample, BeamAtSample& beam) {
  if (frequency_ratio.empty()) return;
  const auto at = std::min(static_cast<std::size_t>(sample), frequency_ratio.size() - 1);
  const float ratio = std::max(frequency_ratio[at], FrequencyCourse::kLowest);
  const float wider2 = 1 / (ratio * ratio);
  beam.lateral2 *= wider2;
  beam.elevation2 *= wider2;
}

}  // namespace

double mean_power_gain(const SimulationOptions& options) {
  return options.speckle ? kPowerOfRayleighMean : 1;
}

struct NodeKernels {
  /// The interface's power is that of diffuse_echo(), in single precision.
  WOBBLEBENCH_SIMD static void scale(const TrackNode* __restrict surfaces,
                                     const BeamAtSample* __restrict beam,
                                     const BeamNodes::Crossing* __restrict crossed,
                                     float pulse2,
                                     float max2,
                                     float interface_gain,
                                     std::size_t count,
                                     BeamNodes::Node* __restrict nodes) {
    for (std::size_t i = 0; i < count; ++i) {
      const float axial2 = surfaces[i].axial * surfaces[i].axial;
      const float lateral2 = surfaces[i].lateral * surfaces[i].lateral;
      const float elevation2 = surfaces[i].elevation * surfaces[i].elevation;
      const float width2 =
          pulse2 * axial2 + beam[i].lateral2 * lateral2 + beam[i].elevation2 * elevation2;
      const float least = width2 < 1e-12f ? 1e-12f : width2;
      const float width = std::sqrt(least > max2 ? max2 : least);
      const float slope2 = axial2 + lateral2 + elevation2;
      const float cos2 = axial2 / (slope2 < 1e-12f ? 1e-12f : slope2);
      const float cosine = std::sqrt(cos2);
      const float sin2_through = crossed[i].speed_ratio2 * (1.0f - cos2);
      const float cos_through = std::sqrt(sin2_through > 1.0f ? 0.0f : 1.0f - sin2_through);
      const float in = crossed[i].impedance_behind * cosine;
      const float through = crossed[i].impedance_before * cos_through;
      const float reflected = sin2_through >= 1.0f ? 1.0f : (in - through) / (in + through);
      const float mean = crossed[i].roughness * reflected * cosine;
      // At normal incidence the pulse alone gives the peak; an oblique footprint spreads the echo
      // along the stick.
      nodes[i].distance_sigmas = surfaces[i].value_m / width;
      nodes[i].interface_power = interface_gain * mean * mean * std::sqrt(axial2) / width;
    }
  }
};

BeamNodes::BeamNodes(const ProbeOptics& optics,
                     const SimulationOptions& options,
                     const std::vector<phantoms::Material>& materials,
                     double spacing_m,
                     int samples,
                     double reach_m)
    : materials_(materials.size()),
      interface_echo_(options.interface_echo),
      spacing_m_(spacing_m),
      pulse2_(squared(power_sigma(optics.axial_fwhm_m()))),
      max2_(squared(reach_m / kReachSigmas)),
      interface_gain_(
          static_cast<float>(mean_power_gain(options) * power_sigma(optics.axial_fwhm_m()))),
      samples_(samples) {
  for (const auto& before : materials) {
    for (const auto& behind : materials) {
      const bool echoes = &before != &behind && interface_echo_;
      crossings_.push_back({static_cast<float>(before.impedance_rayl),
                            static_cast<float>(behind.impedance_rayl),
                            squared(behind.sound_speed_m_s / before.sound_speed_m_s),
                            echoes ? static_cast<float>(roughness(before, behind)) : 0.0f});
    }
  }
}

void BeamNodes::compute(const StickTrack& track,
                        const StickLosses& losses,
                        const BeamAtSample* beam) {
  const std::size_t count = (track.nodes.size() + kNodeLanes) / kNodeLanes * kNodeLanes;
  surfaces_.assign(track.nodes.begin(), track.nodes.end());
  surfaces_.resize(count);
  beam_.resize(count);
  crossed_.resize(count);
  nodes_.resize(count);
  look_up(track, losses, beam);
  NodeKernels::scale(surfaces_.data(),
                     beam_.data(),
                     crossed_.data(),
                     pulse2_,
                     max2_,
                     interface_gain_,
                     count,
                     nodes_.data());
}

void BeamNodes::look_up(const StickTrack& track,
                        const StickLosses& losses,
                        const BeamAtSample* at_samples) {
  const int last_sample = samples_ - 1;
  fronts_.clear();
  for (const TrackPiece& piece : track.pieces) {
    const double step_m = (piece.to_m - piece.from_m) / (piece.nodes - 1);
    const double per_node = step_m / spacing_m_, from = piece.from_m / spacing_m_;
    for (int layer = 0; layer < piece.layers; ++layer) {
      const TrackLayer& surface = track.layers[static_cast<std::size_t>(piece.first_layer + layer)];
      const Crossing* entering = &crossing(piece.base, surface.inside);
      const Crossing* leaving = &crossing(surface.inside, piece.base);
      const auto first = static_cast<std::size_t>(surface.first_node);
      const TrackNode* nodes = track.nodes.data() + first;
      BeamAtSample* beam = beam_.data() + first;
      Crossing* crossed = crossed_.data() + first;
      for (int n = 0; n < piece.nodes; ++n) {
        const int sample = std::min(static_cast<int>(from + n * per_node), last_sample);
        beam[n] = at_samples[sample];
        widen(losses.frequency_ratio(), sample, beam[n]);
        if (layer > 0) {
          const auto outside = material_beneath(track, piece, layer, n);
          entering = &crossing(outside, surface.inside);
          leaving = &crossing(surface.inside, outside);
        }
        crossed[n] = nodes[n].axial < 0 ? *entering : *leaving;
        if (interface_echo_ && is_just_behind(nodes[n])) {
          find_front(track, losses, surface.first_node + n, piece.from_m + n * step_m);
        }
      }
    }
  }
}

void BeamNodes::find_front(const StickTrack& track,
                           const StickLosses& losses,
                           int node,
                           double range_m) {
  const TrackNode& behind = track.nodes[static_cast<std::size_t>(node)];
  const double surface_m = range_m - static_cast<double>(behind.value_m / behind.axial);
  const int before = losses.samples_before(losses.apparent_m(track, surface_m)) - 1;
  if (before >= 0 && before < static_cast<int>(losses.remaining().size())) {
    fronts_.push_back({node, before});
  }
}

std::span<const BeamNodes::Front> BeamNodes::fronts_of(const TrackLayer& layer, int nodes) const {
  if (fronts_.empty()) return {};
  const auto first = std::ranges::lower_bound(fronts_, layer.first_node, {}, &Front::node);
  auto end = first;
  while (end != fronts_.end() && end->node < layer.first_node + nodes) ++end;
  return {first, end};
}

}  // namespace wobblebench::sim
