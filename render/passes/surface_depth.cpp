#include "render/passes/surface_depth.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/camera.h"
#include "render/passes/ray_caster.h"

namespace wobblebench::render {
namespace {

enum FilterBinding { kFilterDepth, kFilterSums, kFiltered };

FragmentProgram lines_program(const RenderOptions& options, int size, bool columns) {
  FragmentProgram program({"depth_lines.frag.glsl"},
                          Defines()
                              .add("BIND_DEPTH", kFilterDepth)
                              .add("BIND_SUMS", kFilterSums)
                              .add("COLUMNS", columns)
                              .add("HALF_FILTER", size / 2));
  const Camera camera = make_camera(options);
  const bool parallel = camera.projection == Projection::parallel;
  program.set("middle_m", parallel ? camera.plane_distance_m : camera.eye_distance_m);
  return program;
}

FragmentProgram window_program(int size) {
  return {{"depth_filter.frag.glsl"},
          Defines().add("BIND_DEPTH", kFilterDepth).add("HALF_FILTER", size / 2)};
}

}  // namespace

DepthFilter::DepthFilter(const RenderOptions& options, int size)
    : fast_(options.pipeline.mode == PipelineMode::fast) {
  const int side = options.ray_casting.image_size;
  const std::string what = "ray_casting.image_size = " + std::to_string(side);
  filtered_ = Texture(what, TexelFormat::r32f, {side, side}, TextureFilter::nearest);
  filtered_target_ = Framebuffer({&filtered_});
  filter_ = fast_ ? lines_program(options, size, true) : window_program(size);
  if (!fast_) return;
  sums_ = Texture(what, TexelFormat::rg32f, {side, side}, TextureFilter::nearest);
  sums_target_ = Framebuffer({&sums_});
  rows_ = lines_program(options, size, false);
}

void DepthFilter::filter(const Texture& depth) {
  if (!fast_) return filter_.draw(filtered_target_, {{kFilterDepth, &depth}});
  rows_.draw(sums_target_, {{kFilterDepth, &depth}});
  filter_.draw(filtered_target_, {{kFilterDepth, &depth}, {kFilterSums, &sums_}});
}

int normal_window(const RenderOptions& options) {
  const double pixels = kNormalWindow_m / make_camera(options).pixel_m();
  return 2 * static_cast<int>(std::clamp(std::floor(0.5 * pixels), 1.0, 15.0)) + 1;
}

hw::BeamWidth correction_length(const RayCastingOptions& options, const hw::BeamWidth& beam) {
  if (const auto& length_m = options.incidence_correction_m) return {*length_m, *length_m};
  return {kShareOfWidth * beam.lateral_m, kShareOfWidth * beam.elevation_m};
}

bool IncidenceCorrection::acts(const RenderOptions& options) {
  return options.ray_casting.incidence_correction_m != 0.0 &&
         options.ray_casting.mode != RenderMode::volume;
}

IncidenceCorrection::IncidenceCorrection(const SliceGeometry& geometry,
                                         const hw::BeamWidths& beam,
                                         const RenderOptions& options)
    : active_(acts(options)) {
  if (!active_) return;
  const int size = options.ray_casting.image_size;
  filter_ = DepthFilter(options, normal_window(options));
  corrected_ = Texture("ray_casting.image_size = " + std::to_string(size),
                       TexelFormat::r32f,
                       {size, size},
                       TextureFilter::nearest);
  target_ = Framebuffer({&corrected_});
  program_ =
      FragmentProgram({"ray.glsl", "incidence.frag.glsl"},
                      Defines()
                          .add("BIND_DEPTH", kFilterDepth)
                          .add("BIND_FILTERED", kFiltered)
                          .add("BEAM_ROWS", hw::BeamWidths::kRows)
                          .add("PERSPECTIVE", options.view.projection == Projection::perspective));
  std::vector<double> lateral_m, elevation_m;
  for (const hw::BeamWidth& width : beam.rows()) {
    const hw::BeamWidth length = correction_length(options.ray_casting, width);
    lateral_m.push_back(length.lateral_m);
    elevation_m.push_back(length.elevation_m);
  }
  program_.set("axis_z_m", geometry.axis_z_m())
      .set("face_radius_m", geometry.r_min_m())
      .set("first_row_m", beam.first_m())
      .set("last_row_m", beam.last_m())
      .set("lateral_m", lateral_m)
      .set("elevation_m", elevation_m)
      .set("max_tangent", kMaxTangent);
  set_view(options);
  check_gl("incidence correction: setting up");
}

void IncidenceCorrection::set_view(const RenderOptions& options) {
  if (active_) set_camera(program_, options);
}

const Texture& IncidenceCorrection::correct(const Texture& depth) {
  if (!active_) return depth;
  filter_.filter(depth);
  program_.draw(target_, {{kFilterDepth, &depth}, {kFiltered, &filter_.filtered()}});
  check_gl("incidence correction");
  return corrected_;
}

}  // namespace wobblebench::render
