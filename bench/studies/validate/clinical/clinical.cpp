#include "bench/studies/validate/clinical/clinical.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::bench {

namespace {

constexpr int kSeeds = 3;
constexpr int kGreys = 256;
/// From the wall and from the face, within which a sample is not of fluid alone.
constexpr double kBehindWall_m = 1e-3, kBeforeFace_m = 2e-3;
/// The middle of the field, and the part of a stick about its first skin.
constexpr double kMiddle_rad = 12 * kDegree;
constexpr double kBeforeSkin_m = 6e-3, kBehindSkin_m = 20e-3;

/// Materials of one stick's samples, as far as this study asks.
class StickMaterials {
 public:
  StickMaterials(const phantoms::PlacedPhantom& subject,
                 const sim::TissueMap& map,
                 const hw::AcquisitionPlan& plan,
                 const hw::StickIndex& index) {
    const hw::Ray ray = sim::stick_ray(plan, index).ray;
    for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
      const glm::dvec3 at_m = ray.origin + plan.sample_range_m(k) * ray.direction;
      material_.push_back(map.material(subject.to_rest(at_m, 0)));
    }
  }

  /// First sample of a material; the number of samples if there is none.
  int first(phantoms::MaterialIndex material) const {
    return static_cast<int>(std::find(material_.begin(), material_.end(), material) -
                            material_.begin());
  }
  /// Sample behind the last one of a material before `end`.
  int behind(phantoms::MaterialIndex material, int end) const {
    while (end > 0 && of(end - 1) != material) --end;
    return end;
  }
  phantoms::MaterialIndex of(int sample) const {
    return material_[static_cast<std::size_t>(sample)];
  }
  int count() const { return static_cast<int>(material_.size()); }

 private:
  std::vector<phantoms::MaterialIndex> material_;
};

/// Counts one volume.
class GreyCount {
 public:
  explicit GreyCount(const Scan& scan)
      : scan_(scan),
        spacing_m_(scan.plan.sample_spacing_m()),
        before_(static_cast<int>(kBeforeSkin_m / spacing_m_)),
        band_(static_cast<std::size_t>(before_) +
              static_cast<std::size_t>(kBehindSkin_m / spacing_m_)) {
    for (const float sample : scan.samples) ++greys_[static_cast<std::size_t>(grey_of(sample))];
  }

  void add(const StickMaterials& stick, int frame, int line) {
    const int face = stick.first(phantoms::material_index("fetal_skin"));
    if (face == stick.count()) return;
    const auto fluid = phantoms::material_index("amniotic_fluid");
    const int wall = stick.behind(phantoms::material_index("uterus_wall"), face);
    const int from = wall + static_cast<int>(kBehindWall_m / spacing_m_);
    const int to = face - static_cast<int>(kBeforeFace_m / spacing_m_);
    for (int k = from; k < to; ++k) {
      if (stick.of(k) != fluid) continue;
      ++fluid_;
      dark_ += grey_of(scan_.at(frame, line, k)) == 0 ? 1 : 0;
    }
    const int first = face - before_;
    const bool in_middle = std::abs(scan_.plan.theta_rad(line)) < kMiddle_rad &&
                           std::abs(scan_.plan.frame_phi_rad(frame)) < kMiddle_rad;
    if (!in_middle || first < 0 || first + static_cast<int>(band_.size()) > stick.count()) return;
    for (std::size_t i = 0; i < band_.size(); ++i) {
      band_[i].add(scan_.at(frame, line, first + static_cast<int>(i)));
    }
  }

  GreyStatistics statistics() const {
    GreyStatistics found;
    found.fluid_samples = fluid_;
    found.zero_in_fluid_percent = 100.0 * static_cast<double>(dark_) / static_cast<double>(fluid_);
    for (std::size_t grey = 1; grey < greys_.size(); ++grey) found.samples += greys_[grey];
    found.full_percent =
        100.0 * static_cast<double>(greys_.back()) / static_cast<double>(found.samples);
    for (std::size_t i = 0; i < found.grey.size(); ++i) {
      found.grey[i] = percentile(GreyStatistics::kPercent[i], found.samples);
    }
    const auto bright = std::count_if(
        band_.begin(), band_.end(), [](const Moments& mean) { return mean.mean() > 0.5; });
    found.skin_m = static_cast<double>(bright) * spacing_m_;
    return found;
  }

 private:
  static int grey_of(double sample) {
    return static_cast<int>(std::lround(std::clamp(sample, 0.0, 1.0) * (kGreys - 1)));
  }
  /// Of those that are not zero.
  double percentile(double percent, long count) const {
    long below = 0;
    std::size_t grey = 0;
    while (grey + 1 < greys_.size() &&
           static_cast<double>(below) < percent / 100 * static_cast<double>(count)) {
      below += greys_[++grey];
    }
    return static_cast<double>(grey);
  }

  const Scan& scan_;
  double spacing_m_;
  int before_;
  std::vector<Moments> band_;
  std::array<long, kGreys> greys_{};
  long fluid_ = 0;
  long dark_ = 0;
};

}  // namespace

