#include "sim/beam.h"

#include <algorithm>
#include <cmath>

#include "sim/echo_field.h"
#include "sim/parallel.h"
#include "sim/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr int kMaxPerStep = 4;
constexpr int kMaxHalf = 64;

int divisions(double step_m, double fwhm_m) {
  return std::clamp(static_cast<int>(std::ceil(2 * step_m / fwhm_m)), 1, kMaxPerStep);
}

/// Gaussian weights with sum 1 of an amplitude response's power.
std::vector<float> power_weights(double amplitude_sigma_steps, int max_half) {
  std::vector<float> weights =
      unit_power_gaussian(amplitude_sigma_steps / std::sqrt(2.0), max_half);
  float sum = 0;
  for (float weight : weights) sum += weight;
  for (float& weight : weights) weight /= sum;
  return weights;
}

/// Of the beam's power; `step_m` 0 (a lone stick): no averaging.
std::vector<float> beam_weights(double fwhm_m, double step_m) {
  return power_weights(step_m > 0 ? sigma_of_fwhm(fwhm_m) / step_m : 0, kMaxHalf);
}

/// Weighted mean around `centre` of `count` values `stride` apart; at the rim, of those that exist.
float weighted(const float* first,
               int count,
               std::size_t stride,
               int centre,
               const std::vector<float>& weights) {
  const int half = static_cast<int>(weights.size()) / 2;
  float sum = 0, total = 0;
  for (int i = std::max(0, centre - half); i <= std::min(count - 1, centre + half); ++i) {
    const float weight = weights[static_cast<std::size_t>(i - centre + half)];
    sum += weight * first[static_cast<std::size_t>(i) * stride];
    total += weight;
  }
  return sum / total;
}

PowerField averaged_across_lines(PowerField& fine,
                                 const BeamGrid& grid,
                                 const hw::AcquisitionPlan& plan,
                                 double spacing_m,
                                 int threads) {
  std::vector<std::vector<float>> weights;
  for (int i = 0; i < fine.samples; ++i) {
    const double radius_m = plan.probe().radius_m + (i + 0.5) * spacing_m;
    weights.push_back(
        beam_weights(lateral_fwhm_m(plan), radius_m * plan.theta_step_rad() / grid.per_line));
  }
  PowerField kept(fine.frames, plan.acquisition().sticks_per_frame, fine.samples);
  parallel_ranges(fine.frames, threads, [&](int first, int last) {
    for (int frame = first; frame < last; ++frame) {
      const float* source = fine.stick(frame, 0);
      for (int line = 0; line < kept.lines; ++line) {
        float* target = kept.stick(frame, line);
        for (int i = 0; i < fine.samples; ++i) {
          target[i] = weighted(source + i,
                               fine.lines,
                               static_cast<std::size_t>(fine.samples),
                               line * grid.per_line,
                               weights[static_cast<std::size_t>(i)]);
        }
      }
    }
  });
  return kept;
}

PowerField averaged_across_frames(PowerField& fine,
                                  const BeamGrid& grid,
                                  const hw::AcquisitionPlan& plan,
                                  double spacing_m,
                                  int threads) {
  PowerField kept(plan.acquisition().frames_per_volume, fine.lines, fine.samples);
  const std::size_t stride = static_cast<std::size_t>(fine.lines) * fine.samples;
  parallel_ranges(fine.lines, threads, [&](int first, int last) {
    for (int line = first; line < last; ++line) {
      for (int i = 0; i < fine.samples; ++i) {
        const double range_m = (i + 0.5) * spacing_m;
        const double step_m = frame_distance_m(plan, line, range_m) / grid.per_frame;
        const auto weights = beam_weights(elevation_fwhm_m(plan, range_m), step_m);
        for (int frame = 0; frame < kept.frames; ++frame) {
          kept.stick(frame, line)[i] = weighted(
              fine.stick(0, line) + i, fine.frames, stride, frame * grid.per_frame, weights);
        }
      }
    }
  });
  return kept;
}

}  // namespace

BeamGrid::BeamGrid(const hw::AcquisitionPlan& plan) {
  const double focus_m = plan.probe().elevation_focus_m;
  const double line_step_m = (plan.probe().radius_m + focus_m) * plan.theta_step_rad();
  const int middle = plan.acquisition().sticks_per_frame / 2;
  per_line = divisions(line_step_m, lateral_fwhm_m(plan));
  per_frame = divisions(frame_distance_m(plan, middle, focus_m), elevation_fwhm_m(plan, focus_m));
}

int BeamGrid::lines(const hw::AcquisitionPlan& plan) const {
  return (plan.acquisition().sticks_per_frame - 1) * per_line + 1;
}

int BeamGrid::frames(const hw::AcquisitionPlan& plan) const {
  return (plan.acquisition().frames_per_volume - 1) * per_frame + 1;
}

hw::Ray BeamGrid::sightline(const hw::AcquisitionPlan& plan, int frame, int line) const {
  // Between its neighbours everything runs evenly, the motor within a frame too.
  const auto stick = [&](int f, int l) {
    return plan.motor_angle_rad({0, static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(l)});
  };
  const int f = frame / per_frame, l = line / per_line;
  const double across = static_cast<double>(line % per_line) / per_line;
  const double along = static_cast<double>(frame % per_frame) / per_frame;
  const double turn_per_line = across > 0 ? stick(f, l + 1) - stick(f, l) : 0;
  const double theta = plan.theta_rad(l) + across * plan.theta_step_rad();
  const double phi = stick(f, l) + across * turn_per_line + along * plan.phi_step_rad();
  return plan.geometry().stick(theta, phi);
}

double pulse_power_peak(double pulse_sigma_samples) {
  const auto weights = power_weights(pulse_sigma_samples, kMaxHalfPulse);
  return static_cast<double>(weights[weights.size() / 2]);
}

void average_under_pulse(PowerField& field, double pulse_sigma_samples, int threads) {
  const auto weights = power_weights(pulse_sigma_samples, kMaxHalfPulse);
  parallel_ranges(field.frames, threads, [&](int first, int last) {
    std::vector<float> before(static_cast<std::size_t>(field.samples));
    for (int stick = first * field.lines; stick < last * field.lines; ++stick) {
      float* values = field.stick(stick / field.lines, stick % field.lines);
      std::copy_n(values, field.samples, before.begin());
      for (int i = 0; i < field.samples; ++i) {
        values[i] = weighted(before.data(), field.samples, 1, i, weights);
      }
    }
  });
}

PowerField averaged_under_beam(PowerField fine,
                               const BeamGrid& grid,
                               const hw::AcquisitionPlan& plan,
                               double spacing_m,
                               int threads) {
  PowerField in_plane = averaged_across_lines(fine, grid, plan, spacing_m, threads);
  return averaged_across_frames(in_plane, grid, plan, spacing_m, threads);
}

}  // namespace wobblebench::sim
