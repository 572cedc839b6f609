#include "bench/tables/setting.h"

#include <stdexcept>

namespace wobblebench::bench {

std::string to_string(Way way) {
  switch (way) {
    case Way::plain:
      return "plain";
    case Way::plain_slice:
      return "plain_slice";
    case Way::fast:
      return "fast";
    case Way::fast_ray:
      return "fast_ray";
  }
  throw std::logic_error("way " + std::to_string(static_cast<int>(way)) + ": has no name");
}

std::vector<Way> ways_of(const Table& table) {
  if (table.id != "III") return {Way::plain, Way::fast};
  return {Way::plain, Way::plain_slice, Way::fast, Way::fast_ray};
}

render::RenderOptions rendered(Way way, render::RenderOptions options) {
  const bool plain = way == Way::plain || way == Way::plain_slice;
  const bool ray = way == Way::plain || way == Way::fast_ray;
  options.pipeline.mode = plain ? render::PipelineMode::plain : render::PipelineMode::fast;
  options.ray_casting.kernel_space = ray ? render::KernelSpace::ray : render::KernelSpace::slice;
  return options;
}

}  // namespace wobblebench::bench