GreyStatistics measure_grey(const sim::SimulationOptions& options) {
  const auto phantom = phantoms::make_phantom({.name = "fetal_face"});
  const auto subject = phantoms::still_at(phantom, phantom.suggested_position_m());
  const hw::AcquisitionPlan plan({}, {});
  const Scan volume = scan(subject, plan, options);
  const sim::TissueMap map(phantom, 0, options.threads);
  GreyCount count(volume);
  for (int frame = 0; frame < plan.acquisition().frames_per_volume; ++frame) {
    for (int line = 0; line < plan.acquisition().sticks_per_frame; ++line) {
      const hw::StickIndex index{
          0, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)};
      count.add(StickMaterials(subject, map, plan, index), frame, line);
    }
  }
  return count.statistics();
}

namespace {

constexpr char kReal[] =
    "counts in fetal 4D volumes of a commercial scanner; tolerance: their range, and as much again";

/// A figure of real volumes: the middle of what was counted, and how far ours may lie.
struct Target {
  const char* name;
  double GreyStatistics::*value;
  double expected;
  double tolerance;
};
constexpr Target kShares[] = {
    {"zero_in_fluid", &GreyStatistics::zero_in_fluid_percent, 33, 8},
    {"full_scale", &GreyStatistics::full_percent, 11, 4},
};
constexpr double kGreyExpected[] = {4.5, 22.5, 60, 150, 255};
constexpr double kGreyTolerance[] = {3, 3, 12, 36, 2};

std::vector<GreyStatistics> over_seeds(sim::ScanPreset preset,
                                       const std::vector<std::uint64_t>& seeds) {
  std::vector<GreyStatistics> found;
  for (const std::uint64_t seed : seeds) {
    auto options = sim::simulation_preset(preset);
    options.fidelity = sim::Rung::field;
    options.seed = seed;
    found.push_back(measure_grey(options));
  }
  return found;
}

template <class Value>
double mean_of(const std::vector<GreyStatistics>& all, const Value& value) {
  double sum = 0;
  for (const GreyStatistics& one : all) sum += value(one);
  return sum / static_cast<double>(all.size());
}

}  // namespace

StudyReport clinical_report() {
  const auto seeds = seeds_from(1, kSeeds);
  const auto clean = over_seeds(sim::ScanPreset::clean, seeds);
  const auto clinical = over_seeds(sim::ScanPreset::clinical, seeds);
  StudyReport report;
  Table table{
      .name = "clinical",
      .columns = {
          {"statistic"}, {"real"}, {"clean", "clean", "", 1}, {"clinical", "clinical", "", 1}}};
  const auto row = [&](const std::string& name, const std::string& real, const auto& value) {
    table.add({name, real, mean_of(clean, value), mean_of(clinical, value)});
    report.point(name, {"seeds", kSeeds}, {"clinical", mean_of(clinical, value)});
    return mean_of(clinical, value);
  };
  for (const Target& target : kShares) {
    const auto value = [&](const GreyStatistics& one) { return one.*target.value; };
    const bool is_fluid = target.value == &GreyStatistics::zero_in_fluid_percent;
    const double found = row(is_fluid ? "zero, % of the samples in fluid before the face"
                                      : "at full scale, % of the samples that are not zero",
                             is_fluid ? "33" : "9 to 13",
                             value);
    report.check(std::string("clinical.") + target.name)
        .within(found, target.expected, target.tolerance, "%")
        .from(kReal)
        .over(is_fluid ? clinical.front().fluid_samples : clinical.front().samples,
              "samples a seed",
              seeds);
  }
  const char* real[] = {"3 to 6", "21 to 24", "54 to 66", "132 to 168", "255"};
  for (std::size_t i = 0; i < clinical.front().grey.size(); ++i) {
    const auto percent = std::to_string(static_cast<int>(GreyStatistics::kPercent[i]));
    const double found = row("grey that " + percent + " % of the samples that are not zero reach",
                             real[i],
                             [&](const GreyStatistics& one) { return one.grey[i]; });
    report.check("clinical.grey_p" + percent)
        .within(found, kGreyExpected[i], kGreyTolerance[i], "of 255")
        .from(kReal)
        .over(clinical.front().samples, "samples a seed", seeds);
  }
  const auto skin_mm = [](const GreyStatistics& one) { return 1e3 * one.skin_m; };
  const double thicker = row("skin above half of full scale, mm", "2 to 3 times clean", skin_mm) /
                         mean_of(clean, skin_mm);
  report.check("clinical.skin_thickness")
      .within(thicker, 2.5, 1, "times that of clean")
      .from(kReal)
      .over(kSeeds, "volumes", seeds);
  report.tables = {table};
  report.text =
      "The default face on the rung `field`, by the presets `clean` and `clinical`, as 8-bit grey "
      "levels. Counted in the samples; which of them are of fluid before the face, the phantom's "
      "materials say. What was fitted to the real figures are the preset's gain, dynamic range, "
      "time gain, haze and unevenness of tissue: the checks hold what was reached, and the table "
      "says where a figure lies outside what was counted in real volumes.";
  return report;
}

}  // namespace wobblebench::bench
