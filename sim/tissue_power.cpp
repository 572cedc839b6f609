#include "sim/tissue_power.h"

#include <algorithm>
#include <cmath>

#include "sim/fast_math.h"
#include "sim/point_spread.h"

namespace wobblebench::sim {

namespace {

/// A Rayleigh envelope's mean is sqrt(pi)/2 of its RMS; the material table gives means.
const double kPowerOfRayleighMean = 4 / kPi;
constexpr double kReachSigmas = 3;
constexpr double kMostReach_m = 4e-3;
/// Beyond this many sigmas a surface is all there or not at all: 3e-5 of the power.
constexpr float kFarAway = 4;

/// Sigma of the power under an amplitude response of this width.
double power_sigma(double amplitude_fwhm) {
  return sigma_of_fwhm(amplitude_fwhm) / std::sqrt(2.0);
}

double widest_sigma(const hw::AcquisitionPlan& plan, double range_m) {
  return std::max(power_sigma(lateral_fwhm_m(plan, range_m)),
                  power_sigma(elevation_fwhm_m(plan, range_m)));
}

/// Blends one surface over what was painted before: `depth` and `sheet` at the nodes, `place` of
/// each sample in nodes.
WOBBLEBENCH_SIMD void paint(const float* depth,
                            const float* sheet,
                            float inside,
                            const float* place,
                            int count,
                            float* tissue,
                            float* sheets) {
  for (int i = 0; i < count; ++i) {
    const int n = static_cast<int>(place[i]);
    const float f = place[i] - static_cast<float>(n);
    const float u = depth[n] + f * (depth[n + 1] - depth[n]);
    const float s = sheet[n] + f * (sheet[n + 1] - sheet[n]);
    const Gaussian beam = gaussian(u);  // u > 0 is outside
    tissue[i] = tissue[i] * beam.distribution + inside * (1.0f - beam.distribution);
    sheets[i] = sheets[i] * beam.distribution + s * beam.density;
  }
}

/// What a layer's nodes need to know of the beam there, a few nodes at a time.
constexpr int kNodeLanes = 8;
struct NodeLanes {
  float lateral2[kNodeLanes];
  float elevation2[kNodeLanes];
  float width[kNodeLanes];
  float depth[kNodeLanes];
};

/// The beam's width along the surface's normal at some nodes, and their distance over it.
WOBBLEBENCH_SIMD void scale_nodes(const TissueMap::LineNode* nodes,
                                  float pulse2,
                                  float most2,
                                  NodeLanes& __restrict lanes) {
  for (int i = 0; i < kNodeLanes; ++i) {
    const TissueMap::LineNode& node = nodes[i];
    const float width2 = pulse2 * node.axial * node.axial +
                         lanes.lateral2[i] * node.lateral * node.lateral +
                         lanes.elevation2[i] * node.elevation * node.elevation;
    const float least = width2 < 1e-12f ? 1e-12f : width2;
    const float width = std::sqrt(least > most2 ? most2 : least);
    lanes.width[i] = width;
    lanes.depth[i] = node.value_m / width;
  }
}

/// Places of samples among a piece's nodes; `delay_m` may be null.
WOBBLEBENCH_SIMD void place_samples(int first,
                                    int count,
                                    double spacing_m,
                                    const float* delay_m,
                                    double from_m,
                                    double per_node,
                                    double last,
                                    float* place) {
  for (int i = 0; i < count; ++i) {
    const double delay = delay_m == nullptr ? 0.0 : static_cast<double>(delay_m[first + i]);
    const double true_m = (static_cast<double>(first + i) + 0.5) * spacing_m - delay;
    const double at = (true_m - from_m) * per_node;
    const double least = at < 0.0 ? 0.0 : at;
    place[i] = static_cast<float>(least > last ? last : least);
  }
}

WOBBLEBENCH_SIMD void weaken(float* power, const float* left, int count) {
  for (int i = 0; i < count; ++i) power[i] *= left[i] * left[i];
}

/// What surface `layer` is painted over at node `n`.
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

}  // namespace

double TissuePower::reach_m(const hw::AcquisitionPlan& plan) {
  double widest = widest_sigma(plan, plan.acquisition().depth_m);
  for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
    widest = std::max(widest, widest_sigma(plan, plan.sample_range_m(k)));
  }
  return std::min(kReachSigmas * widest, kMostReach_m);
}

