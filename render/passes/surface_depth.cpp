#include "render/passes/surface_depth.h"

#include "render/camera.h"

namespace wobblebench::render {
namespace {

enum Bindings { kDepth, kSums };

FragmentProgram lines_program(const RenderOptions& options, int size, bool columns) {
  FragmentProgram program({"depth_lines.frag.glsl"},
                          Defines()
                              .add("BIND_DEPTH", kDepth)
                              .add("BIND_SUMS", kSums)
                              .add("COLUMNS", columns)
                              .add("HALF_FILTER", size / 2));
  const Camera camera = make_camera(options);
  const bool parallel = camera.projection == Projection::parallel;
  program.set("middle_m", parallel ? camera.plane_distance_m : camera.eye_distance_m);
  return program;
}

FragmentProgram window_program(int size) {
  return {{"depth_filter.frag.glsl"},
          Defines().add("BIND_DEPTH", kDepth).add("HALF_FILTER", size / 2)};
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
  if (!fast_) return filter_.draw(filtered_target_, {{kDepth, &depth}});
  rows_.draw(sums_target_, {{kDepth, &depth}});
  filter_.draw(filtered_target_, {{kDepth, &depth}, {kSums, &sums_}});
}

}  // namespace wobblebench::render
