#include "render/ray_caster.h"

#include <cmath>

#include "render/ray_sampling.h"

namespace wobblebench::render {
namespace {

enum Bindings { kSlices, kMotionTable, kTransfer };

Defines defines(const SliceGeometry& geometry, const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  return Defines()
      .add("BIND_SLICES", kSlices)
      .add("BIND_MOTION_TABLE", kMotionTable)
      .add("BIND_TRANSFER", kTransfer)
      .add("NO_SURFACE", kNoDepth)
      .add("TRANSFER_SIZE", kTransferTableSize)
      .add("FRAMES", geometry.frames())
      .add("KERNEL", o.kernel_3d)
      .add("TAPS", static_cast<int>(buffer_weights(o).size()))
      .add("BUFFER", o.buffer_length)
      .add("DETECT", o.mode != RenderMode::volume)
      .add("BLEND", o.mode != RenderMode::surface)
      .add("PERSPECTIVE", options.view.projection == Projection::perspective)
      .add("REFINE_CROSSING", o.refine_crossing)
      .add("STOP_ON_LEAVING_CONE", o.stop_on_leaving_cone);
}

glm::dvec3 vec3(const std::vector<double>& numbers) {
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

}  // namespace

RayCaster::RayCaster(const SliceGeometry& geometry, const RenderOptions& options) {
  const int size = options.ray_casting.image_size;
  const std::string what = "ray_casting.image_size = " + std::to_string(size);
  color_ = Texture(what, TexelFormat::rgba32f, {size, size}, TextureFilter::nearest);
  depth_ = Texture(what, TexelFormat::r32f, {size, size}, TextureFilter::nearest);
  target_ = Framebuffer({&color_, &depth_});
  transfer_ = Texture(
      "transfer function", TexelFormat::rg32f, {kTransferTableSize, 1}, TextureFilter::linear);
  transfer_.upload(
      TransferFunction(options.ray_casting, step_m(options)).table(kTransferTableSize));
  ray_cast_ = FragmentProgram({"ray_cast.frag.glsl"}, defines(geometry, options));
  set_camera(options);
  set_geometry(geometry, options);
  set_sampling(options);
  check_gl("ray casting: setting up");
}

void RayCaster::set_camera(const RenderOptions& options) {
  const Camera camera = make_camera(options);
  ray_cast_.set("center_m", camera.center)
      .set("right", camera.right)
      .set("down", camera.down)
      .set("forward", camera.forward)
      .set("pixel_m", camera.pixel_m())
      .set("image_size", static_cast<double>(camera.image_size))
      .set("plane_distance_m", camera.plane_distance_m)
      .set("eye_distance_m", camera.eye_distance_m);
}

void RayCaster::set_geometry(const SliceGeometry& g, const RenderOptions& options) {
  const MotionTable table = make_motion_table(g, kMotionTableSize);
  motion_table_ =
      Texture("motion LUT", TexelFormat::rgb32f, {table.size, table.size}, TextureFilter::linear);
  motion_table_.upload(table.values);
  // The first and last entries' middles lie half a texel inside the texture.
  const double entries = table.size - 1, texels = table.size;
  const glm::dvec2 motion_scale(entries / texels / (table.y_max_m - table.y_min_m),
                                entries / texels / (table.z_max_m - table.z_min_m));
  const glm::dvec2 motion_offset =
      0.5 / texels - motion_scale * glm::dvec2(table.y_min_m, table.z_min_m);
  const glm::dvec2 slice_scale(0.5 / g.x_max_m(), 1 / (g.depth_max_m() - g.depth_min_m()));
  const VolumeOfInterest box = options.volume_of_interest;
  const VolumeOfInterest end = options.ray_casting.stop_at_box ? box : field_box(g);
  ray_cast_.set("motion_scale", motion_scale)
      .set("motion_offset", motion_offset)
      .set("slice_scale", slice_scale)
      .set("slice_offset", glm::dvec2(0.5, -g.depth_min_m() * slice_scale.y))
      .set("r_min_m", g.r_min_m())
      .set("r_max_m", g.r_max_m())
      .set("tan_half_sector", std::tan(g.half_sector_rad()))
      .set("start_center_m", vec3(box.center_m))
      .set("start_half_m", 0.5 * vec3(box.size_m))
      .set("end_center_m", vec3(end.center_m))
      .set("end_half_m", 0.5 * vec3(end.size_m));
}

void RayCaster::set_sampling(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  ray_cast_.set("step_m", step_m(options))
      .set("along_weights", gaussian_weights(o.kernel_3d))
      .set("buffer_weights", buffer_weights(o))
      .set("blend_weights", blend_weights(o))
      .set("threshold", o.threshold)
      .set("edge_sign", o.edge == EdgeSign::rising ? 1.0 : -1.0)
      .set("opacity_limit", o.opacity_limit);
}

void RayCaster::cast(const Texture& slices) {
  ray_cast_.draw(target_,
                 {{kSlices, &slices}, {kMotionTable, &motion_table_}, {kTransfer, &transfer_}});
  check_gl("ray casting");
}

}  // namespace wobblebench::render
