#include "render/passes/smoother.h"

#include <cmath>
#include <numbers>

namespace wobblebench::render {
namespace {

enum SmoothBinding { kSmoothPicture, kSmoothSource };
/// Operation of a step of shaders/smoothing/smooth_lines.frag.glsl and smooth_guided.frag.glsl.
enum StepKind { kMeans, kMoments, kCoefficients, kApply };

Defines defines(const SmoothingOptions& options) {
  return Defines()
      .add("BIND_PICTURE", kSmoothPicture)
      .add("BIND_SOURCE", kSmoothSource)
      .add("HALF_FILTER", options.filter_size / 2);
}

Defines step_defines(const SmoothingOptions& options, StepKind kind) {
  return defines(options)
      .add("MOMENTS", kMoments)
      .add("COEFFICIENTS", kCoefficients)
      .add("APPLY", kApply)
      .add("STEP", kind);
}

FragmentProgram plain_window(const SmoothingOptions& options) {
  FragmentProgram program(
      {"smooth.frag.glsl"},
      defines(options).add("BILATERAL", options.filter == SmoothingFilter::bilateral));
  program.set("range_sigma", options.range_sigma)
      .set("spatial_sigma", bilateral_spatial_sigma(options.filter_size));
  return program;
}

FragmentProgram plain_guided(const SmoothingOptions& options, StepKind kind) {
  FragmentProgram program({"smooth_guided.frag.glsl"}, step_defines(options, kind));
  program.set("range_sigma", options.range_sigma);
  return program;
}

FragmentProgram lines(const SmoothingOptions& options, bool columns, StepKind kind) {
  FragmentProgram program({"smooth_lines.frag.glsl"},
                          step_defines(options, kind).add("ALONG_COLUMNS", columns));
  program.set("range_sigma", options.range_sigma);
  return program;
}

FragmentProgram fast_bilateral(const SmoothingOptions& options) {
  FragmentProgram program({"smooth_bilateral.frag.glsl"}, defines(options));
  const auto bits = [](double sigma) { return 0.5 * std::numbers::log2e / (sigma * sigma); };
  program.set("range_bits", bits(options.range_sigma))
      .set("spatial_bits", bits(bilateral_spatial_sigma(options.filter_size)));
  return program;
}

std::vector<FragmentProgram> plain_steps(const SmoothingOptions& options) {
  std::vector<FragmentProgram> steps;
  if (options.filter == SmoothingFilter::guided) {
    steps.push_back(plain_guided(options, kCoefficients));
    steps.push_back(plain_guided(options, kApply));
  } else {
    steps.push_back(plain_window(options));
  }
  return steps;
}

std::vector<FragmentProgram> fast_steps(const SmoothingOptions& options) {
  std::vector<FragmentProgram> steps;
  switch (options.filter) {
    case SmoothingFilter::box:
      steps.push_back(lines(options, false, kMeans));
      steps.push_back(lines(options, true, kMeans));
      break;
    case SmoothingFilter::bilateral:
      steps.push_back(fast_bilateral(options));
      break;
    case SmoothingFilter::guided:
      steps.push_back(lines(options, false, kMoments));
      steps.push_back(lines(options, true, kCoefficients));
      steps.push_back(lines(options, false, kMeans));
      steps.push_back(lines(options, true, kApply));
      break;
  }
  return steps;
}

}  // namespace

Smoother::Smoother(const SmoothingOptions& options, int image_size, PipelineMode mode)
    : steps_(mode == PipelineMode::fast ? fast_steps(options) : plain_steps(options)) {
  const std::string what = "ray_casting.image_size = " + std::to_string(image_size);
  const Extent extent{image_size, image_size};
  smoothed_ = Texture(what, TexelFormat::rgba32f, extent, TextureFilter::nearest);
  smoothed_target_ = Framebuffer({&smoothed_});
  if (steps_.size() > 1) {
    between_ = Texture(what, TexelFormat::rgba32f, extent, TextureFilter::nearest);
    between_target_ = Framebuffer({&between_});
  }
  check_gl("smoothing: setting up");
}

void Smoother::smooth(const Texture& picture) {
  const Texture* source = &picture;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const bool to_smoothed = (steps_.size() - i) % 2 == 1;  // the last one is
    steps_[i].draw(to_smoothed ? smoothed_target_ : between_target_,
                   {{kSmoothPicture, &picture}, {kSmoothSource, source}});
    source = to_smoothed ? &smoothed_ : &between_;
  }
  check_gl("smoothing");
}

}  // namespace wobblebench::render
