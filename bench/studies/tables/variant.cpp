#include "bench/studies/tables/variant.h"

#include <stdexcept>

namespace wobblebench::bench {

std::string to_string(PipelineVariant variant) {
  switch (variant) {
    case PipelineVariant::plain:
      return "plain";
    case PipelineVariant::plain_slice:
      return "plain_slice";
    case PipelineVariant::fast:
      return "fast";
    case PipelineVariant::fast_ray:
      return "fast_ray";
  }
  throw std::logic_error("variant " + std::to_string(static_cast<int>(variant)) + ": has no name");
}

std::vector<PipelineVariant> variants_of(const Table& table) {
  if (table.id != "III") return {PipelineVariant::plain, PipelineVariant::fast};
  return {PipelineVariant::plain,
          PipelineVariant::plain_slice,
          PipelineVariant::fast,
          PipelineVariant::fast_ray};
}

render::RenderOptions rendered(PipelineVariant variant, render::RenderOptions options) {
  const bool plain = variant == PipelineVariant::plain || variant == PipelineVariant::plain_slice;
  const bool ray = variant == PipelineVariant::plain || variant == PipelineVariant::fast_ray;
  options.pipeline.mode = plain ? render::PipelineMode::plain : render::PipelineMode::fast;
  options.ray_casting.kernel_space = ray ? render::KernelSpace::ray : render::KernelSpace::slice;
  return options;
}

}  // namespace wobblebench::bench
