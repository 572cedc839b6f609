#include "bench/studies/validate/losses/attenuation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/yardstick.h"
#include "bench/studies/validate/losses/tissue_levels.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kCentimetre = 1e-2;
/// Sector and fan of the scans of plate and cyst: sticks nearly parallel to the axis.
constexpr double kNarrow_rad = 6 * kDegree;
constexpr double kBin_m = 1e-3;
/// Range behind a body that its own echo covers, and up to which it is evaluated.
constexpr double kSkip_m = 2e-3, kUpTo_m = 30e-3;

double power_db(double power) {
  return 10 * std::log10(power);
}

const TissueBand& standard_band() {
  static const TissueBand band(hw::ProbePreset::standard);
  return band;
}

/// Two-way attenuation of a centimetre of a material.
double loss_db_per_cm(const phantoms::Material& material, const hw::AcquisitionPlan& plan) {
  return 2 * material.attenuation_db_per_cm_mhz * plan.probe().center_frequency_hz / kMegahertz;
}

/// Two-way transmission of an interface at normal incidence: (1 + R) there, (1 - R) back.
double transmission_db(const phantoms::Material& a, const phantoms::Material& b) {
  const double r = (b.impedance_rayl - a.impedance_rayl) / (b.impedance_rayl + a.impedance_rayl);
  return 20 * std::log10(1 - r * r);
}

/// The chord of a ray through a body, as ranges.
struct Chord {
  double from_m = 0;
  double to_m = 0;
};

struct Body {
  phantoms::PlacedPhantom subject;
  std::function<Chord(const hw::Ray&)> chord;
  double per_cm_db = 0;  ///< change of the loss at the centre frequency per centimetre of the body
  double faces_db = 0;   ///< change of level by its two faces
  double from_m = 0;     ///< first and last range behind it that are evaluated
  double to_m = 0;
};

/// A body of `material` in soft tissue, evaluated from kSkip_m to kUpTo_m behind `back_z`.
Body body_of(const phantoms::Phantom& phantom,
             const std::string& material,
             double back_z,
             const hw::AcquisitionPlan& plan,
             std::function<Chord(const hw::Ray&)> chord) {
  const auto& tissue = phantoms::material("soft_tissue");
  const auto& other = phantoms::material(material);
  const double back_m = back_z - plan.probe().radius_m;
  return {phantoms::still_at(phantom, phantom.suggested_position_m()),
          std::move(chord),
          loss_db_per_cm(tissue, plan) - loss_db_per_cm(other, plan),
          2 * transmission_db(tissue, other),
          back_m + kSkip_m,
          back_m + kUpTo_m};
}

Body bone_plate(const hw::AcquisitionPlan& plan) {
  const phantoms::PhantomOptions options{.name = "bone_plate"};
  const auto phantom = phantoms::make_phantom(options);
  const double front_z = phantom.suggested_position_m().z, back_z = front_z + options.thickness_m;
  return body_of(phantom, "cortical_bone", back_z, plan, [=](const hw::Ray& ray) {
    return Chord{(front_z - ray.origin.z) / ray.direction.z,
                 (back_z - ray.origin.z) / ray.direction.z};
  });
}

Body cyst(const hw::AcquisitionPlan& plan) {
  const phantoms::PhantomOptions options{.name = "cyst"};
  const auto phantom = phantoms::make_phantom(options);
  const glm::dvec3 center = phantom.suggested_position_m();
  const double radius = options.radius_m;
  return body_of(phantom, "amniotic_fluid", center.z + radius, plan, [=](const hw::Ray& ray) {
    const double middle = glm::dot(center - ray.origin, ray.direction);
    const double aside = glm::length(center - ray.at(middle));
    const double half = std::sqrt(radius * radius - aside * aside);
    return Chord{middle - half, middle + half};
  });
}

hw::AcquisitionPlan narrow_plan(const AttenuationInputs& inputs) {
  return {{},
          {.depth_m = 0.14,
           .sector_rad = kNarrow_rad,
           .fan_rad = kNarrow_rad,
           .sticks_per_frame = inputs.sticks,
           .samples_per_stick = 448,
           .frames_per_volume = inputs.frames}};
}

double expected_db(const Body& body,
                   const hw::AcquisitionPlan& plan,
                   const Chord& chord,
                   double range_m) {
  if (range_m < chord.from_m) return 0;
  const auto& tissue = phantoms::material("soft_tissue");
  const double without_db = loss_db_per_cm(tissue, plan) * range_m / kCentimetre;
  const double with_db = without_db - body.per_cm_db * (chord.to_m - chord.from_m) / kCentimetre;
  const double center_hz = plan.probe().center_frequency_hz;
  return body.faces_db + standard_band().level_db(with_db, center_hz, range_m) -
         standard_band().level_db(without_db, center_hz, range_m);
}

