#include "render/reconstruction/motor_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "hw/probe/motor_deviation.h"

namespace wobblebench::render {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Every `stride`th value, `count` of them.
struct Strided {
  double* first;
  std::size_t stride, count;

  double& operator[](std::size_t i) const { return first[i * stride]; }
};

/// Linear between the nearest values that are known, constant beyond them; no change if none is.
void fill_unknown(const Strided& values) {
  std::size_t before = values.count;
  for (std::size_t i = 0; i < values.count; ++i) {
    if (std::isnan(values[i])) continue;
    const std::size_t gap = before == values.count ? 0 : before + 1;
    for (std::size_t k = gap; k < i; ++k) {
      values[k] =
          gap == 0 ? values[i]
                   : std::lerp(values[before],
                               values[i],
                               static_cast<double>(k - before) / static_cast<double>(i - before));
    }
    before = i;
  }
  if (before == values.count) return;
  for (std::size_t k = before + 1; k < values.count; ++k) values[k] = values[before];
}

}  // namespace

FramePlace regular_place(int i, int factor, int count, double step_rad) {
  const int first = std::min(i / factor, std::max(count - 2, 0));
  FramePlace place{{}, static_cast<double>(i - first * factor) / factor, step_rad};
  for (int j = 0; j < 4; ++j) {
    place.frames[static_cast<std::size_t>(j)] = std::clamp(first + j - 1, 0, count - 1);
  }
  return place;
}

FrameOrder::FrameOrder(std::vector<std::pair<double, int>> angles_and_frames)
    : sorted_(std::move(angles_and_frames)) {
  std::sort(sorted_.begin(), sorted_.end());
}

FramePlace FrameOrder::at(double phi_rad) const {
  const int count = static_cast<int>(sorted_.size());
  const auto entry = [&](int i) {
    return sorted_[static_cast<std::size_t>(std::clamp(i, 0, count - 1))];
  };
  const auto after =
      std::upper_bound(sorted_.begin(), sorted_.end(), phi_rad, [](double phi, const auto& e) {
        return phi < e.first;
      });
  const int first =
      std::clamp(static_cast<int>(after - sorted_.begin()) - 1, 0, std::max(count - 2, 0));
  FramePlace place;
  for (int j = 0; j < 4; ++j) {
    place.frames[static_cast<std::size_t>(j)] = entry(first + j - 1).second;
  }
  place.step_rad = entry(first + 1).first - entry(first).first;
  const double past_rad = phi_rad - entry(first).first;
  place.t = place.step_rad > 0 ? std::clamp(past_rad / place.step_rad, 0.0, 1.0) : 0;
  return place;
}

FrameOrder MotorAngles::order_at(double line, int lines) const {
  const int first = std::clamp(static_cast<int>(line), 0, std::max(lines - 2, 0));
  const int next = std::min(first + 1, lines - 1);
  std::vector<std::pair<double, int>> entries;
  const int frames = static_cast<int>(phi_rad.size()) / lines;
  for (int frame = 0; frame < frames; ++frame) {
    const double* row = phi_rad.data() + std::ptrdiff_t{frame} * lines;
    entries.emplace_back(std::lerp(row[first], row[next], line - first), frame);
  }
  return FrameOrder(std::move(entries));
}

double dense_angle_rad(const hw::AcquisitionPlan& plan,
                       const DenseFactors& factors,
                       int frame,
                       int line) {
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const double first_rad = plan.frame_phi_rad(0), step_rad = plan.phi_step_rad();
  const double frame_rad = first_rad + step_rad * frame / factors.frames;
  if (scan.motor == hw::MotorMode::stepped) return frame_rad;
  const double of_frame = (static_cast<double>(line) / factors.lines + 0.5) / scan.sticks_per_frame;
  return frame_rad + step_rad * (of_frame - 0.5);
}

std::vector<std::vector<float>> place_frames(const hw::AcquisitionPlan& plan,
                                             const std::vector<std::vector<float>>& received,
                                             const MotorAngles& angles) {
  const int lines = plan.acquisition().sticks_per_frame;
  const int samples = plan.acquisition().samples_per_stick;
  std::vector<std::vector<float>> placed(received.size(),
                                         std::vector<float>(received.front().size()));
  parallel_rows(lines, [&](int line) {
    const FrameOrder order = angles.order_at(line, lines);
    const std::ptrdiff_t first = std::ptrdiff_t{line} * samples;
    for (std::size_t frame = 0; frame < placed.size(); ++frame) {
      const FramePlace place = order.at(dense_angle_rad(plan, {}, static_cast<int>(frame), line));
      const float* before = received[static_cast<std::size_t>(place.frames[1])].data() + first;
      const float* after = received[static_cast<std::size_t>(place.frames[2])].data() + first;
      const auto t = static_cast<float>(place.t);
      std::transform(
          before, before + samples, after, placed[frame].data() + first, [t](float a, float b) {
            return (1 - t) * a + t * b;
          });
    }
  });
  return placed;
}

ReceivedAngles::ReceivedAngles(const hw::AcquisitionPlan& plan)
    : plan_(plan),
      frames_(static_cast<std::size_t>(plan.acquisition().frames_per_volume)),
      lines_(static_cast<std::size_t>(plan.acquisition().sticks_per_frame)),
      deviation_rad_(frames_ * lines_, kUnknown),
      leaves_plan_(frames_, 0) {}

void ReceivedAngles::put(int frame, const hw::PolarFrame& samples) {
  const auto f = static_cast<std::uint32_t>(frame);
  const bool told = samples.motor_angle_rad.size() == lines_ && samples.arrived.size() == lines_;
  double there_rad = 0, back_rad = 0;  // largest deviation in either direction of the sweep
  for (std::size_t l = 0; l < lines_; ++l) {
    double& deviation_rad = deviation_rad_[f * lines_ + l];
    deviation_rad = kUnknown;
    if (!told || samples.arrived[l] == 0) continue;
    const auto line = static_cast<std::uint32_t>(l);
    deviation_rad = samples.motor_angle_rad[l] - plan_.motor_angle_rad({0, f, line});
    there_rad = std::max(there_rad, std::abs(deviation_rad));
    const double from_back_rad = samples.motor_angle_rad[l] - plan_.motor_angle_rad({1, f, line});
    back_rad = std::max(back_rad, std::abs(from_back_rad));
  }
  leaves_plan_[f] = std::min(there_rad, back_rad) > hw::negligible_deviation_rad(plan_);
}

MotorAngles ReceivedAngles::angles() const {
  MotorAngles result{{}, {0, static_cast<double>(frames_) - 1}};
  const bool leaves = std::find(leaves_plan_.begin(), leaves_plan_.end(), 1) != leaves_plan_.end();
  if (!leaves || frames_ == 1) return result;
  result.phi_rad = deviation_rad_;
  for (std::size_t f = 0; f < frames_; ++f) fill_unknown({&result.phi_rad[f * lines_], 1, lines_});
  for (std::size_t l = 0; l < lines_; ++l) {
    const Strided frames{&result.phi_rad[l], lines_, frames_};
    fill_unknown(frames);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t f = 0; f < frames_; ++f) {
      // The same deviation in frames, and where in the fan that is.
      const double at = static_cast<double>(f) + frames[f] / plan_.phi_step_rad();
      low = std::min(low, at);
      high = std::max(high, at);
      frames[f] +=
          plan_.motor_angle_rad({0, static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(l)});
    }
    result.covered.first = std::max(result.covered.first, low);
    result.covered.last = std::min(result.covered.last, high);
  }
  return result;
}

}  // namespace wobblebench::render