TissuePower::TissuePower(const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options,
                         const std::vector<phantoms::Material>& materials,
                         double spacing_m,
                         int samples,
                         double reach_m)
    : materials_(&materials), options_(options), spacing_m_(spacing_m) {
  const auto squared = [](double x) { return static_cast<float>(x * x); };
  pulse2_ = squared(power_sigma(axial_fwhm_m(plan)));
  most2_ = squared(reach_m / kReachSigmas);
  for (int i = 0; i < samples; ++i) {
    const double range_m = (i + 0.5) * spacing_m;
    widths_.push_back({squared(power_sigma(lateral_fwhm_m(plan, range_m))),
                       squared(power_sigma(elevation_fwhm_m(plan, range_m)))});
  }
  const double rayleigh = options.speckle ? kPowerOfRayleighMean : 1;
  for (const auto& material : materials) {
    const double mean = amplitude_of_db(material.backscatter_db);
    const bool echoes = material.backscatter_db > kSilent_db;
    tissue_power_.push_back(echoes ? static_cast<float>(rayleigh * mean * mean) : 0.0f);
  }
}

float TissuePower::material_power(phantoms::MaterialIndex material) const {
  return tissue_power_[static_cast<std::size_t>(material)];
}

void TissuePower::compute(const StickTrack& track,
                          const StickLosses& losses,
                          std::span<float> power) {
  const int end = static_cast<int>(losses.left().size());
  int next = 0;
  for (const TrackPiece& piece : track.pieces) {
    const double to_m = losses.apparent_m(track, piece.to_m);
    const int first = next;
    const bool is_last = &piece == &track.pieces.back();
    next = is_last ? end : first_beyond(to_m, first, end);
    if (first == next) continue;
    if (piece.layers == 0) {
      fill_clear(piece, first, next, power);
    } else {
      if (layers_.size() < static_cast<std::size_t>(piece.layers)) {
        layers_.resize(static_cast<std::size_t>(piece.layers));
      }
      for (int layer = 0; layer < piece.layers; ++layer) {
        prepare(track, losses, piece, layer, layers_[static_cast<std::size_t>(layer)]);
      }
      blend(piece, losses, first, next, power);
    }
  }
  weaken(power.data(), losses.left().data(), end);
  std::fill(power.begin() + end, power.end(), 0.0f);
}

int TissuePower::first_beyond(double range_m, int first, int end) const {
  const auto near = static_cast<int>(range_m / spacing_m_) - 1;
  int sample = std::clamp(near, first, end);
  while (sample < end && (sample + 0.5) * spacing_m_ < range_m) ++sample;
  return sample;
}

void TissuePower::fill_clear(const TrackPiece& piece,
                             int first,
                             int last,
                             std::span<float> power) const {
  std::fill(power.begin() + first, power.begin() + last, material_power(piece.base));
}

void TissuePower::prepare(const StickTrack& track,
                          const StickLosses& losses,
                          const TrackPiece& piece,
                          int layer,
                          Layer& prepared) const {
  const TrackLayer& source = track.layers[static_cast<std::size_t>(piece.first_layer + layer)];
  prepared.power = material_power(source.inside);
  prepared.depth.clear();
  prepared.sheet.clear();
  const double step_m = (piece.to_m - piece.from_m) / (piece.nodes - 1);
  const TissueMap::LineNode* nodes =
      track.nodes.data() + static_cast<std::ptrdiff_t>(source.first_node);
  bool beside = true, around = true;
  NodeLanes lanes;
  TissueMap::LineNode padded[kNodeLanes];
  for (int first = 0; first < piece.nodes; first += kNodeLanes) {
    const int used = std::min(kNodeLanes, piece.nodes - first);
    for (int i = 0; i < used; ++i) {
      const auto sample = static_cast<std::size_t>(
          std::clamp(static_cast<int>((piece.from_m + (first + i) * step_m) / spacing_m_),
                     0,
                     static_cast<int>(widths_.size()) - 1));
      lanes.lateral2[i] = widths_[sample].lateral2;
      lanes.elevation2[i] = widths_[sample].elevation2;
    }
    std::fill(lanes.lateral2 + used, lanes.lateral2 + kNodeLanes, 0.0f);
    std::fill(lanes.elevation2 + used, lanes.elevation2 + kNodeLanes, 0.0f);
    std::copy_n(nodes + first, used, padded);
    scale_nodes(padded, pulse2_, most2_, lanes);
    for (int i = 0; i < used; ++i) {
      const float depth = lanes.depth[i], width = lanes.width[i];
      beside = beside && depth > kFarAway;
      around = around && depth < -kFarAway;
      prepared.depth.push_back(depth);
      // One node beyond, for the samples before it.
      const bool shows =
          options_.interface_echo &&
          std::abs(padded[i].value_m) < kFarAway * width + static_cast<float>(step_m);
      prepared.sheet.push_back(shows ? sheet_power(track, losses, piece, layer, first + i, width)
                                     : 0);
    }
  }
  prepared.cover = beside ? Layer::beside : around ? Layer::around : Layer::partly;
  // Samples just before the last node interpolate to the one behind it.
  prepared.depth.push_back(prepared.depth.back());
  prepared.sheet.push_back(prepared.sheet.back());
}

