#include "sim/losses/aperture_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wobblebench::sim {

namespace {

/// Middle of one of `parts` equal parts of Position of a point across the beam, -1 to 1.
double middle(int part, int parts) {
  return (2 * part + 1.0) / parts - 1;
}

}  // namespace

ApertureCone::ApertureCone(const ProbeOptics& optics, const LossGrid& grid)
    : probe_(optics.probe()),
      grid_(grid),
      lines_per_rad_(grid.lines > 1 ? 1 / optics.plan().theta_step_rad() : 0),
      array_rad_(0.5 * probe_.elements * probe_.pitch_m / probe_.radius_m) {
  for (int line = 0; line < grid.lines; ++line) theta_rad_.push_back(optics.plan().theta_rad(line));
  locate_steps(optics.plan());
  for (int end = 0; end < kEnds; ++end) {
    for (int to = 0; to < grid.nodes; ++to) {
      const double range_m = to * grid.step_m;
      const double aperture_m =
          end == 0 ? optics.transmit_aperture_m(range_m) : optics.receive_aperture_m(range_m);
      widest_m_ = std::max(widest_m_, aperture_m);
      locate(aperture_m, to);
      weigh(aperture_m);
    }
  }
}

void ApertureCone::locate_steps(const hw::AcquisitionPlan& plan) {
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

void ApertureCone::locate(double aperture_m, int to) {
  const auto most = static_cast<double>(grid_.lines);
  for (int from = 0; from < grid_.nodes; ++from) {
    const double radius_m = probe_.radius_m + (from + 0.5) * grid_.step_m;
    for (int part = 0; part < kLateral; ++part) {
      const double at_face_rad = middle(part, kLateral) * 0.5 * aperture_m / probe_.radius_m;
      // The face is curved: paths from its sides are longer.
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
  // On the last step the path is on the axis, so that an interface in this step is crossed once; on
  // steps far from the point the path is evaluated at the middle of the step.
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

namespace {

constexpr double kReach = 2;  // in widths of the beam
/// Number of waves whose sum represents an aperture: the phase changes by at most an eighth of a
/// cycle between two of them.
constexpr int kLeastWaves = 64, kMostWaves = 1 << 15;

/// Width of an aperture along the curved face, as seen from its axis.
double chord_m(const ProbeOptics& optics, double aperture_m) {
  const double radius_m = optics.probe().radius_m;
  return 2 * radius_m * std::sin(std::min(0.5 * aperture_m / radius_m, 0.5 * std::numbers::pi));
}

/// An aperture along one direction, as seen from the axis. It turns about a centre `radius_m`
/// behind the face from one stick to the next.
struct Aperture {
  double width_m;
  double focus_m;
  double wavelength_m;
  double radius_m;
};

/// Adds the waves of an aperture at a point `aside_m` from the axis to the parts of the aperture of
/// the stick that passes through this point; that aperture is displaced, too.
void part_waves(const Aperture& aperture,
                double range_m,
                double aside_m,
                int parts,
                std::complex<double>* waves) {
  const double curvature_per_m = 1 / range_m - 1 / aperture.focus_m;
  const double width_m = aperture.width_m;
  const double most_per_m =
      (0.5 * width_m * std::abs(curvature_per_m) + std::abs(aside_m) / range_m) /
      aperture.wavelength_m;
  const double enough = std::ceil(8 * most_per_m * width_m);
  const int count = static_cast<int>(std::clamp<double>(enough, kLeastWaves, kMostWaves));
  const double shift_m = aside_m * aperture.radius_m / (aperture.radius_m + range_m);
  for (int i = 0; i < count; ++i) {
    const double share = (i + 0.5) / count, height_m = (share - 0.5) * width_m;
    const double cycles =
        height_m * (0.5 * height_m * curvature_per_m - aside_m / range_m) / aperture.wavelength_m;
    const auto wave = std::polar(1.0 / count, 2 * std::numbers::pi * cycles);
    const double in_parts = (share - shift_m / width_m) * parts - 0.5;
    const double at = std::clamp(in_parts, 0.0, parts - 1.0);
    const int before = std::min(static_cast<int>(at), parts - 2);
    waves[before] += (1 - (at - before)) * wave;
    waves[before + 1] += (at - before) * wave;
  }
}

/// -1 to 1.
double position(int point) {
  return 2.0 * point / (BeamSection::kPoints - 1) - 1;
}

}  // namespace

BeamSection::BeamSection(const ProbeOptics& optics, const LossGrid& grid, const ApertureCone& cone)
    : grid_(grid) {
  locate(optics);
  bound();
  sum_waves(optics);
  sum_powers(cone);
}

void BeamSection::locate(const ProbeOptics& optics) {
  const auto& plan = optics.plan();
  const auto& probe = optics.probe();
  const double lines_per_rad = grid_.lines > 1 ? 1 / plan.theta_step_rad() : 0;
  const double frames_per_rad = grid_.frames > 1 ? 1 / plan.phi_step_rad() : 0;
  const double most_lines = grid_.lines;
  for (int node = 0; node < grid_.nodes; ++node) {
    const double range_m = node * grid_.step_m, radius_m = probe.radius_m + range_m;
    // Width by diffraction; across the image plane that of the lens' geometric cone where it is
    // wider. In the image plane the receive beam is in focus everywhere.
    const double lateral_m = node > 0 ? optics.wavelength_m() * range_m /
                                            chord_m(optics, optics.receive_aperture_m(range_m))
                                      : 0;
    const double elevation_m =
        std::max(optics.wavelength_m() * range_m / probe.element_height_m,
                 0.5 * probe.element_height_m * std::abs(1 - range_m / probe.elevation_focus_m));
    for (int i = 0; i < kPoints; ++i) {
      beside_m_.push_back(kReach * position(i) * lateral_m);
      const double lines = beside_m_.back() / radius_m * lines_per_rad;
      lines_aside_.push_back(static_cast<float>(std::clamp(lines, -most_lines, most_lines)));
      across_m_.push_back(static_cast<float>(kReach * position(i) * elevation_m));
    }
    for (int line = 0; line < grid_.lines; ++line) {
      const double to_axis_m =
          radius_m * std::cos(plan.theta_rad(line)) - plan.geometry().axis_z_m();
      frames_per_m_.push_back(
          static_cast<float>(frames_per_rad / std::max(std::abs(to_axis_m), grid_.step_m)));
    }
  }
}

void BeamSection::sum_waves(const ProbeOptics& optics) {
  const auto& probe = optics.probe();
  lateral_.resize(at(ApertureCone::kEnds, 0, 0) * ApertureCone::kLateral);
  elevation_.resize(at(1, 0, 0) * ApertureCone::kElevation);
  for (int node = 1; node < grid_.nodes; ++node) {
    const double range_m = node * grid_.step_m;
    const double wavelength_m = optics.wavelength_m();
    const Aperture lens{
        probe.element_height_m, probe.elevation_focus_m, wavelength_m, probe.wobble_radius_m};
    const Aperture ends[ApertureCone::kEnds] = {
        {chord_m(optics, optics.transmit_aperture_m(range_m)),
         optics.transmit_focus_m(range_m),
         wavelength_m,
         probe.radius_m},
        {chord_m(optics, optics.receive_aperture_m(range_m)),
         range_m,
         wavelength_m,
         probe.radius_m}};
    for (int i = 0; i < kPoints; ++i) {
      for (int end = 0; end < ApertureCone::kEnds; ++end) {
        part_waves(ends[end],
                   range_m,
                   beside_m_[at(0, node, i)],
                   ApertureCone::kLateral,
                   lateral_.data() + at(end, node, i) * ApertureCone::kLateral);
      }
      part_waves(lens,
                 range_m,
                 static_cast<double>(across_m(node, i)),
                 ApertureCone::kElevation,
                 elevation_.data() + at(0, node, i) * ApertureCone::kElevation);
    }
  }
}

void BeamSection::sum_powers(const ApertureCone& cone) {
  lateral_power_.assign(row(grid_.nodes), 0);
  elevation_power_.assign(static_cast<std::size_t>(grid_.nodes), 0);
  for (int node = 1; node < grid_.nodes; ++node) {
    for (int i = 0; i < kPoints; ++i) {
      for (int line = 0; line < grid_.lines; ++line) {
        double power = 1;
        for (int end = 0; end < ApertureCone::kEnds; ++end) {
          std::complex<double> wave;
          for (int part = 0; part < ApertureCone::kLateral; ++part) {
            const float* on_array = cone.on_array(end, part, node);
            wave += static_cast<double>(on_array[line]) * lateral(end, node, i)[part];
          }
          power *= std::norm(wave);
        }
        lateral_power_[row(node) + static_cast<std::size_t>(line)] += power;
      }
      std::complex<double> wave;
      for (int part = 0; part < ApertureCone::kElevation; ++part) wave += elevation(node, i)[part];
      elevation_power_[static_cast<std::size_t>(node)] += std::norm(wave) * std::norm(wave);
    }
  }
}

void BeamSection::bound() {
  float lines = 0, frames = 0;
  for (const float aside : lines_aside_) lines = std::max(lines, std::abs(aside));
  for (int node = 0; node < grid_.nodes; ++node) {
    const float* per_m = frames_per_m(node);
    const float most_per_m = *std::max_element(per_m, per_m + grid_.lines);
    frames = std::max(frames, most_per_m * across_m(node, kPoints - 1));
  }
  most_lines_ = static_cast<int>(std::ceil(lines));
  const double all = grid_.frames;
  most_frames_ = static_cast<int>(std::min(std::ceil(static_cast<double>(frames)), all));
}

}  // namespace wobblebench::sim