/// Intensities with the body, without it, and without it times the expected factor.
struct Change {
  Moments with, without, predicted;

  void add(double here, double there, double factor) {
    with.add(here * here);
    without.add(there * there);
    predicted.add(there * there * factor);
  }
  double measured_db() const { return power_db(with.mean() / without.mean()); }
  double expected_db() const { return power_db(predicted.mean() / without.mean()); }
};

/// One stick of both scans: into its bins of range, and into all behind the body.
void add_stick(const std::vector<double>& with,
               const std::vector<double>& without,
               const hw::AcquisitionPlan& plan,
               const Body& body,
               const Chord& chord,
               std::vector<Change>& bins,
               Change& behind) {
  for (std::size_t k = 0; k < with.size(); ++k) {
    const double r = plan.sample_range_m(static_cast<int>(k));
    const bool inside = r > chord.from_m - kBin_m && r < chord.to_m + kBin_m;
    const double factor = inside ? std::numeric_limits<double>::quiet_NaN()
                                 : std::pow(10.0, expected_db(body, plan, chord, r) / 10);
    bins[static_cast<std::size_t>(r / kBin_m)].add(with[k], without[k], factor);
    if (r >= body.from_m && r <= body.to_m) behind.add(with[k], without[k], factor);
  }
}

ShadowResult measure_body(sim::Rung rung,
                          const AttenuationInputs& inputs,
                          Body (*make)(const hw::AcquisitionPlan&)) {
  const hw::AcquisitionPlan plan = narrow_plan(inputs);
  const Body body = make(plan);
  std::vector<Change> bins(static_cast<std::size_t>(plan.acquisition().depth_m / kBin_m));
  Change behind;
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = bare_envelope(rung, seed);
    options.interface_echo = false;
    const Scan with = scan(body.subject, plan, options);
    const Scan without = scan({open_tissue()}, plan, options);
    for (int f = 0; f < inputs.frames; ++f) {
      for (int l = 0; l < inputs.sticks; ++l) {
        const auto ray = plan.geometry().stick(plan.theta_rad(l), plan.frame_phi_rad(f));
        add_stick(with.stick(f, l), without.stick(f, l), plan, body, body.chord(ray), bins, behind);
      }
    }
  }
  ShadowResult result;
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    result.range_m.push_back((static_cast<double>(bin) + 0.5) * kBin_m);
    result.change_db.push_back(bins[bin].measured_db());
    result.expected_db.push_back(bins[bin].expected_db());
  }
  result.behind_db = behind.measured_db();
  result.expected_behind_db = behind.expected_db();
  result.n = static_cast<long>(behind.with.count);
  return result;
}

}  // namespace

SlopeResult measure_slope(sim::Rung rung, bool speckle, const AttenuationInputs& inputs) {
  constexpr double kFrom_m = 20e-3, kTo_m = 120e-3;
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = 0.125,
                                  .sector_rad = inputs.sector_rad,
                                  .fan_rad = inputs.fan_rad,
                                  .sticks_per_frame = inputs.sticks,
                                  .samples_per_stick = 400,
                                  .frames_per_volume = inputs.frames});
  std::vector<Moments> rows(400);
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = bare_envelope(rung, seed);
    options.speckle = speckle;
    const Scan volume = scan({open_tissue()}, plan, options);
    for (int f = 0; f < inputs.frames; ++f) {
      for (int l = 0; l < inputs.sticks; ++l) {
        for (int k = 0; k < 400; ++k) {
          rows[static_cast<std::size_t>(k)].add(volume.at(f, l, k) * volume.at(f, l, k));
        }
      }
    }
  }
  SlopeResult result;
  for (int k = 0; k < 400; ++k) {
    const double r = plan.sample_range_m(k);
    if (r < kFrom_m || r > kTo_m) continue;
    result.range_m.push_back(r);
    result.level_db.push_back(power_db(rows[static_cast<std::size_t>(k)].mean()));
    result.n += static_cast<long>(rows[static_cast<std::size_t>(k)].count);
  }
  result.slope_db_per_cm = kCentimetre * fit_line(result.range_m, result.level_db).slope;
  const double per_cm_db = loss_db_per_cm(phantoms::material("soft_tissue"), plan);
  for (const double r : result.range_m) {
    result.expected_db.push_back(
        standard_band().level_db(per_cm_db * r / kCentimetre, plan.probe().center_frequency_hz, r));
  }
  result.expected_db_per_cm = kCentimetre * fit_line(result.range_m, result.expected_db).slope;
  const double offset_db = result.level_db.front() - result.expected_db.front();
  for (double& level_db : result.expected_db) level_db += offset_db;
  return result;
}

ShadowResult measure_bone_shadow(sim::Rung rung, const AttenuationInputs& inputs) {
  return measure_body(rung, inputs, bone_plate);
}

ShadowResult measure_cyst_enhancement(sim::Rung rung, const AttenuationInputs& inputs) {
  return measure_body(rung, inputs, cyst);
}

