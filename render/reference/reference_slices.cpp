// Pass 1 of the reference, and its sticks: those of the scan, or aligned ones and those between
// them.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "render/geometry/ray_sampling.h"
#include "render/reconstruction/frame_store.h"
#include "render/reconstruction/reconstruction.h"
#include "render/reconstruction/stick_edges.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render::reference {
namespace {

/// Value of a pixel without data.
constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();

double sample_at(const std::vector<double>& frame, int samples_per_stick, int line, int sample) {
  return frame[static_cast<std::size_t>(line) * static_cast<std::size_t>(samples_per_stick) +
               static_cast<std::size_t>(sample)];
}

/// Bilinear in line and sample.
double interpolate(const std::vector<double>& frame,
                   const hw::AcquisitionOptions& acquisition,
                   const SliceGeometry::PolarIndex& index) {
  const int samples = acquisition.samples_per_stick;
  const int line = static_cast<int>(index.line), sample = static_cast<int>(index.sample);
  const int next_line = std::min(line + 1, acquisition.sticks_per_frame - 1);
  const int next_sample = std::min(sample + 1, samples - 1);
  const double along = index.sample - sample, across = index.line - line;
  return std::lerp(std::lerp(sample_at(frame, samples, line, sample),
                             sample_at(frame, samples, line, next_sample),
                             along),
                   std::lerp(sample_at(frame, samples, next_line, sample),
                             sample_at(frame, samples, next_line, next_sample),
                             along),
                   across);
}

Image<double> scan_convert(const std::vector<double>& frame,
                           const hw::AcquisitionOptions& acquisition,
                           const SliceGeometry& geometry) {
  const int size = geometry.slice_size();
  Image<double> slice(size, size, kEmpty);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const auto index =
          geometry.polar_index(geometry.pixel_x_m(column), geometry.pixel_depth_m(row));
      if (index.inside) slice.at(column, row) = interpolate(frame, acquisition, index);
    }
  }
  return slice;
}

/// Mean of the pixels with data around a pixel, weighted by the product of the taps of both axes; 0
/// if there are none.
double mean_around(const Image<double>& slice,
                   int column,
                   int row,
                   const std::vector<double>& weights) {
  const int half = static_cast<int>(weights.size()) / 2;
  double sum = 0, total = 0;
  for (int j = -half; j <= half; ++j) {
    for (int i = -half; i <= half; ++i) {
      const int x = column + i, y = row + j;
      if (x < 0 || y < 0 || x >= slice.width || y >= slice.height) continue;
      if (std::isnan(slice.at(x, y))) continue;
      const double weight =
          weights[static_cast<std::size_t>(i + half)] * weights[static_cast<std::size_t>(j + half)];
      sum += weight * slice.at(x, y);
      total += weight;
    }
  }
  return total > 0 ? sum / total : 0;
}

Image<double> filter(const Image<double>& slice, const std::vector<double>& weights) {
  // Pixels next to the sector take the mean of their neighbours in it, also without a filter.
  const std::vector<double> next_to_sector =
      weights.size() > 1 ? weights : std::vector<double>(3, 1.0 / 3);
  Image<double> filtered(slice.width, slice.height);
  for (int row = 0; row < slice.height; ++row) {
    for (int column = 0; column < slice.width; ++column) {
      const bool is_empty = std::isnan(slice.at(column, row));
      filtered.at(column, row) =
          mean_around(slice, column, row, is_empty ? next_to_sector : weights);
    }
  }
  return filtered;
}

