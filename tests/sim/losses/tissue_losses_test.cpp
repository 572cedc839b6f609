// Losses of even tissue over the pulse's band, against the element sum of tests/yardstick.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "base/units.h"
#include "sim/losses/tissue_gain.h"
#include "sim/probe_simulator.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

constexpr double kTolerance_db = 0.5;
/// At the ends of the sector, where half of the aperture is missing.
constexpr double kEdgeTolerance_db = 0.8;

/// Brain, soft tissue and uterine wall: one-way attenuation in dB/cm/MHz.
constexpr double kAlphas[] = {0.4, 0.5, 0.83};

struct Place {
  double sector_fraction;
  double depth_m;
  auto operator<=>(const Place&) const = default;
};

/// For each place the share of each frequency, in MHz, in the mean echo power of tissue.
using Bands = std::map<Place, std::map<double, double>>;

Bands bands_of(const std::string& preset) {
  Bands bands;
  for (const auto& row : yardstick("tissue_band", preset)) {
    const Place place{row.number("sector_fraction"), row.number("depth_mm") * 1e-3};
    bands[place][row.number("mhz")] += row.number("share");
  }
  return bands;
}

/// Each frequency attenuated by itself, there and back.
double left_db(const std::map<double, double>& band, double alpha, double depth_m) {
  double left = 0;
  for (const auto& [mhz, share] : band) {
    left += share * std::pow(10.0, -2 * alpha * mhz * depth_m * 1e2 / 10);
  }
  return 10 * std::log10(left);
}

/// A block of the same material as what surrounds it.
phantoms::Phantom even_tissue(double alpha) {
  static const auto block = std::make_shared<const phantoms::Phantom>(
      phantoms::make_phantom({.name = "speckle_block", .voxel_m = 1e-3}));
  auto materials = block->materials();
  const phantoms::MaterialIndex tissue = block->surfaces().front().inside;
  materials[static_cast<std::size_t>(tissue)].attenuation_db_per_cm_mhz = alpha;
  return {"even_tissue",
          materials,
          tissue,
          block->surfaces(),
          block->region_of_interest(),
          block->suggested_position_m(),
          {block, &block->grids()}};
}

struct Probe {
  hw::ProbePreset preset;
  const char* name;
};
constexpr Probe kProbes[] = {{hw::ProbePreset::standard, "standard"},
                             {hw::ProbePreset::c5_2v, "c5_2v"},
                             {hw::ProbePreset::curvilinear_60, "curvilinear_60"}};

/// Mean power within 2 mm of each depth, over the sticks of a volume.
class Volume {
 public:
  Volume(const hw::AcquisitionPlan& plan, Rung rung, double alpha) : plan_(plan) {
    SimulationOptions options;
    options.fidelity = rung;
    options.speckle = rung != Rung::field;
    options.aperture_losses = false;
    options.noise_db = kZeroAmplitude_db;
    options.output = hw::SampleScale::linear_envelope;
    options.tgc_db_per_cm_mhz = 0;
    options.interface_echo = false;
    options.low_pass = false;
    samples_ = ProbeSimulator(phantoms::still_at(even_tissue(alpha), {}), plan, options).volume(0);
  }

  double power(double depth_m) const {
    const auto& a = plan_.acquisition();
    double sum = 0;
    int count = 0;
    for (int stick = 0; stick < plan_.sticks_per_volume(); ++stick) {
      for (int k = 0; k < a.samples_per_stick; ++k) {
        if (std::abs(plan_.sample_range_m(k) - depth_m) > 2e-3) continue;
        const auto value = static_cast<double>(
            samples_[static_cast<std::size_t>(stick * a.samples_per_stick + k)]);
        sum += value * value;
        ++count;
      }
    }
    return sum / count;
  }

 private:
  hw::AcquisitionPlan plan_;
  VolumeSamples samples_;
};

hw::AcquisitionPlan narrow_plan(const Probe& probe) {
  return {hw::probe_preset(probe.preset).probe,
          {.depth_m = 0.16,
           .sector_rad = 20 * kDegree,
           .fan_rad = 60 * kDegree,
           .sticks_per_frame = 16,
           .samples_per_stick = 512,
           .frames_per_volume = 37}};
}

void expect_losses(Rung rung, std::span<const double> alphas) {
  for (const Probe& probe : kProbes) {
    const hw::AcquisitionPlan plan = narrow_plan(probe);
    const Volume lossless(plan, rung, 0);
    for (const double alpha : alphas) {
      const Volume volume(plan, rung, alpha);
      for (const auto& [place, band] : bands_of(probe.name)) {
        if (place.sector_fraction > 0 || place.depth_m > 140e-3) continue;
        const double found_db =
            10 * std::log10(volume.power(place.depth_m) / lossless.power(place.depth_m));
        EXPECT_NEAR(found_db, left_db(band, alpha, place.depth_m), kTolerance_db)
            << probe.name << " " << alpha << " " << place.depth_m;
      }
    }
  }
}

TEST(TissueLosses, FieldAttenuatesEachFrequencyByItself) {
  expect_losses(Rung::field, kAlphas);
}

TEST(TissueLosses, ScatterersAttenuateEachFrequencyByItself) {
  expect_losses(Rung::scatterers, kAlphas);
}

TEST(TissueLosses, AtTheEdgeOfTheSectorTheyAreThoseOfTheMiddle) {
  for (const Probe& probe : kProbes) {
    const ProbeOptics optics{hw::AcquisitionPlan(hw::probe_preset(probe.preset).probe, {})};
    const TissueGain gain(optics, optics.iq_spacing_m(), optics.iq_samples());
    const BandLoss band(optics.probe());
    for (const auto& [place, shares] : bands_of(probe.name)) {
      for (const double alpha : kAlphas) {
        const double nepers = two_way_nepers_per_m(optics.plan(), alpha) * place.depth_m;
        const auto ratio = static_cast<float>(band.frequency_ratio(nepers));
        const double mirror_db = 20 / std::log(10.0) * (band.log_gain(nepers) - nepers);
        const double found_db =
            mirror_db + 20 * std::log10(static_cast<double>(gain.at(place.depth_m, ratio)));
        EXPECT_NEAR(found_db,
                    left_db(shares, alpha, place.depth_m),
                    place.sector_fraction > 0 ? kEdgeTolerance_db : kTolerance_db)
            << probe.name << " " << alpha << " " << place.depth_m << " " << place.sector_fraction;
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
