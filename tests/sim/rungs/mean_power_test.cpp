// The closed form of the beam's average against a brute-force sum over its cross-section.
#include "sim/rungs/mean_power.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "sim/losses/losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/optics/pulse_band.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {
namespace {

constexpr double kRadius_m = 20e-3;
constexpr double kPowerSpacing_m = 0.1e-3;
constexpr int kPowerSamples = 1000;
const glm::dvec3 kCenter{0, 0, 0.11};

const hw::AcquisitionPlan& power_plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

const ProbeOptics& optics() {
  static const ProbeOptics shared(power_plan());
  return shared;
}

SimulationOptions tissue_alone() {
  SimulationOptions options;
  options.speckle = false;
  options.attenuation = false;
  options.transmission_loss = false;
  options.interface_echo = false;
  options.noise_db = kZeroAmplitude_db;
  options.output = hw::SampleScale::linear_envelope;
  return options;
}

struct Scanned {
  phantoms::Phantom phantom;
  ScannedTissue tissue;
};

Scanned sphere() {
  auto phantom = phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m});
  const double reach_m = MeanPower::reach_m(power_plan());
  ScannedTissue tissue{std::make_shared<const TissueMap>(phantom, reach_m, 0),
                       phantom.materials(),
                       {glm::dmat3(1.0), kCenter},
                       {}};
  return {std::move(phantom), std::move(tissue)};
}

std::vector<float> power_of(const Scanned& scanned,
                            const hw::Ray& stick,
                            const SimulationOptions& options) {
  StickTrack track;
  follow(scanned.tissue, {stick, 0}, kPowerSamples * kPowerSpacing_m, track);
  const auto& materials = scanned.tissue.materials;
  StickLosses losses(power_plan(), options, materials, kPowerSpacing_m, kPowerSamples);
  losses.compute(track);
  MeanPower power(
      optics(), options, materials, kPowerSpacing_m, kPowerSamples, scanned.tissue.map->reach_m());
  std::vector<float> result(kPowerSamples);
  power.compute(track, losses, stick_angle_rad(stick), result);
  return result;
}

double tissue_power() {
  return std::pow(10, phantoms::material("soft_tissue").backscatter_db / 10);
}

/// Share of the beam's power at a range that lies inside the sphere, summed over its footprint and
/// the pulse.
double share_inside(const hw::Ray& stick, double range_m) {
  const auto across = across_stick(stick);
  const double lateral = sigma_of_fwhm(optics().profile().lateral_fwhm_m(range_m)) / std::sqrt(2.0);
  const double elevation =
      sigma_of_fwhm(optics().profile().elevation_fwhm_m(range_m)) / std::sqrt(2.0);
  const double axial = sigma_of_fwhm(axial_fwhm_m(power_plan())) / std::sqrt(2.0);
  double inside = 0, all = 0;
  constexpr int kHalf = 12;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int j = -kHalf; j <= kHalf; ++j) {
      for (int k = -kHalf; k <= kHalf; ++k) {
        const double u = 4.0 * i / kHalf, v = 4.0 * j / kHalf, w = 4.0 * k / kHalf;
        const double weight = std::exp(-0.5 * (u * u + v * v + w * w));
        const glm::dvec3 position = stick.at(range_m + w * axial) + u * lateral * across.lateral +
                                    v * elevation * across.elevation;
        all += weight;
        if (glm::distance(position, kCenter) < kRadius_m) inside += weight;
      }
    }
  }
  return inside / all;
}

TEST(MeanPower, BlursASphereAsTheBeamDoes) {
  const Scanned scanned = sphere();
  // Across the beam a sphere recedes by the squared beam width over its diameter: at normal
  // incidence, where only the pulse blurs the edge, the edge shifts by this.
  constexpr double kShift_m = 0.06e-3;
  constexpr double kTolerance = 0.045;
  // From normal incidence to sticks whose axis misses the sphere.
  for (double theta : {0.0, 0.06, 0.12, 0.16, 0.18, 0.19, 0.2}) {
    for (double phi : {0.0, 0.1}) {
      const hw::Ray stick = power_plan().geometry().stick(theta, phi);
      const auto power = power_of(scanned, stick, tissue_alone());
      for (int i = 420; i < 760; i += 10) {
        const double range_m = (i + 0.5) * kPowerSpacing_m;
        const double found =
            static_cast<double>(power[static_cast<std::size_t>(i)]) / tissue_power();
        const auto [low, high] = std::minmax(
            {share_inside(stick, range_m - kShift_m), share_inside(stick, range_m + kShift_m)});
        EXPECT_GT(found, low - kTolerance) << theta << " " << phi << " " << range_m;
        EXPECT_LT(found, high + kTolerance) << theta << " " << phi << " " << range_m;
      }
    }
  }
}