/// Weighted mean of a slice and its neighbours, as far as they exist.
Image<double> across_frames(const std::vector<Image<double>>& slices,
                            int frame,
                            const std::vector<double>& weights) {
  const int half = static_cast<int>(weights.size()) / 2;
  Image<double> mean(slices.front().width, slices.front().height);
  double total = 0;
  for (int offset = -half; offset <= half; ++offset) {
    const int neighbour = frame + offset;
    if (neighbour < 0 || neighbour >= static_cast<int>(slices.size())) continue;
    const double weight = weights[static_cast<std::size_t>(offset + half)];
    const auto& pixels = slices[static_cast<std::size_t>(neighbour)].pixels;
    for (std::size_t i = 0; i < pixels.size(); ++i) mean.pixels[i] += weight * pixels[i];
    total += weight;
  }
  for (double& pixel : mean.pixels) pixel /= total;
  return mean;
}

/// A fractional pixel or frame as two neighbours and the weight of the second, clamped to the edge.
struct Between {
  int first, second;
  double weight;
};
Between between(double at, int count) {
  const double clamped = std::clamp(at, 0.0, count - 1.0);
  const int first = static_cast<int>(clamped);
  return {first, std::min(first + 1, count - 1), clamped - first};
}

/// A stick with its edge, NaN if it has none.
struct EdgedStick {
  std::vector<double> samples;
  double edge_m = kNoEdge;

  /// Linear between samples, constant beyond the ends.
  double at(double sample) const {
    const double inside = std::clamp(sample, 0.0, static_cast<double>(samples.size()) - 1);
    const auto first = static_cast<std::size_t>(inside);
    const std::size_t next = std::min(first + 1, samples.size() - 1);
    return std::lerp(samples[first], samples[next], inside - static_cast<double>(first));
  }
};
using Sticks = std::vector<EdgedStick>;

/// Cubic B-spline around 0.
double b_spline(double x) {
  const double a = std::abs(x);
  if (a >= 2) return 0;
  return a < 1 ? 2.0 / 3 - a * a + a * a * a / 2 : (2 - a) * (2 - a) * (2 - a) / 6;
}

/// Catmull-Rom: the Hermite cubic from p[1] to p[2] with slopes of central differences.
double catmull_rom(const std::array<double, 4>& p, double t) {
  const double begin_slope = (p[2] - p[0]) / 2, end_slope = (p[3] - p[1]) / 2;
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * p[1] + (t3 - 2 * t2 + t) * begin_slope + (3 * t2 - 2 * t3) * p[2] +
         (t3 - t2) * end_slope;
}

/// As mix_sticks(), of neighbours a to d.
EdgedStick mix(const std::array<const EdgedStick*, 4>& n,
               double t,
               double reach_m,
               double spacing_m) {
  const auto same = [&](int i, int j) { return std::abs(n[i]->edge_m - n[j]->edge_m) < reach_m; };
  const bool first = !std::isnan(n[1]->edge_m), second = !std::isnan(n[2]->edge_m);
  const int start = first && (t <= 0.5 || !second) ? 1 : 2;
  std::array<bool, 4> on{};
  if (first || second) {
    on[start] = true;
    on[3 - start] = same(1, 2);
    on[0] = on[1] && same(0, 1);
    on[3] = on[2] && same(2, 3);
  }
  std::array<double, 4> edges{};
  for (int j = 0; j < 4; ++j) edges[j] = n[j]->edge_m;
  if (!on[1]) edges[1] = on[3] ? 2 * edges[2] - edges[3] : edges[2];
  if (!on[2]) edges[2] = on[0] ? 2 * edges[1] - edges[0] : edges[1];
  if (!on[0]) edges[0] = 2 * edges[1] - edges[2];
  if (!on[3]) edges[3] = 2 * edges[2] - edges[1];

  EdgedStick mixed;
  mixed.edge_m = first || second ? catmull_rom(edges, t) : kNoEdge;
  for (std::size_t k = 0; k < n[0]->samples.size(); ++k) {
    double sum = 0;
    for (int j = 0; j < 4; ++j) {
      const double shift = on[j] ? (n[j]->edge_m - mixed.edge_m) / spacing_m : 0;
      sum += b_spline(t - (j - 1)) * n[j]->at(static_cast<double>(k) + shift);
    }
    mixed.samples.push_back(sum);
  }
  return mixed;
}

