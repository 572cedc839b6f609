#include "bench/exchange/input/resample.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "base/parallel.h"

namespace wobblebench::bench {

namespace {

constexpr double kMostSamples = 4096, kMostLines = 1024;
/// Of the fan that is made up for a grid: the largest that a probe may have, so that sticks are
/// nearly parallel.
constexpr double kLookingRadius_m = 0.2;

std::uint64_t count_within(double count, double most) {
  return static_cast<std::uint64_t>(std::clamp(std::ceil(count), 2.0, most));
}

/// Neighbours along one axis, and the share of the second; nullopt: outside.
struct Between {
  std::size_t first = 0;
  std::size_t second = 0;
  double share = 0;
};
std::optional<Between> between(double at, std::uint64_t size) {
  const auto last = static_cast<double>(size - 1);
  // A pixel reaches half a step beyond its middle.
  if (at < -0.5 || at > last + 0.5) return {};
  const double within = std::clamp(at, 0.0, last);
  const auto first = static_cast<std::size_t>(within);
  return Between{
      first, std::min<std::size_t>(first + 1, size - 1), within - static_cast<double>(first)};
}

struct PixelPlace {
  double column = 0, row = 0;
};
PixelPlace pixel_at(const PlanePixels& pixels, double radius_m, double theta_rad) {
  return {pixels.center.x + radius_m * std::sin(theta_rad) / pixels.step_m[0],
          pixels.center.y + radius_m * std::cos(theta_rad) / pixels.step_m[1]};
}

std::optional<double> pixel_value(const PlanePixels& pixels,
                                  const float* picture,
                                  const PixelPlace& at) {
  const auto column = between(at.column, pixels.columns), row = between(at.row, pixels.rows);
  if (!column || !row) return {};
  const auto in_row = [&](std::size_t r) {
    const float* values = picture + r * pixels.columns;
    return (1 - column->share) * values[column->first] + column->share * values[column->second];
  };
  return (1 - row->share) * in_row(row->first) + row->share * in_row(row->second);
}

std::optional<double> voxel_value(const VoxelGrid& grid,
                                  const std::vector<float>& values,
                                  const glm::dvec3& index) {
  const auto x = between(index.x, grid.sizes[0]), y = between(index.y, grid.sizes[1]);
  const auto z = between(index.z, grid.sizes[2]);
  if (!x || !y || !z) return {};
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const bool at_x = (corner & 1) != 0, at_y = (corner & 2) != 0, at_z = (corner & 4) != 0;
    const double weight = (at_x ? x->share : 1 - x->share) * (at_y ? y->share : 1 - y->share) *
                          (at_z ? z->share : 1 - z->share);
    const std::size_t place =
        ((at_z ? z->second : z->first) * grid.sizes[1] + (at_y ? y->second : y->first)) *
            grid.sizes[0] +
        (at_x ? x->second : x->first);
    sum += weight * values[place];
  }
  return sum;
}

/// body(line, frame, samples of the stick) for all sticks of so many frames, on all threads.
template <class Body>
std::vector<float> each_stick(const hw::AcquisitionPlan& plan, int frames, const Body& body) {
  const hw::AcquisitionOptions& a = plan.acquisition();
  const auto count = static_cast<std::size_t>(a.samples_per_stick);
  const int sticks = frames * a.sticks_per_frame;
  std::vector<float> samples(static_cast<std::size_t>(sticks) * count);
  parallel_rows(sticks, [&](int stick) {
    body(stick % a.sticks_per_frame,
         stick / a.sticks_per_frame,
         samples.data() + static_cast<std::size_t>(stick) * count);
  });
  return samples;
}

}  // namespace

StickCounts sticks_of(const Geometry& geometry, double pixel_m) {
  const double middle_m = geometry.probe.radius_m + 0.5 * geometry.depth_m;
  const double axis_m = geometry.probe.wobble_radius_m + 0.5 * geometry.depth_m;
  StickCounts counts{count_within(geometry.depth_m / pixel_m, kMostSamples),
                     count_within(geometry.sector_rad * middle_m / pixel_m + 1, kMostLines),
                     count_within(geometry.fan_rad * axis_m / pixel_m + 1, kMostLines)};
  if (geometry.samples > 0) counts.samples = static_cast<std::uint64_t>(geometry.samples);
  if (geometry.frames > 0) counts.frames = static_cast<std::uint64_t>(geometry.frames);
  if (geometry.lines > 0) counts.lines = static_cast<std::uint64_t>(geometry.lines);
  return counts;
}

