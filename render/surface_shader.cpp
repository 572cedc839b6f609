#include "render/surface_shader.h"

#include "render/camera.h"
#include "render/lighting.h"
#include "render/ray_caster.h"

namespace wobblebench::render {
namespace {

namespace depth_filter {
enum Bindings { kDepth };
}
namespace surface_shade {
enum Bindings { kDepth };
}

Defines shade_defines(const RenderOptions& options) {
  return Defines()
      .add("BIND_DEPTH", surface_shade::kDepth)
      .add("NO_SURFACE", kNoDepth)
      .add("PERSPECTIVE", options.view.projection == Projection::perspective)
      .add("POINT_LIGHT", options.shading.light == Light::point)
      .add("SHADOWS", options.shading.shadows)
      .add("MAX_SHADOW_STEPS", max_shadow_steps(options.ray_casting.image_size));
}

void set_uniforms(FragmentProgram& program, const RenderOptions& options) {
  const Camera camera = make_camera(options);
  const ShadingOptions& o = options.shading;
  program.set("pixel_m", camera.pixel_m())
      .set("image_size", static_cast<double>(camera.image_size))
      .set("eye_distance_m", camera.eye_distance_m)
      .set("light_position_m", light_position_m(o, camera))
      .set("light_direction", light_direction(o))
      .set("base_rgb", glm::dvec3(o.base_rgb.at(0), o.base_rgb.at(1), o.base_rgb.at(2)))
      .set("ambient", o.ambient)
      .set("diffuse", o.diffuse)
      .set("specular", o.specular)
      .set("shininess", o.shininess)
      .set("shadow_coefficient", o.shadow_coefficient)
      .set("shadow_bias_m", o.shadow_bias_m);
}

}  // namespace

SurfaceShader::SurfaceShader(const RenderOptions& options) {
  const int size = options.ray_casting.image_size;
  const std::string what = "ray_casting.image_size = " + std::to_string(size);
  filtered_ = Texture(what, TexelFormat::r32f, {size, size}, TextureFilter::nearest);
  surface_ = Texture(what, TexelFormat::rgba32f, {size, size}, TextureFilter::nearest);
  filtered_target_ = Framebuffer({&filtered_});
  surface_target_ = Framebuffer({&surface_});
  filter_ = FragmentProgram({"depth_filter.frag.glsl"},
                            Defines()
                                .add("BIND_DEPTH", depth_filter::kDepth)
                                .add("HALF_FILTER", options.shading.depth_filter_size / 2));
  shade_ = FragmentProgram({"view.glsl", "surface_shade.frag.glsl"}, shade_defines(options));
  set_uniforms(shade_, options);
  check_gl("surface shading: setting up");
}

void SurfaceShader::shade(const Texture& depth) {
  filter_.draw(filtered_target_, {{depth_filter::kDepth, &depth}});
  shade_.draw(surface_target_, {{surface_shade::kDepth, &filtered_}});
  check_gl("surface shading");
}

}  // namespace wobblebench::render
