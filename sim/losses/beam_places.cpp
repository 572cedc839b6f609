#include "sim/losses/beam_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr double kReach = 2;  // widths of the beam
/// Of the sum that stands for an aperture: its phase turns by at most an eighth between two waves.
constexpr int kLeastWaves = 64, kMostWaves = 1 << 15;

/// Width of an aperture along the curved face, as seen from its axis.
double chord_m(const hw::AcquisitionPlan& plan, double aperture_m) {
  const double radius_m = plan.probe().radius_m;
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

/// Waves of an aperture at a place `aside_m` from the axis, in the parts of the stick that passes
/// there: their aperture lies aside, too.
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
double position(int place) {
  return 2.0 * place / (BeamPlaces::kPlaces - 1) - 1;
}

}  // namespace

BeamPlaces::BeamPlaces(const hw::AcquisitionPlan& plan,
                       const LossGrid& grid,
                       const ApertureCone& cone)
    : grid_(grid) {
  place(plan);
  bound();
  sum_waves(plan);
  sum_powers(cone);
}

void BeamPlaces::place(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  const double lines_per_rad = grid_.lines > 1 ? 1 / plan.theta_step_rad() : 0;
  const double frames_per_rad = grid_.frames > 1 ? 1 / plan.phi_step_rad() : 0;
  const double most_lines = grid_.lines;
  for (int node = 0; node < grid_.nodes; ++node) {
    const double range_m = node * grid_.step_m, radius_m = probe.radius_m + range_m;
    // Diffraction's width, and across the image plane the lens' cone where that is wider. In the
    // image plane the receive beam is in focus everywhere.
    const double lateral_m =
        node > 0 ? wavelength_m(plan) * range_m / chord_m(plan, receive_aperture_m(plan, range_m))
                 : 0;
    const double elevation_m =
        std::max(wavelength_m(plan) * range_m / probe.element_height_m,
                 0.5 * probe.element_height_m * std::abs(1 - range_m / probe.elevation_focus_m));
    for (int i = 0; i < kPlaces; ++i) {
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

void BeamPlaces::sum_waves(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  lateral_.resize(at(ApertureCone::kEnds, 0, 0) * ApertureCone::kLateral);
  elevation_.resize(at(1, 0, 0) * ApertureCone::kElevation);
  for (int node = 1; node < grid_.nodes; ++node) {
    const double range_m = node * grid_.step_m;
    const Aperture lens{
        probe.element_height_m, probe.elevation_focus_m, wavelength_m(plan), probe.wobble_radius_m};
    const Aperture ends[ApertureCone::kEnds] = {{chord_m(plan, transmit_aperture_m(plan, range_m)),
                                                 transmit_focus_m(plan, range_m),
                                                 lens.wavelength_m,
                                                 probe.radius_m},
                                                {chord_m(plan, receive_aperture_m(plan, range_m)),
                                                 range_m,
                                                 lens.wavelength_m,
                                                 probe.radius_m}};
    for (int i = 0; i < kPlaces; ++i) {
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

void BeamPlaces::sum_powers(const ApertureCone& cone) {
  lateral_power_.assign(row(grid_.nodes), 0);
  elevation_power_.assign(static_cast<std::size_t>(grid_.nodes), 0);
  for (int node = 1; node < grid_.nodes; ++node) {
    for (int i = 0; i < kPlaces; ++i) {
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

void BeamPlaces::bound() {
  float lines = 0, frames = 0;
  for (const float aside : lines_aside_) lines = std::max(lines, std::abs(aside));
  for (int node = 0; node < grid_.nodes; ++node) {
    const float* per_m = frames_per_m(node);
    const float most_per_m = *std::max_element(per_m, per_m + grid_.lines);
    frames = std::max(frames, most_per_m * across_m(node, kPlaces - 1));
  }
  most_lines_ = static_cast<int>(std::ceil(lines));
  const double all = grid_.frames;
  most_frames_ = static_cast<int>(std::min(std::ceil(static_cast<double>(frames)), all));
}

}  // namespace wobblebench::sim