double share_outside(const hw::AcquisitionPlan& plan, const PlanePixels& pixels) {
  const hw::AcquisitionOptions& a = plan.acquisition();
  std::uint64_t outside = 0;
  for (int line = 0; line < a.sticks_per_frame; ++line) {
    for (int k = 0; k < a.samples_per_stick; ++k) {
      const PixelPlace at =
          pixel_at(pixels, plan.probe().radius_m + plan.sample_range_m(k), plan.theta_rad(line));
      outside += !between(at.column, pixels.columns) || !between(at.row, pixels.rows);
    }
  }
  return static_cast<double>(outside) / (double{1} * a.sticks_per_frame * a.samples_per_stick);
}

std::vector<float> sticks_of_planes(const hw::AcquisitionPlan& plan,
                                    const PlanePixels& pixels,
                                    const std::vector<float>& values,
                                    const ToSample& to_sample) {
  const std::size_t pixels_of_plane = pixels.columns * pixels.rows;
  const auto planes = static_cast<int>(values.size() / pixels_of_plane);
  return each_stick(plan, planes, [&](int line, int plane, float* samples) {
    const float* picture = values.data() + static_cast<std::size_t>(plane) * pixels_of_plane;
    for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
      const double radius_m = plan.probe().radius_m + plan.sample_range_m(k);
      const auto value =
          pixel_value(pixels, picture, pixel_at(pixels, radius_m, plan.theta_rad(line)));
      samples[k] = value ? static_cast<float>(to_sample(*value)) : 0;
    }
  });
}

double VoxelGrid::least_step_m() const {
  return std::min({glm::length(step_m[0]), glm::length(step_m[1]), glm::length(step_m[2])});
}

void set_looking_fan(VoxelGrid& grid, Geometry& geometry) {
  glm::dvec3 side(0);
  for (int axis = 0; axis < 3; ++axis) {
    const double step_m = glm::length(grid.step_m[axis]);
    side[axis] = step_m * static_cast<double>(grid.sizes.at(static_cast<std::size_t>(axis)));
    grid.step_m[axis] = glm::dvec3(0);
    grid.step_m[axis][axis] = step_m;
  }
  const double a = kLookingRadius_m;
  grid.origin_m = glm::dvec3(-0.5 * side.x, -0.5 * side.y, a) +
                  0.5 * glm::dvec3(grid.step_m[0].x, grid.step_m[1].y, grid.step_m[2].z);
  geometry.probe.radius_m = geometry.probe.wobble_radius_m = a;
  geometry.sector_rad = 2 * std::atan(0.5 * side.x / a);
  geometry.fan_rad = 2 * std::atan(0.5 * side.y / a);
  geometry.depth_m = glm::length(glm::dvec3(0.5 * side.x, 0.5 * side.y, a + side.z)) - a;
  for (const char* key : {"radius_mm", "wobble_radius_mm", "sector_deg", "fan_deg", "depth_mm"}) {
    geometry.given.insert(key);
  }
}

std::vector<float> sticks_of_grid(const hw::AcquisitionPlan& plan,
                                  const VoxelGrid& grid,
                                  const std::vector<float>& values,
                                  const ToSample& to_sample) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const glm::dmat3 to_index = glm::inverse(grid.step_m);
  const int frames = plan.acquisition().frames_per_volume;
  return each_stick(plan, frames, [&](int line, int frame, float* samples) {
    const hw::Ray ray = geometry.stick(plan.theta_rad(line), plan.frame_phi_rad(frame));
    for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
      const glm::dvec3 index = to_index * (ray.at(plan.sample_range_m(k)) - grid.origin_m);
      const auto value = voxel_value(grid, values, index);
      samples[k] = value ? static_cast<float>(to_sample(*value)) : 0;
    }
  });
}

}  // namespace wobblebench::bench
