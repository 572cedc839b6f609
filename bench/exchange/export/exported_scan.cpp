#include "bench/exchange/export/exported_scan.h"

#include <chrono>
#include <numeric>

#include "base/number_text.h"
#include "hw/probe/beam_width.h"
#include "sim/fidelity.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::bench {

namespace {

/// The map that the simulator and the truth ask for, so that it is made once.
std::shared_ptr<const sim::TissueMap> map_of(const ResolvedScene& scene,
                                             const sim::TissueMapSource& maps) {
  const auto fidelity = sim::choose_fidelity(scene.simulation(),
                                             scene.plan(),
                                             scene.moves(),
                                             !scene.subject().value().phantom.scatterers().empty());
  return maps(scene.subject()->phantom,
              sim::echo_model_type(fidelity.rung).reach_m(scene.plan()),
              scene.simulation().threads);
}

double seconds(hw::DeviceDuration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

TissueLabels::TissueLabels(const ResolvedScene& scene, const sim::TissueMapSource& maps)
    : plan_(scene.plan()),
      geometry_(plan_.geometry()),
      subject_(scene.subject().value()),
      map_(map_of(scene, maps)) {
  for (const auto& material : subject_.phantom.materials()) names_.push_back(material.name);
}

std::uint8_t TissueLabels::at_time(const glm::dvec3& position_m, double time_s) const {
  return static_cast<std::uint8_t>(map_->material(subject_.to_rest(position_m, time_s)));
}

std::uint8_t TissueLabels::at(const glm::dvec3& position_m, std::uint32_t volume) const {
  return static_cast<std::uint8_t>(map_->material(to_rest(position_m, volume)));
}

glm::dvec3 TissueLabels::to_rest(const glm::dvec3& position_m, std::uint32_t volume) const {
  if (subject_.motion.still()) return subject_.to_rest(position_m, 0);
  const auto stick = plan_.nearest_stick(geometry_.to_polar(position_m), volume);
  return subject_.to_rest(position_m,
                          seconds(plan_.stick_time(plan_.sequence(stick)) - hw::DeviceTime()));
}

namespace {

using Fields = std::vector<std::pair<std::string, std::string>>;

std::string number(double value) {
  return significant(value, 12);
}

/// What is known of it; the frequency also for the time gain of the scale.
void add_aperture(const hw::ProbeOptions& probe, const hw::DisplayScale& scale, Fields& fields) {
  const bool has_array = hw::knows_array(probe), has_lens = hw::knows_lens(probe);
  const auto add = [&](bool is_known, const char* key, double value) {
    if (is_known) fields.emplace_back(std::string("wobblebench_") + key, number(value));
  };
  add(has_array || has_lens || scale.stated(),
      "center_frequency_mhz",
      probe.center_frequency_hz / kMegahertz);
  add(has_array || has_lens, "fractional_bandwidth", probe.fractional_bandwidth);
  add(has_array, "elements", probe.elements);
  add(has_array, "pitch_mm", probe.pitch_m / kMillimetre);
  add(has_array, "f_number", probe.f_number);
  add(has_array, "transmit_focus_mm", probe.transmit_focus_m / kMillimetre);
  add(has_lens, "element_height_mm", probe.element_height_m / kMillimetre);
  add(has_lens, "elevation_focus_mm", probe.elevation_focus_m / kMillimetre);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> ExportedScan::fields() const {
  const hw::AcquisitionOptions& scan = plan().acquisition();
  std::vector<std::pair<std::string, std::string>> fields = {
      {"wobblebench_source", simulated ? "simulated" : "recording of hardware"},
      {"wobblebench_radius_mm", number(plan().probe().radius_m / kMillimetre)},
      {"wobblebench_wobble_radius_mm", number(plan().probe().wobble_radius_m / kMillimetre)},
      {"wobblebench_sector_deg", number(scan.sector_rad / kDegree)},
      {"wobblebench_fan_deg", number(scan.fan_rad / kDegree)},
      {"wobblebench_depth_mm", number(scan.depth_m / kMillimetre)}};
  add_aperture(plan().probe(), display_scale, fields);
  if (!display_scale.knows_range()) return fields;
  fields.emplace_back("wobblebench_dynamic_range_db", number(display_scale.dynamic_range_db));
  if (!display_scale.stated()) return fields;
  fields.emplace_back("wobblebench_full_scale_db", number(display_scale.full_scale_db));
  fields.emplace_back("wobblebench_tgc_db_per_cm_mhz", number(display_scale.tgc_db_per_cm_mhz));
  return fields;
}

double volume_time_s(const hw::AcquisitionPlan& plan,
                     std::uint32_t first_volume,
                     std::uint32_t volume) {
  return seconds(plan.stick_time(plan.first_sequence(volume)) -
                 plan.stick_time(plan.first_sequence(first_volume)));
}

double frame_time_s(const hw::AcquisitionPlan& plan,
                    std::uint32_t first_volume,
                    std::uint32_t volume,
                    int frame) {
  const auto first = plan.sequence({volume, static_cast<std::uint32_t>(frame), 0});
  return seconds(plan.stick_time(first) - plan.stick_time(plan.first_sequence(first_volume))) +
         0.5 * plan.acquisition().sticks_per_frame * plan.stick_period_s();
}

double mean_motor_angle_rad(const hw::PolarFrame& frame) {
  return std::accumulate(frame.motor_angle_rad.begin(), frame.motor_angle_rad.end(), 0.0) /
         static_cast<double>(frame.motor_angle_rad.size());
}

}  // namespace wobblebench::bench
