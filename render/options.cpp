#include "render/options.h"

#include <algorithm>
#include <functional>

#include "base/number_text.h"
#include "render/camera.h"
#include "render/geometry/ray_sampling.h"

namespace wobblebench::render {
namespace {

void check_odd(const std::string& key, int value) {
  if (value % 2 == 0) throw InvalidOption(key, std::to_string(value), "must be odd");
}

void check_transfer_function(const RayCastingOptions& o) {
  const std::vector<double>& values = o.transfer_values;
  const std::string numbers = std::to_string(values.size()) + " numbers";
  if (values.size() < 2) {
    throw InvalidOption("ray_casting.transfer_values", numbers, "takes at least 2");
  }
  if (std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end()) {
    throw InvalidOption("ray_casting.transfer_values", numbers, "must ascend");
  }
  const auto check_length = [&](const char* key, const std::vector<double>& list) {
    if (list.size() == values.size()) return;
    throw InvalidOption(std::string("ray_casting.") + key,
                        std::to_string(list.size()) + " numbers",
                        "takes as many as transfer_values, " + numbers);
  };
  check_length("transfer_opacity_per_mm", o.transfer_opacity_per_mm);
  check_length("transfer_grey", o.transfer_grey);
}

void check_buffer_length(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  if (o.buffer_length % 2 != 0) {
    throw InvalidOption(
        "ray_casting.buffer_length", std::to_string(o.buffer_length), "must be even");
  }
  if (o.buffer_length_m == 0) return;
  const std::string length = significant(o.buffer_length_m / kMillimetre, 6);
  if (o.buffer_length != RayCastingOptions{}.buffer_length) {
    throw InvalidOption(
        "ray_casting.buffer_length_mm", length, "cannot be given with buffer_length");
  }
  const int n = buffer_samples(options);
  if (n < 2 || n > kLongestBuffer) {
    throw InvalidOption("ray_casting.buffer_length_mm",
                        length,
                        "must be 2 to " + std::to_string(kLongestBuffer) + " steps of " +
                            significant(step_m(options) / kMillimetre, 3) + " mm");
  }
}

void check_threshold(const RayCastingOptions& o) {
  if (o.threshold_per_sample == 0 || o.threshold == RayCastingOptions{}.threshold) return;
  throw InvalidOption("ray_casting.threshold_per_sample",
                      significant(o.threshold_per_sample, 6),
                      "cannot be given with threshold");
}

}  // namespace

bool has_stick_levels(const RenderOptions& options) {
  const RayCastingOptions& o = options.ray_casting;
  return o.detector != Detector::paper && !o.iso_level && o.mode != RenderMode::volume;
}

void validate(const RenderOptions& options) {
  check_options(options.pipeline, "pipeline.");
  check_options(options.reconstruction, "reconstruction.");
  check_options(options.scan_conversion, "scan_conversion.");
  check_options(options.volume_of_interest, "volume_of_interest.");
  check_options(options.view, "view.");
  check_options(options.ray_casting, "ray_casting.");
  check_options(options.shading, "shading.");
  check_options(options.smoothing, "smoothing.");
  check_odd("scan_conversion.filter_size", options.scan_conversion.filter_size);
  check_odd("ray_casting.kernel_3d", options.ray_casting.kernel_3d);
  check_odd("ray_casting.window_2d", options.ray_casting.window_2d);
  check_odd("shading.depth_filter_size", options.shading.depth_filter_size);
  check_odd("smoothing.filter_size", options.smoothing.filter_size);
  check_buffer_length(options);
  check_threshold(options.ray_casting);
  check_transfer_function(options.ray_casting);
  if (options.reconstruction.sticks == Sticks::aligned && options.pipeline.mid_volume) {
    throw InvalidOption(
        "pipeline.mid_volume",
        "true",
        "needs reconstruction.sticks plain; sticks are aligned once a volume is whole");
  }
  if (has_stick_levels(options) && options.pipeline.mid_volume) {
    throw InvalidOption("pipeline.mid_volume",
                        "true",
                        "needs a number as ray_casting.iso_level; the level of each stick is found "
                        "once a volume is whole");
  }
  if (options.shading.base == ShadingBase::rendered &&
      options.ray_casting.mode == RenderMode::surface) {
    throw InvalidOption(
        "shading.base", "rendered", "needs ray_casting.mode both; surface blends no picture");
  }
}

}  // namespace wobblebench::render
