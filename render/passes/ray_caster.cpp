// Pass 2 on the CPU side: the shader program and its uniforms. The edge becomes z in
// shaders/ray_casting/edge_detector.glsl (Difference, Eq. (1)) and
// shaders/ray_casting/ray_march.glsl (its ray length).
#include "render/passes/ray_caster.h"

#include <glad/gl.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/number_text.h"
#include "base/units.h"
#include "render/geometry/ray_sampling.h"
#include "render/leaping/empty_space.h"
#include "render/leaping/ray_spans.h"

namespace wobblebench::render {
namespace {

/// Instead of infinity, which shaders need not have.
constexpr double kNoLevel = 1e30;

enum RayBinding { kRaySlices, kRayMotionTable, kRayTransfer, kRayDistances, kRaySpans };

/// Samples of a block where the detector does not say how many.
constexpr int kBlock = 8;
/// Longest block; a longer one would not stay in registers.
constexpr int kMaxBlock = 16;

/// llvmpipe and softpipe end a pixel's loops, silently, after 65535 turns of all of them together
/// (LP_MAX_TGSI_LOOP_ITERATIONS, TGSI_EXEC_MAX_LOOP_ITERATIONS of Mesa).
constexpr double kMostLoopTurns = 65535;

/// Steps by which slice coordinates may deviate from a straight line over half a block.
constexpr double kStraightSteps = 0.02;

/// Blocks of the floor begin at multiples of their length, so that its blocks are theirs.
int first_step_multiple(const RenderOptions& options) {
  return options.ray_casting.detector == Detector::floor ? floor_mean_samples(options) : 1;
}

int block_length(const RenderOptions& options) {
  return options.ray_casting.detector == Detector::floor ? floor_mean_samples(options) : kBlock;
}

/// Whether samples are processed in blocks (ray_cast_fast.frag.glsl): without a kernel along the
/// ray.
bool in_blocks(const RenderOptions& options) {
  return buffer_weights(options.ray_casting).size() == 1 && block_length(options) <= kMaxBlock;
}

/// Whether depth and frame are nearly linear over half a block: a chord of length l at a distance d
/// from the wobble axis lies within l^2 / (8 d) of its arc. The deviation from a parabola is
/// smaller by l / d.
bool is_straight(const SliceGeometry& g, const RenderOptions& options) {
  const double half_block_steps = 0.5 * block_length(options);
  const double nearest_m = g.depth_min_m() - g.axis_z_m();
  return g.frames() > 1 &&
         half_block_steps * half_block_steps * step_m(options) < 8 * nearest_m * kStraightSteps;
}

bool is_fast(const RenderOptions& options) {
  return options.pipeline.mode == PipelineMode::fast;
}

Defines defines(const SliceGeometry& geometry, const RenderOptions& options, bool leaps) {
  const RayCastingOptions& o = options.ray_casting;
  return Defines()
      .add("BIND_SLICES", kRaySlices)
      .add("BIND_MOTION_TABLE", kRayMotionTable)
      .add("BIND_TRANSFER", kRayTransfer)
      .add("BIND_DISTANCES", kRayDistances)
      .add("BIND_SPANS", kRaySpans)
      .add("TILE", kTilePixels)
      .add("NO_SURFACE", kNoDepth)
      .add("TRANSFER_SIZE", kTransferTableSize)
      .add("FRAMES", geometry.frames())
      .add("SKEWED", geometry.is_skewed())
      .add("KERNEL", ray_kernel_size(o))
      .add("TAPS", static_cast<int>(buffer_weights(o).size()))
      .add("DETECTOR", static_cast<int>(o.detector))
      .add("DETECTOR_ISO", static_cast<int>(Detector::iso))
      .add("CAPS", o.caps)
      .add("DETECTOR_FLOOR", static_cast<int>(Detector::floor))
      .add("BUFFER", o.detector == Detector::paper ? buffer_samples(options) : 2)
      .add("REFILL", detector_samples(options))
      .add("FIRST_STEP_MULTIPLE", first_step_multiple(options))
      .add("BLOCK", block_length(options))
      .add("MEAN", floor_mean_samples(options))
      .add("FLOOR_BLOCKS", kFloorBlocks)
      .add("PAIRS", is_fast(options))
      .add("BLOCKS", in_blocks(options))
      .add("STRAIGHT", is_straight(geometry, options))
      .add("LEAPS", leaps)
      .add("DETECT", o.mode != RenderMode::volume)
      .add("BLEND", o.mode != RenderMode::surface)
      .add("PERSPECTIVE", options.view.projection == Projection::perspective)
      .add("REFINE_CROSSING", o.refine_crossing)
      .add("STOP_ON_LEAVING_CONE", o.stop_on_leaving_cone);
}

/// Longest way of a ray: between opposite corners of a box around those in which it begins and
/// ends; with `clipped`, which rays that leap are, around the cone of valid data.
double longest_ray_m(const SliceGeometry& geometry, const RenderOptions& options, bool clipped) {
  const VolumeOfInterest& start = options.volume_of_interest;
  const VolumeOfInterest end = options.ray_casting.stop_at_box ? start : field_box(geometry);
  const glm::dvec3 low =
      glm::min(start.center_m - 0.5 * start.size_m, end.center_m - 0.5 * end.size_m);
  const glm::dvec3 high =
      glm::max(start.center_m + 0.5 * start.size_m, end.center_m + 0.5 * end.size_m);
  const double in_boxes_m = glm::distance(low, high);
  const double half_fan_rad = std::max(-geometry.phi_min_rad(), geometry.phi_max_rad());
  if (!clipped || half_fan_rad > 0.5 * kPi) return in_boxes_m;
  const double axis_m = geometry.axis_z_m();
  const glm::dvec3 cone_m(
      2 * geometry.x_max_m(),
      2 * (geometry.r_max_m() - axis_m) * std::sin(half_fan_rad),
      geometry.r_max_m() - axis_m - (geometry.depth_min_m() - axis_m) * std::cos(half_fan_rad));
  return std::min(in_boxes_m, glm::length(cone_m));
}

/// Turns of a ray's loops, at most. `leaps`: it is clipped to the cone, may take a step twice, to
/// fill its kernel again behind a leap, and looks where to leap to.
double loop_turns(const SliceGeometry& geometry, const RenderOptions& options, bool leaps) {
  const double steps = longest_ray_m(geometry, options, leaps) / step_m(options) + 1;
  const auto taps = static_cast<double>(buffer_weights(options.ray_casting).size());
  if (leaps && in_blocks(options)) return steps / block_length(options);
  const double turns_a_step = taps > 1 ? 1 + taps : 1;
  return steps * (leaps ? 2 * turns_a_step + 1 : turns_a_step);
}

bool counts_loop_turns() {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string_view driver = name ? name : "";
  return driver.starts_with("llvmpipe") || driver.starts_with("softpipe");
}

/// Throws std::runtime_error where rays would end before their last step.
void check_loop_turns(double turns, const RenderOptions& options) {
  if (turns <= kMostLoopTurns) return;
  throw std::runtime_error(
      "render.ray_casting.steps = " + std::to_string(options.ray_casting.steps) +
      ": this software driver ends the loops of a pixel after 65535 turns, and the longest ray "
      "takes " +
      significant(turns, 3) +
      ": take fewer steps, a smaller window_2d or kernel_3d, or a deeper volume of interest");
}

/// The table of the transfer function, each entry with the next.
std::vector<float> transfer_pairs(const RenderOptions& options) {
  const auto table =
      TransferFunction(options.ray_casting, step_m(options)).table(kTransferTableSize);
  std::vector<float> pairs;
  for (std::size_t entry = 0; entry < table.size(); entry += 2) {
    const std::size_t next = std::min(entry + 2, table.size() - 2);
    pairs.insert(pairs.end(), {table[entry], table[entry + 1], table[next], table[next + 1]});
  }
  return pairs;
}

FragmentProgram make_program(const Defines& defines, bool leaps_or_blocks) {
  if (leaps_or_blocks) {
    return FragmentProgram({"ray.glsl",
                            "cone.glsl",
                            "ray_kernel.glsl",
                            "edge_detector.glsl",
                            "block_detector.glsl",
                            "ray_march.glsl",
                            "ray_cast_fast.frag.glsl"},
                           defines);
  }
  return FragmentProgram({"ray.glsl",
                          "cone.glsl",
                          "ray_kernel.glsl",
                          "edge_detector.glsl",
                          "ray_march.glsl",
                          "ray_cast.frag.glsl"},
                         defines);
}

}  // namespace

RayCaster::RayCaster(const SliceGeometry& geometry,
                     const RenderOptions& options,
                     SliceVolume& volume)
    : geometry_(geometry), measures_level_(options.ray_casting.detector != Detector::paper) {
  const int size = options.ray_casting.image_size;
  const std::string what = "ray_casting.image_size = " + std::to_string(size);
  color_ = Texture(what, TexelFormat::rgba32f, {size, size}, TextureFilter::nearest);
  depth_ = Texture(what, TexelFormat::r32f, {size, size}, TextureFilter::nearest);
  const bool blends = options.ray_casting.mode != RenderMode::surface;
  target_ = blends ? Framebuffer({&depth_, &color_}) : Framebuffer({&depth_});
  transfer_ = Texture(
      "transfer function", TexelFormat::rgba32f, {kTransferTableSize, 1}, TextureFilter::nearest);
  transfer_.upload(transfer_pairs(options));
  const EmptySpace* empty_space = volume.empty_space();
  const bool leaps = empty_space && empty_space->cells().can_leap();
  const bool fits = !counts_loop_turns() || loop_turns(geometry, options, leaps) <= kMostLoopTurns;
  if (!fits) check_loop_turns(loop_turns(geometry, options, false), options);
  leaps_ = leaps && fits;
  ray_cast_ = make_program(defines(geometry, options, leaps_), is_fast(options) && fits);
  set_view(options);
  set_box(options);
  set_cone(volume.pixels());
  is_fast(options) ? set_fan() : set_motion_table();
  if (leaps_) set_macrocells(empty_space->cells());
  set_sampling(options);
  check_gl("ray casting: setting up");
}

void set_camera(FragmentProgram& program, const RenderOptions& options) {
  const Camera camera = make_camera(options);
  program.set("center_m", camera.center)
      .set("right", camera.right)
      .set("down", camera.down)
      .set("forward", camera.forward)
      .set("pixel_m", camera.pixel_m())
      .set("image_size", static_cast<double>(camera.image_size))
      .set("plane_distance_m", camera.plane_distance_m)
      .set("eye_distance_m", camera.eye_distance_m);
}

void RayCaster::set_view(const RenderOptions& options) {
  set_camera(ray_cast_, options);
}

void RayCaster::set_box(const RenderOptions& options) {
  const VolumeOfInterest box = options.volume_of_interest;
  const VolumeOfInterest end = options.ray_casting.stop_at_box ? box : field_box(geometry_);
  ray_cast_.set("start_center_m", box.center_m)
      .set("start_half_m", 0.5 * box.size_m)
      .set("end_center_m", end.center_m)
      .set("end_half_m", 0.5 * end.size_m);
}

void RayCaster::set_cone(const Region& pixels) {
  const SliceGeometry& g = geometry_;
  const glm::dvec2 begin_m(g.pixel_x_m(pixels.column - 0.5), g.pixel_depth_m(pixels.row - 0.5));
  const glm::dvec2 end_m(g.pixel_x_m(pixels.column + pixels.columns - 0.5),
                         g.pixel_depth_m(pixels.row + pixels.rows - 0.5));
  const glm::dvec2 slice_scale = 1.0 / (end_m - begin_m);
  ray_cast_.set("slice_scale", slice_scale)
      .set("slice_offset", -begin_m * slice_scale)
      .set("r_min_m", g.r_min_m())
      .set("r_max_m", g.r_max_m())
      .set("tan_half_sector", std::tan(g.half_sector_rad()));
}

void RayCaster::set_motion_table() {
  const MotionTable table = make_motion_table(geometry_, kMotionTableSize);
  motion_table_ =
      Texture("motion LUT", TexelFormat::rgb32f, {table.size, table.size}, TextureFilter::linear);
  motion_table_.upload(table.values);
  // The centres of the first and last entries lie half a texel inside the texture.
  const double entries = table.size - 1, texels = table.size;
  const glm::dvec2 motion_scale(entries / texels / (table.y_max_m - table.y_min_m),
                                entries / texels / (table.z_max_m - table.z_min_m));
  const glm::dvec2 motion_offset =
      0.5 / texels - motion_scale * glm::dvec2(table.y_min_m, table.z_min_m);
  ray_cast_.set("motion_scale", motion_scale).set("motion_offset", motion_offset);
}

void RayCaster::set_fan() {
  const SliceGeometry& g = geometry_;
  ray_cast_.set("axis_z_m", g.axis_z_m())
      .set("middle_frame", g.frame_at(0))
      .set("frames_per_rad", g.frame_at(1) - g.frame_at(0));
  if (g.frames() == 1) {
    ray_cast_.set("phi_min_rad", g.phi_min_rad()).set("phi_max_rad", g.phi_max_rad());
  }
}

void RayCaster::set_macrocells(const SkippableCells& cells) {
  const SliceGeometry& g = geometry_;
  const MacrocellGrid& grid = cells.grid();
  // Inward normals of the fan's sides over (y, z - axis): phi = atan(-y / (z - axis)).
  const double rounding_rad = 1e-5;
  const double first = g.phi_min_rad() - rounding_rad, last = g.phi_max_rad() + rounding_rad;
  const glm::dvec2 origin_m(g.pixel_x_m(grid.pixels.column - 0.5),
                            g.pixel_depth_m(grid.pixels.row - 0.5));
  const glm::dvec2 end_m(g.pixel_x_m(grid.pixels.column + grid.cell_pixels - 0.5),
                         g.pixel_depth_m(grid.pixels.row + grid.cell_pixels - 0.5));
  ray_cast_.set("cell_origin_m", origin_m)
      .set("cell_m", end_m - origin_m)
      .set("fan_side_1", glm::dvec2(-std::cos(first), -std::sin(first)))
      .set("fan_side_2", glm::dvec2(std::cos(last), std::sin(last)))
      .set("axis_distance_max_m", g.r_max_m() - g.axis_z_m())
      .set("x_max_m", g.x_max_m());
}

void RayCaster::set_sampling(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  ray_cast_.set("step_m", step_m(options))
      .set("along_weights", gaussian_weights(ray_kernel_size(o)))
      .set("buffer_weights", buffer_weights(o))
      .set("blend_weights", blend_weights(o))
      .set("threshold", difference_threshold(options))
      .set("edge_sign", o.edge == EdgeSign::rising ? 1.0 : -1.0)
      .set("opacity_limit", o.opacity_limit);
}

void RayCaster::cast(SliceVolume& volume) {
  if (measures_level_) ray_cast_.set("threshold", std::min(volume.level(), kNoLevel));
  ray_cast_.set("first_frame", volume.covered().first).set("last_frame", volume.covered().last);
  if (geometry_.is_skewed()) ray_cast_.set("frame_skew", geometry_.frame_skew(volume.sweep));
  const Binding slices{kRaySlices, &volume.slices()}, transfer{kRayTransfer, &transfer_};
  if (leaps_) {
    EmptySpace& space = *volume.empty_space();
    const Binding distances{kRayDistances, &space.distances()}, spans{kRaySpans, &space.spans()};
    ray_cast_.draw(target_, {slices, transfer, distances, spans});
  } else if (motion_table_) {
    ray_cast_.draw(target_, {slices, {kRayMotionTable, &motion_table_}, transfer});
  } else {
    ray_cast_.draw(target_, {slices, transfer});
  }
  check_gl("ray casting");
}

}  // namespace wobblebench::render