TEST(MeanPower, RoughSurfaceHasTheEchoOfItsReflection) {
  Scanned scanned = sphere();
  auto options = tissue_alone();
  options.interface_echo = true;
  const auto power = power_of(scanned, power_plan().geometry().stick(0, 0), options);
  const auto without = power_of(scanned, power_plan().geometry().stick(0, 0), tissue_alone());
  double peak = 0;
  for (int i = 450; i < 550; ++i) {
    const auto s = static_cast<std::size_t>(i);
    peak = std::max(peak, static_cast<double>(power[s] - without[s]));
  }
  const double echo =
      diffuse_echo(phantoms::material("amniotic_fluid"), phantoms::material("soft_tissue"), 1);
  // The surface lies half a sample from the nearest one.
  const double off = kPowerSpacing_m / 2 / sigma_of_fwhm(axial_fwhm_m(power_plan()));
  EXPECT_NEAR(std::sqrt(peak) / echo, std::exp(-0.5 * off * off), 0.01);
}

/// A sphere within a sphere, its wall thinner than a cell of the map.
Scanned shell(double wall_m) {
  const auto outer = phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m});
  const auto inner = phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m - wall_m});
  auto surfaces = outer.surfaces();
  surfaces.push_back({"core", phantoms::material_index("cortical_bone"), false});
  auto grids = std::make_shared<phantoms::Grids>();
  grids->signed_distance = {outer.grids().signed_distance[0], inner.grids().signed_distance[0]};
  phantoms::Phantom phantom("shell",
                            phantoms::material_table(),
                            phantoms::material_index("amniotic_fluid"),
                            {{"wall", phantoms::material_index("soft_tissue"), false}, surfaces[1]},
                            outer.region_of_interest(),
                            outer.suggested_position_m(),
                            std::move(grids));
  ScannedTissue tissue{
      std::make_shared<const TissueMap>(phantom, MeanPower::reach_m(power_plan()), 0),
      phantom.materials(),
      {glm::dmat3(1.0), kCenter},
      {}};
  return {std::move(phantom), std::move(tissue)};
}

TEST(MeanPower, PaintsSurfacesInTheirOrder) {
  constexpr double kWall_m = 0.6e-3;
  const auto power = power_of(shell(kWall_m), power_plan().geometry().stick(0, 0), tissue_alone());
  const auto power_in = [](const char* name) {
    return std::pow(10, phantoms::material(name).backscatter_db / 10);
  };
  const double pulse_m = sigma_of_fwhm(axial_fwhm_m(power_plan())) / std::sqrt(2.0);
  const auto outside = [&](double range_m, double surface_m) {
    return 0.5 * (1 + std::erf((surface_m - range_m) / pulse_m / std::sqrt(2.0)));
  };
  const double wall_m = kCenter.z - power_plan().probe().radius_m - kRadius_m;
  double most = 0;
  for (int i = 480; i < 560; ++i) {
    const double range_m = (i + 0.5) * kPowerSpacing_m;
    // A later surface hides the ones before it within its blur.
    const double wall = power_in("soft_tissue") * (1 - outside(range_m, wall_m));
    const double behind = outside(range_m, wall_m + kWall_m);
    const double expected = wall * behind + power_in("cortical_bone") * (1 - behind);
    EXPECT_NEAR(power[static_cast<std::size_t>(i)], expected, 0.03 * power_in("cortical_bone"))
        << range_m;
    most = std::max(most, expected);
  }
  EXPECT_GT(most, 0.9 * power_in("cortical_bone"));
}

/// Pieces of random lengths, without surfaces, and inside, outside or on surfaces.
StickTrack patchwork(std::mt19937& generator) {
  std::uniform_int_distribution<int> length(1, 60), kind(0, 2);
  std::uniform_int_distribution<phantoms::MaterialIndex> material(
      0, static_cast<phantoms::MaterialIndex>(phantoms::material_table().size()) - 1);
  StickTrack track;
  track.stretches = {{0, kPowerSamples * kPowerSpacing_m, 0}};
  for (int first = 0; first < kPowerSamples;) {
    const int next = std::min(first + length(generator), kPowerSamples);
    TrackPiece piece{first * kPowerSpacing_m, next * kPowerSpacing_m, material(generator)};
    if (kind(generator) > 0) {
      piece.first_layer = static_cast<int>(track.layers.size());
      piece.layers = kind(generator);
      piece.nodes = 3;
      for (int layer = 0; layer < piece.layers; ++layer) {
        track.layers.push_back({layer, material(generator), static_cast<int>(track.nodes.size())});
        const auto value_m = static_cast<float>(kind(generator) - 1);
        track.nodes.insert(track.nodes.end(), 3, {value_m, 1, 0, 0});
      }
    }
    track.pieces.push_back(piece);
    first = next;
  }
  return track;
}

double power_of(phantoms::MaterialIndex material) {
  const double db = phantoms::material_table()[static_cast<std::size_t>(material)].backscatter_db;
  return db > kZeroAmplitude_db ? std::pow(10, db / 10) : 0;
}