/// A stick of a row that turns about a centre `radius_m` before its first sample.
EdgedStick at_place(const Sticks& row,
                    const FramePlace& place,
                    double radius_m,
                    double steepest_rad,
                    double spacing_m) {
  std::array<const EdgedStick*, 4> n{};
  for (std::size_t j = 0; j < 4; ++j) n[j] = &row[static_cast<std::size_t>(place.frames[j])];
  const double edge_m = std::isnan(n[1]->edge_m) ? n[2]->edge_m : n[1]->edge_m;
  const double reach_m =
      std::isnan(edge_m) ? 0 : (radius_m + edge_m) * place.step_rad * std::tan(steepest_rad);
  return mix(n, place.t, reach_m, spacing_m);
}

/// `steps` for each one along a row of sticks that turn by `step_rad` about a centre `radius_m`
/// before their first sample.
Sticks denser(const Sticks& row,
              int steps,
              double radius_m,
              double step_rad,
              double steepest_rad,
              double spacing_m) {
  const int count = static_cast<int>(row.size());
  Sticks dense;
  for (int i = 0; i <= (count - 1) * steps; ++i) {
    const FramePlace place = regular_place(i, steps, count, step_rad);
    dense.push_back(at_place(row, place, radius_m, steepest_rad, spacing_m));
  }
  return dense;
}

std::vector<Sticks> edged_frames(const hw::AcquisitionPlan& plan,
                                 const std::vector<std::vector<float>>& frames,
                                 const std::vector<double>& edges) {
  const auto lines = static_cast<std::size_t>(plan.acquisition().sticks_per_frame);
  const auto samples = static_cast<std::ptrdiff_t>(plan.acquisition().samples_per_stick);
  std::vector<Sticks> rows(frames.size(), Sticks(lines));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (std::size_t l = 0; l < lines; ++l) {
      const auto begin = frames[f].begin() + static_cast<std::ptrdiff_t>(l) * samples;
      rows[f][l] = {{begin, begin + samples}, edges[f * lines + l]};
    }
  }
  return rows;
}

/// What pass 1 converts.
struct ReferenceSticks {
  std::vector<std::vector<double>> frames;  ///< of dense_plan(), [line * samples + sample]
  double level = 0;                         ///< detection_level()
  MotorAngles angles;
};

