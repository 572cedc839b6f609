#include "sim/losses/cone.h"

#include <algorithm>
#include <cmath>

#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

/// Middle of one of `parts` equal parts of -1 to 1.
double middle(int part, int parts) {
  return (2 * part + 1.0) / parts - 1;
}

}  // namespace

ApertureCone::ApertureCone(const hw::AcquisitionPlan& plan, const LossGrid& grid)
    : probe_(plan.probe()),
      grid_(grid),
      lines_per_rad_(grid.lines > 1 ? 1 / plan.theta_step_rad() : 0),
      array_rad_(0.5 * probe_.elements * probe_.pitch_m / probe_.radius_m) {
  for (int line = 0; line < grid.lines; ++line) theta_rad_.push_back(plan.theta_rad(line));
  place_frames(plan);
  for (int end = 0; end < kEnds; ++end) {
    for (int to = 0; to < grid.nodes; ++to) {
      const double range_m = to * grid.step_m;
      const double aperture_m =
          end == 0 ? transmit_aperture_m(plan, range_m) : receive_aperture_m(plan, range_m);
      widest_m_ = std::max(widest_m_, aperture_m);
      place(aperture_m, to);
      weigh(aperture_m);
    }
  }
}

void ApertureCone::place_frames(const hw::AcquisitionPlan& plan) {
  const double frames_per_rad = grid_.frames > 1 ? 1 / plan.phi_step_rad() : 0;
  const double axis_z_m = plan.geometry().axis_z_m();
  for (int node = 0; node < grid_.nodes; ++node) {
    const double radius_m = probe_.radius_m + (node + 0.5) * grid_.step_m;
    double most_per_m = 0;
    for (const double theta_rad : theta_rad_) {
      const double to_axis_m = radius_m * std::cos(theta_rad) - axis_z_m;
      const double per_m = frames_per_rad / std::max(std::abs(to_axis_m), grid_.step_m);
      frames_per_m_.push_back(static_cast<float>(per_m));
      most_per_m = std::max(most_per_m, per_m);
    }
    const double most = std::ceil(most_per_m * 0.5 * probe_.element_height_m);
    most_frames_.push_back(static_cast<int>(std::min(most, static_cast<double>(grid_.frames))));
  }
}

void ApertureCone::place(double aperture_m, int to) {
  const auto most = static_cast<double>(grid_.lines);
  for (int from = 0; from < grid_.nodes; ++from) {
    const double radius_m = probe_.radius_m + (from + 0.5) * grid_.step_m;
    for (int part = 0; part < kLateral; ++part) {
      const double at_face_rad = middle(part, kLateral) * 0.5 * aperture_m / probe_.radius_m;
      // The face is curved: ways from its sides are longer.
      const double behind_m = probe_.radius_m * (1 - std::cos(at_face_rad));
      const double aside_m =
          from < to ? probe_.radius_m * std::sin(at_face_rad) * left(from, to, behind_m) : 0;
      const double aside = aside_m / radius_m * lines_per_rad_;
      lines_aside_.push_back(static_cast<float>(std::clamp(aside, -most, most)));
    }
  }
}

void ApertureCone::weigh(double aperture_m) {
  const double half_rad = 0.5 * aperture_m / probe_.radius_m;
  for (int part = 0; part < kLateral; ++part) {
    const double center_rad = middle(part, kLateral) * half_rad, reach_rad = half_rad / kLateral;
    for (const double theta_rad : theta_rad_) {
      // Sticks beyond the last element take the aperture at the array's end.
      const double within_rad = std::clamp(theta_rad, -array_rad_, array_rad_) + center_rad;
      on_array_.push_back(share_on_array(within_rad - reach_rad, within_rad + reach_rad));
    }
  }
}

double ApertureCone::left(int from, int to, double behind_m) const {
  // On the last step the way is the axis, so that an interface in it is crossed once; far from the
  // point the way is taken in the middle of the step.
  const double steps = to - from - 0.5;
  const double passed_m = (from + 0.5 + 1 / (steps + 1.5)) * grid_.step_m;
  return 1 - (behind_m + passed_m) / (behind_m + to * grid_.step_m);
}

double ApertureCone::elevation_m(int part, int from, int to) const {
  return middle(part, kElevation) * 0.5 * probe_.element_height_m * left(from, to, 0);
}

int ApertureCone::most_lines() const {
  const double most = 0.5 * widest_m_ / probe_.radius_m * lines_per_rad_;
  return static_cast<int>(std::min(std::ceil(most), static_cast<double>(grid_.lines)));
}

float ApertureCone::share_on_array(double from_rad, double to_rad) const {
  if (to_rad <= from_rad) return 1;
  const double on = std::min(to_rad, array_rad_) - std::max(from_rad, -array_rad_);
  return static_cast<float>(std::clamp(on / (to_rad - from_rad), 0.0, 1.0));
}

}  // namespace wobblebench::sim
