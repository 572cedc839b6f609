#include "bench/studies/rungs/rung_growth.h"
#include "base/units.h"

#include <algorithm>
#include <cmath>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"

namespace wobblebench::bench {

namespace {

/// A block wider and deeper than the field.
const glm::dvec3 kHalf_m{0.14, 0.13, 0.11};
constexpr double kVoxel_m = 4e-3;  // flat faces are exact at any voxel size

RungScene scene_with(const phantoms::Phantom& body,
                     double front_mm,
                     const hw::AcquisitionOptions& acquisition,
                     const sim::SimulationOptions& options) {
  const hw::AcquisitionPlan plan({}, acquisition);
  const double middle_m = plan.probe().radius_m + front_mm * kMillimetre + kHalf_m.z;
  return {phantoms::still_at(body, {0, 0, middle_m}), plan, options};
}

/// Fraction of the samples of a volume that are tissue, by rung `geometry`.
double tissue_fraction(const RungScene& scene) {
  auto options = scene.options;
  options.fidelity = sim::Rung::geometry;
  const auto samples = sim::ProbeSimulator(scene.subject, scene.plan, options).volume(0);
  const auto shown = std::count_if(samples.begin(), samples.end(), [](float v) { return v > 0; });
  return static_cast<double>(shown) / static_cast<double>(samples.size());
}

std::size_t number_of_points(const std::vector<sim::Rung>& rungs, const GrowthInputs& inputs) {
  const std::size_t on_each_rung =
      inputs.sticks.size() + inputs.frames.size() + inputs.samples.size() + inputs.front_mm.size();
  return rungs.size() * on_each_rung + inputs.scatterers.size();
}

class Growth {
 public:
  Growth(const std::vector<sim::Rung>& rungs,
         const sim::SimulationOptions& options,
         const GrowthInputs& inputs,
         const PartDone& done)
      : rungs_(rungs),
        options_(options),
        inputs_(inputs),
        body_(block(kHalf_m, kVoxel_m)),
        parts_(number_of_points(rungs, inputs), done) {}

  void vary(const std::string& what,
            const std::vector<int>& sizes,
            int hw::AcquisitionOptions::*field) {
    for (const int size : sizes) {
      auto acquisition = inputs_.acquisition;
      acquisition.*field = size;
      add(what, size, scene_with(body_, inputs_.base_front_mm, acquisition, options_));
    }
  }
  void vary_scatterers() {
    for (const double number : inputs_.scatterers) {
      auto options = options_;
      options.scatterers_per_cell = number;
      const auto scene = scene_with(body_, inputs_.base_front_mm, inputs_.acquisition, options);
      measure("scatterers", number, scene, sim::Rung::scatterers);
    }
  }
  void vary_tissue() {
    for (const double front : inputs_.front_mm) {
      const auto scene = scene_with(body_, front, inputs_.acquisition, options_);
      add("tissue", tissue_fraction(scene), scene);
    }
  }
  std::vector<GrowthPoint> take() { return std::move(points_); }

 private:
  void add(const std::string& what, double size, const RungScene& scene) {
    for (const sim::Rung rung : rungs_) measure(what, size, scene, rung);
  }
  void measure(const std::string& what, double size, const RungScene& scene, sim::Rung rung) {
    points_.push_back({what, size, rung, measure_volume(scene, rung, inputs_.repeats)});
    parts_.finish_one();
  }

  const std::vector<sim::Rung>& rungs_;
  sim::SimulationOptions options_;
  const GrowthInputs& inputs_;
  phantoms::Phantom body_;
  PartCount parts_;
  std::vector<GrowthPoint> points_;
};

}  // namespace

std::vector<GrowthPoint> measure_growth(const std::vector<sim::Rung>& rungs,
                                        const sim::SimulationOptions& options,
                                        const GrowthInputs& inputs,
                                        const PartDone& done) {
  Growth growth(rungs, options, inputs, done);
  growth.vary("sticks", inputs.sticks, &hw::AcquisitionOptions::sticks_per_frame);
  growth.vary("frames", inputs.frames, &hw::AcquisitionOptions::frames_per_volume);
  growth.vary("samples", inputs.samples, &hw::AcquisitionOptions::samples_per_stick);
  growth.vary_scatterers();
  growth.vary_tissue();
  return growth.take();
}

double growth_exponent(const std::vector<GrowthPoint>& points,
                       const std::string& what,
                       sim::Rung rung,
                       Spread VolumeTime::*time) {
  std::vector<double> x, y;
  for (const GrowthPoint& point : points) {
    if (point.what != what || point.rung != rung) continue;
    x.push_back(std::log(point.size));
    y.push_back(std::log((point.time.*time).median));
  }
  return fit_line(x, y).slope;
}

}  // namespace wobblebench::bench