ReferenceSticks make_sticks(const hw::PolarVolume& volume, const RenderOptions& options) {
  const hw::AcquisitionPlan& plan = volume.plan();
  FrameStore store(plan, options);
  for (int f = 0; f < static_cast<int>(volume.frames().size()); ++f) {
    store.put(f, volume.frame(f));
  }
  const auto& received = store.received();
  ReferenceSticks result;
  result.angles = store.angles();
  const auto spans = spans_in_box(plan, options.volume_of_interest, result.angles);
  const EchoLevels levels = measure_levels(plan, received, spans);
  result.level = detection_level(levels, options.ray_casting);
  const ReconstructionOptions& o = options.reconstruction;
  std::optional<hw::BeamWidths> beam;
  if (has_stick_levels(options)) beam.emplace(plan);
  const PreparedSticks prepared =
      prepare_sticks(plan, received, spans, levels, beam ? &*beam : nullptr, options);
  const auto& samples = prepared.samples(received);
  if (o.sticks == render::Sticks::plain) {
    const auto& frames =
        result.angles.as_planned() ? samples : place_frames(plan, samples, result.angles);
    for (const auto& frame : frames) result.frames.emplace_back(frame.begin(), frame.end());
    return result;
  }
  auto rows = edged_frames(plan, samples, prepared.edges);
  const DenseFactors factors = dense_factors(plan, options);
  const hw::ProbeGeometry geometry = plan.geometry();
  const double spacing_m = plan.sample_spacing_m();
  parallel_rows(static_cast<int>(rows.size()), [&](int f) {
    Sticks& row = rows[static_cast<std::size_t>(f)];
    row = denser(
        row, factors.lines, geometry.radius_m(), plan.theta_step_rad(), o.steepest_rad, spacing_m);
  });
  const int lines = static_cast<int>(rows.front().size());
  std::vector<Sticks> columns(static_cast<std::size_t>(lines));
  parallel_rows(lines, [&](int l) {
    Sticks column;
    for (const Sticks& row : rows) column.push_back(row[static_cast<std::size_t>(l)]);
    const double radius_m = geometry.radius_m() - geometry.axis_z_m();
    Sticks& dense = columns[static_cast<std::size_t>(l)];
    if (result.angles.as_planned()) {
      dense =
          denser(column, factors.frames, radius_m, plan.phi_step_rad(), o.steepest_rad, spacing_m);
      return;
    }
    const FrameOrder order = result.angles.order_at(static_cast<double>(l) / factors.lines,
                                                    plan.acquisition().sticks_per_frame);
    const int last = (plan.acquisition().frames_per_volume - 1) * factors.frames;
    for (int f = 0; f <= last; ++f) {
      const FramePlace place = order.at(dense_angle_rad(plan, factors, f, l));
      dense.push_back(at_place(column, place, radius_m, o.steepest_rad, spacing_m));
    }
  });
  for (std::size_t f = 0; f < columns.front().size(); ++f) {
    std::vector<double>& frame = result.frames.emplace_back();
    for (const Sticks& column : columns) {
      frame.insert(frame.end(), column[f].samples.begin(), column[f].samples.end());
    }
  }
  return result;
}

}  // namespace

SliceStack::SliceStack(const hw::PolarVolume& volume, const RenderOptions& options)
    : geometry_(
          volume.plan(), options.scan_conversion.slice_size, dense_factors(volume.plan(), options)),
      sweep_(volume.plan().sweep_direction(volume.volume_index())),
      slices_(static_cast<std::size_t>(geometry_.frames())) {
  const ReferenceSticks sticks = make_sticks(volume, options);
  level_ = sticks.level;
  const double steps = geometry_.frames_per_planned_frame();
  covered_ = {steps * sticks.angles.covered.first, steps * sticks.angles.covered.last};
  if (!sticks.angles.as_planned()) sweep_ = 1;
  const hw::AcquisitionPlan plan = dense_plan(volume.plan(), dense_factors(volume.plan(), options));
  std::vector<Image<double>> filtered(slices_.size());
  parallel_rows(geometry_.frames(), [&](int frame) {
    filtered[static_cast<std::size_t>(frame)] = filter(
        scan_convert(sticks.frames[static_cast<std::size_t>(frame)], plan.acquisition(), geometry_),
        slice_weights(options));
  });
  parallel_rows(geometry_.frames(), [&](int frame) {
    slices_[static_cast<std::size_t>(frame)] =
        across_frames(filtered, frame, frame_weights(options.ray_casting));
  });
}

SliceStack::Sample SliceStack::at(const glm::dvec3& position_m) const {
  const SlicePoint point = geometry_.locate(position_m, sweep_);
  if (!point.inside || !covered_.holds(point.frame)) return {};
  const int size = geometry_.slice_size();
  const Between x = between(geometry_.column(point.x_m), size);
  const Between y = between(geometry_.row(point.depth_m), size);
  const Between f = between(point.frame, geometry_.frames());
  const auto in_slice = [&](int frame) {
    return std::lerp(
        std::lerp(pixel(frame, x.first, y.first), pixel(frame, x.second, y.first), x.weight),
        std::lerp(pixel(frame, x.first, y.second), pixel(frame, x.second, y.second), x.weight),
        y.weight);
  };
  return {std::lerp(in_slice(f.first), in_slice(f.second), f.weight), true};
}

}  // namespace wobblebench::render::reference