float TissuePower::sheet_power(const StickTrack& track,
                               const StickLosses& losses,
                               const TrackPiece& piece,
                               int layer,
                               int n,
                               float width) const {
  const TrackLayer& surface = track.layers[static_cast<std::size_t>(piece.first_layer + layer)];
  const auto outside = material_beneath(track, piece, layer, n);
  if (outside == surface.inside) return 0;
  const TissueMap::LineNode& node = track.nodes[static_cast<std::size_t>(surface.first_node + n)];
  const float slope = std::sqrt(node.axial * node.axial + node.lateral * node.lateral +
                                node.elevation * node.elevation);
  if (!(slope > 0)) return 0;
  const bool entering = node.axial < 0;
  const auto& out = materials_->at(static_cast<std::size_t>(outside));
  const auto& in = materials_->at(static_cast<std::size_t>(surface.inside));
  const double along = std::abs(static_cast<double>(node.axial));
  const double mean =
      diffuse_echo(entering ? out : in, entering ? in : out, along / static_cast<double>(slope));
  // A sheet has its peak from the pulse alone; a wider footprint spreads it along the stick.
  const double peak = std::sqrt(static_cast<double>(pulse2_)) * along / static_cast<double>(width);
  const double step_m = (piece.to_m - piece.from_m) / (piece.nodes - 1);
  const double gain = front_gain(track, losses, node, piece.from_m + n * step_m);
  const double rayleigh = options_.speckle ? kPowerOfRayleighMean : 1;
  return static_cast<float>(rayleigh * mean * mean * peak * gain * gain);
}

double TissuePower::front_gain(const StickTrack& track,
                               const StickLosses& losses,
                               const TissueMap::LineNode& node,
                               double range_m) const {
  const bool behind = (node.axial < 0) == (node.value_m < 0);
  const double to_surface_m = static_cast<double>(-node.value_m / node.axial);
  constexpr double kSamePlace_m = 2e-3;  // farther off it is another part of the surface
  if (!behind || !(std::abs(to_surface_m) < kSamePlace_m)) return 1;
  const auto& left = losses.left();
  const auto here = static_cast<int>(losses.apparent_m(track, range_m) / spacing_m_);
  const double surface = losses.apparent_m(track, range_m + to_surface_m) / spacing_m_;
  const int before = static_cast<int>(std::ceil(surface - 0.5)) - 1;
  const int end = static_cast<int>(left.size());
  if (before < 0 || before >= end || here >= end) return 1;
  return static_cast<double>(left[static_cast<std::size_t>(before)] /
                             left[static_cast<std::size_t>(here)]);
}

void TissuePower::blend(const TrackPiece& piece,
                        const StickLosses& losses,
                        int first,
                        int last,
                        std::span<float> power) {
  const auto count = static_cast<std::size_t>(last - first);
  const double per_node = (piece.nodes - 1) / (piece.to_m - piece.from_m);
  place_.resize(count);
  place_samples(first,
                last - first,
                spacing_m_,
                losses.delay_m().empty() ? nullptr : losses.delay_m().data(),
                piece.from_m,
                per_node,
                static_cast<double>(piece.nodes - 1),
                place_.data());
  tissue_.assign(count, material_power(piece.base));
  sheet_.assign(count, 0.0f);
  for (int l = 0; l < piece.layers; ++l) {
    const Layer& layer = layers_[static_cast<std::size_t>(l)];
    if (layer.cover == Layer::beside) continue;
    if (layer.cover == Layer::around) {
      std::fill(tissue_.begin(), tissue_.end(), layer.power);
      std::fill(sheet_.begin(), sheet_.end(), 0.0f);
      continue;
    }
    paint(layer.depth.data(),
          layer.sheet.data(),
          layer.power,
          place_.data(),
          last - first,
          tissue_.data(),
          sheet_.data());
  }
  for (std::size_t i = 0; i < count; ++i) {
    power[static_cast<std::size_t>(first) + i] = tissue_[i] + sheet_[i];
  }
}

}  // namespace wobblebench::sim
