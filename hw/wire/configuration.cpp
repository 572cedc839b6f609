#include "hw/wire/configuration.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/units.h"

namespace wobblebench::hw {

namespace {

constexpr double kCentimetre = 1e-2;

/// From an echo to full scale, as an amplitude.
double gain_db(const DisplayScale& scale, const AcquisitionPlan& plan, double range_m) {
  const double db_per_cm =
      2 * scale.tgc_db_per_cm_mhz * plan.probe().center_frequency_hz / kMegahertz;
  return std::min(db_per_cm * range_m / kCentimetre - scale.full_scale_db, kMostGain_db);
}

}  // namespace

double echo_db(float sample,
               SampleScale sample_scale,
               const DisplayScale& display_scale,
               const AcquisitionPlan& plan,
               double range_m) {
  if (!display_scale.stated()) throw std::invalid_argument("the display scale is not known");
  const auto value = static_cast<double>(sample);
  const double below_full_scale_db = sample_scale == SampleScale::linear_envelope
                                         ? 20 * std::log10(value)
                                         : (value - 1) * display_scale.dynamic_range_db;
  return below_full_scale_db - gain_db(display_scale, plan, range_m);
}

}  // namespace wobblebench::hw