/// Power by blending layer over layer, each by the share of the beam inside it.
double power_of(const StickTrack& track, const TrackPiece& piece) {
  double power = power_of(piece.base);
  for (int i = piece.first_layer; i < piece.first_layer + piece.layers; ++i) {
    const TrackLayer& layer = track.layers[static_cast<std::size_t>(i)];
    const float value_m = track.nodes[static_cast<std::size_t>(layer.first_node)].value_m;
    const double within = value_m < 0 ? 1 : value_m > 0 ? 0 : 0.5;
    power += within * (power_of(layer.inside) - power);
  }
  return power;
}

/// Vectorised loops process several pieces at once, and write past their ends.
TEST(MeanPower, EachPieceEchoesAsItsTissue) {
  const auto& materials = phantoms::material_table();
  StickLosses losses(power_plan(), tissue_alone(), materials, kPowerSpacing_m, kPowerSamples);
  MeanPower beam(optics(), tissue_alone(), materials, kPowerSpacing_m, kPowerSamples, 4e-3);
  std::mt19937 generator(13);
  std::vector<float> found(kPowerSamples);
  for (int run = 0; run < 200; ++run) {
    const StickTrack track = patchwork(generator);
    losses.compute(track);
    ASSERT_TRUE(beam.compute(track, losses, 0, found));
    for (const TrackPiece& piece : track.pieces) {
      const double expected = power_of(track, piece);
      for (int i = losses.samples_before(piece.from_m); i < losses.samples_before(piece.to_m);
           ++i) {
        ASSERT_NEAR(found[static_cast<std::size_t>(i)], expected, 1e-6 * expected)
            << run << " " << i;
      }
    }
  }
}

/// A plane 50 mm from the face, of material 1 behind material 0.
StickTrack inclined_plane(double angle_rad) {
  constexpr double kPlane_m = 50e-3, kHalf_m = 8e-3, kDepth_m = kPowerSamples * kPowerSpacing_m;
  constexpr int kNodes = 65;
  StickTrack track;
  track.stretches = {{0, kPlane_m, 0}, {kPlane_m, kDepth_m, 1}};
  track.interfaces = {{kPlane_m, 0, 1, std::cos(angle_rad)}};
  track.pieces = {{0, kPlane_m - kHalf_m, 0},
                  {kPlane_m - kHalf_m, kPlane_m + kHalf_m, 0, 0, 1, kNodes},
                  {kPlane_m + kHalf_m, kDepth_m, 1}};
  track.layers = {{0, 1, 0}};
  for (int n = 0; n < kNodes; ++n) {
    const double to_plane_m = kHalf_m * (1 - 2.0 * n / (kNodes - 1));
    track.nodes.push_back({static_cast<float>(to_plane_m * std::cos(angle_rad)),
                           static_cast<float>(-std::cos(angle_rad)),
                           static_cast<float>(std::sin(angle_rad)),
                           0});
  }
  return track;
}

/// The beam smears the echo of a rough surface along the stick, and keeps its energy: that of the
/// pulse at normal incidence, times the squared mean amplitude. Beyond the critical angle of bone
/// (here below 26 degrees) nothing comes back from behind the surface, but the smeared echo does.
TEST(MeanPower, RoughSurfaceKeepsItsEnergyAtEveryAngle) {
  auto materials = std::vector{phantoms::material("water"), phantoms::material("cortical_bone")};
  for (auto& each : materials) each.backscatter_db = kZeroAmplitude_db;
  auto hidden = tissue_alone(), displayed = hidden;
  hidden.interface_echo = hidden.transmission_loss = true;
  displayed = hidden;
  displayed.noise_db = -95;
  for (const auto& options : {hidden, displayed}) {
    StickLosses losses(power_plan(), options, materials, kPowerSpacing_m, kPowerSamples);
    MeanPower beam(optics(), options, materials, kPowerSpacing_m, kPowerSamples, 4e-3);
    for (const double angle_deg : {20.0, 24.0, 26.0, 28.0, 30.0, 40.0, 60.0}) {
      const StickTrack track = inclined_plane(angle_deg * kDegree);
      std::vector<float> power(kPowerSamples);
      losses.compute(track);
      beam.compute(track, losses, 0, power);
      double energy = 0;
      for (const float each : power) energy += static_cast<double>(each) * kPowerSpacing_m;
      const double mean = diffuse_echo(materials[0], materials[1], std::cos(angle_deg * kDegree));
      const double pulse_m = sigma_of_fwhm(axial_fwhm_m(power_plan())) / std::sqrt(2.0);
      const double expected = mean * mean * pulse_m * std::sqrt(2 * kPi);
      EXPECT_NEAR(10 * std::log10(energy / expected), 0, 0.1) << angle_deg;
    }
  }
}

TEST(MeanPower, FluidIsAnechoic) {
  const Scanned scanned = sphere();
  for (float value : power_of(scanned, power_plan().geometry().stick(0.5, 0.4), tissue_alone())) {
    ASSERT_EQ(value, 0.0f);
  }
}

}  // namespace
}  // namespace wobblebench::sim