namespace {

constexpr double kSlopeTolerance = 0.02;
constexpr double kLevelTolerance_db = 1;
/// Samples between two marks of the chart.
constexpr std::size_t kBetweenMarks = 16;

void add_slope(const std::string& name,
               const SlopeResult& found,
               const std::vector<std::uint64_t>& seeds,
               StudyReport& report,
               Chart& chart) {
  const double expected = found.expected_db_per_cm;
  report.check("attenuation.slope." + name)
      .within(found.slope_db_per_cm, expected, kSlopeTolerance * std::abs(expected), "dB/cm")
      .from("a line through the band's sum of soft_tissue (tissue_band.csv)")
      .over(found.n, "samples", seeds);
  Series series{name, {}, {}, Stroke::none, chart.series.empty() ? Mark::disc : Mark::ring};
  for (std::size_t i = 0; i < found.range_m.size(); ++i) {
    const double mm = found.range_m[i] * 1e3, level_db = found.level_db[i];
    report.point("slope " + name, {"range_mm", mm}, {"level_db", level_db, found.expected_db[i]});
    if (i % kBetweenMarks == 0) series.add(mm, level_db);
  }
  chart.series.push_back(series);
}

void add_body(const std::string& body,
              const std::string& rung,
              const ShadowResult& found,
              const std::vector<std::uint64_t>& seeds,
              StudyReport& report,
              Chart& chart) {
  report.check("attenuation." + body + "." + rung)
      .within(found.behind_db, found.expected_behind_db, kLevelTolerance_db, "dB")
      .from("the band's sum (tissue_band.csv) along the path through it, (1 - R^2) of its faces")
      .over(found.n, "samples", seeds);
  const bool first = chart.series.empty();
  Series measured{rung, {}, {}, Stroke::none, first ? Mark::disc : Mark::ring, first ? 0 : 1};
  Series expected{first ? "tissue_band.csv" : "", {}, {}, Stroke::solid, Mark::none, 6};
  for (std::size_t i = 0; i < found.range_m.size(); ++i) {
    const double mm = found.range_m[i] * 1e3, expected_db = found.expected_db[i];
    report.point(
        body + " " + rung, {"range_mm", mm}, {"change_db", found.change_db[i], expected_db});
    if (mm < 20) continue;
    expected.add(mm, expected_db);
    if (i % 2 == 0 && std::isfinite(expected_db)) measured.add(mm, found.change_db[i]);
  }
  if (first) chart.series.push_back(expected);
  chart.series.push_back(measured);
}

}  // namespace

StudyReport attenuation_report() {
  const AttenuationInputs inputs;
  StudyReport report;
  Chart slope{"Uniform tissue", {"range (mm)"}, {"mean intensity (dB against a mirror)"}};
  const auto steady = measure_slope(sim::Rung::field, false, inputs);
  add_slope("field_without_speckle", steady, inputs.seeds, report, slope);
  Chart shadow{"Behind 3 mm of bone", {"range (mm)"}, {"change of mean intensity (dB)"}};
  Chart enhancement{"Behind a cyst of 40 mm", {"range (mm)"}, {"change of mean intensity (dB)"}};
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    const std::string name = sim::to_string(rung);
    add_slope(name, measure_slope(rung, true, inputs), inputs.seeds, report, slope);
    const auto behind_bone = measure_bone_shadow(rung, inputs);
    add_body("bone_shadow", name, behind_bone, inputs.seeds, report, shadow);
    const auto behind_cyst = measure_cyst_enhancement(rung, inputs);
    add_body("cyst_enhancement", name, behind_cyst, inputs.seeds, report, enhancement);
  }
  add_tissue_levels(report);
  report.figures.push_back(
      {"attenuation_slope", "Mean intensity of uniform tissue, no time gain.", {slope}});
  report.figures.push_back(
      {"attenuation_shadow",
       "Left: behind the phantom bone_plate. Right: behind the phantom cyst. Both against the same "
       "tissue without it.",
       {shadow, enhancement}});
  report.text =
      "Linear envelope, no time gain, no noise, no interface echoes. Slope: uniform soft tissue, "
      "the mean intensity over all sticks at each range, a line through its logarithm from 20 to "
      "120 mm. Level: uniform tissue of three materials and of each preset, over the same without "
      "attenuation, at the ranges of `tissue_band.csv` up to 140 mm. Expected is the sum over the "
      "band of what uniform tissue echoes, each frequency attenuated by itself: low frequencies "
      "lose less, and of them a wider and, out of focus, more even beam hears more. Bone and cyst: "
      "sticks within 3 degrees of the axis, mean intensity from 2 to 30 mm behind the body over "
      "that of the same tissue without it; the expected value takes each stick's own path through "
      "the body, and reflection at normal incidence.";
  return report;
}

}  // namespace wobblebench::bench
