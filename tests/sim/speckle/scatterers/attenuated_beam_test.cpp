// Echoes of tissue from a pulse that has lost its high frequencies.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "phantoms/phantom.h"
#include "sim/losses/losses.h"
#include "sim/optics/pulse_band.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

using Stick = std::vector<std::complex<float>>;

const hw::AcquisitionPlan& default_plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

/// By IQ sample, from 1 at the face to `lowest` at the end.
FrequencyCourse falling_to(float lowest) {
  const int samples = default_plan().acquisition().samples_per_stick * iq_oversampling(plan());
  FrequencyCourse course{default_plan().acquisition().depth_m / samples, {}};
  for (int i = 0; i < samples; ++i) {
    course.ratio.push_back(1 - (1 - lowest) * static_cast<float>(i) / static_cast<float>(samples));
  }
  return course;
}

const phantoms::Phantom& tissue_block() {
  static const auto phantom = phantoms::make_phantom({.name = "speckle_block", .voxel_m = 1e-3});
  return phantom;
}

ScattererField field_of(const hw::AcquisitionPlan& of, const FrequencyCourse& course) {
  const ScannedTissue tissue{std::make_shared<const TissueMap>(tissue_block(), 2e-3, 0),
                             tissue_block().materials(),
                             {glm::dmat3(1.0), tissue_block().suggested_position_m()},
                             {}};
  SimulationOptions options;
  options.fidelity = Rung::scatterers;
  return {tissue, ProbeOptics(of), options, ScattererSettings::of(options, course)};
}

/// Number of contributing scatterers of sticks whose frequency falls.
std::uint64_t heard(float lowest) {
  const FrequencyCourse course = falling_to(lowest);
  const ScattererField field = field_of(default_plan(), course);
  const std::size_t samples = course.ratio.size();
  const std::vector<float> remaining(samples, 1.0f);
  std::uint64_t count = 0;
  for (std::uint32_t frame = 10; frame < 28; ++frame) {
    for (std::uint32_t line = 26; line < 38; ++line) {
      Stick iq(samples);
      const TimedRay stick = stick_ray(default_plan(), {0, frame, line});
      field.add_echoes({stick, course.step_m, remaining, {}, course.ratio}, iq, &count);
    }
  }
  return count;
}

TEST(AttenuatedBeam, HearsAsManyScatterersOfMoreTissue) {
  const auto sent = static_cast<double>(heard(1)), lower = static_cast<double>(heard(0.5f));
  // Half way along, the beam is a third wider in both directions: at the same density it would
  // contain about twice as many scatterers.
  EXPECT_NEAR(lower, sent, 0.25 * sent);
}

/// Points on the middle stick, all tissue absorbing the same.
class AttenuatedPoints {
 public:
  AttenuatedPoints(const hw::AcquisitionPlan& of, double db_per_cm_mhz) : plan_(of) {
    const BandLoss band(plan_.probe());
    const double nepers_per_m =
        db_per_cm_mhz * plan_.probe().center_frequency_hz * 1e-6 * 100 * std::log(10.0) / 20;
    const int samples = plan_.acquisition().samples_per_stick;
    course_.step_m = plan_.acquisition().depth_m / samples;
    for (int i = 0; i < samples; ++i) {
      const double nepers = 2 * nepers_per_m * plan_.sample_range_m(i);
      remaining_.push_back(static_cast<float>(std::exp(band.log_gain(nepers) - nepers)));
      course_.ratio.push_back(static_cast<float>(band.frequency_ratio(nepers)));
    }
    field_ = field_of(plan_, course_);
  }

  /// Peak of the echo.
  double level_db(double range_m) const {
    Stick iq(remaining_.size());
    const PointEcho point{plan_.geometry().to_cartesian({range_m, 0, 0}), 1};
    const TimedRay stick{plan_.geometry().stick(0, 0), 0};
    field_->add_points({stick, course_.step_m, remaining_, {}, course_.ratio}, {&point, 1}, iq);
    double peak = 0;
    for (const auto& value : iq) peak = std::max(peak, static_cast<double>(std::abs(value)));
    return 20 * std::log10(peak);
  }

 private:
  hw::AcquisitionPlan plan_;
  std::vector<float> remaining_;
  FrequencyCourse course_;
  std::optional<ScattererField> field_;
};

TEST(AttenuatedBeam, APointOutOfFocusIsAsLoudAsTheElementSumSays) {
  const hw::AcquisitionPlan plan({}, {.depth_m = 0.17, .samples_per_stick = 4096});
  const AttenuatedPoints unattenuated(plan, 0);
  for (const double alpha : {0.3, 0.5, 1.0}) {
    const AttenuatedPoints points(plan, alpha);
    for (const auto& row : yardstick("attenuation")) {
      const double range_m = row.number("depth_mm") * 1e-3;
      if (range_m < 30e-3 || row.number("alpha_db_cm_mhz") != alpha) continue;
      EXPECT_NEAR(points.level_db(range_m) - unattenuated.level_db(range_m),
                  row.number("level_db"),
                  alpha < 1 ? 0.25 : 0.5)
          << range_m << " " << alpha;
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
