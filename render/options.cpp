#include "render/options.h"

#include <algorithm>
#include <functional>

namespace wobblebench::render {
namespace {

/// OptionCheck whose keys are led by the section's name.
class SectionCheck {
 public:
  explicit SectionCheck(std::string section) : section_(std::move(section) + ".") {}

  std::string full(std::string_view key) const { return section_ + std::string(key); }

  void real(std::string_view key, double& value, double unit, double min, double max) {
    check_.real(full(key), value, unit, min, max);
  }
  void integer(std::string_view key, int& value, int min, int max) {
    check_.integer(full(key), value, min, max);
  }
  void flag(std::string_view, bool&) {}
  template <class Enum>
  void choice(std::string_view, Enum&, std::initializer_list<std::pair<std::string_view, Enum>>) {}
  void reals(std::string_view key,
             std::vector<double>& values,
             double unit,
             double min,
             double max,
             std::size_t count) {
    check_.reals(full(key), values, unit, min, max, count);
  }

 private:
  std::string section_;
  hw::OptionCheck check_;
};

template <class Options>
void check_ranges(const std::string& section, Options options) {
  SectionCheck check(section);
  describe(options, check);
}

void check_odd(const std::string& key, int value) {
  if (value % 2 == 0) throw hw::InvalidOption(key, std::to_string(value), "must be odd");
}

void check_transfer_function(const RayCastingOptions& o) {
  const std::vector<double>& values = o.transfer_values;
  const std::string numbers = std::to_string(values.size()) + " numbers";
  if (values.size() < 2) {
    throw hw::InvalidOption("ray_casting.transfer_values", numbers, "takes at least 2");
  }
  if (std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end()) {
    throw hw::InvalidOption("ray_casting.transfer_values", numbers, "must ascend");
  }
  const auto check_length = [&](const char* key, const std::vector<double>& list) {
    if (list.size() == values.size()) return;
    throw hw::InvalidOption(std::string("ray_casting.") + key,
                            std::to_string(list.size()) + " numbers",
                            "takes as many as transfer_values, " + numbers);
  };
  check_length("transfer_opacity_per_mm", o.transfer_opacity_per_mm);
  check_length("transfer_grey", o.transfer_grey);
}

}  // namespace

void validate(const RenderOptions& options) {
  check_ranges("pipeline", options.pipeline);
  check_ranges("scan_conversion", options.scan_conversion);
  check_ranges("volume_of_interest", options.volume_of_interest);
  check_ranges("view", options.view);
  check_ranges("ray_casting", options.ray_casting);
  check_ranges("shading", options.shading);
  check_ranges("smoothing", options.smoothing);
  check_odd("scan_conversion.filter_size", options.scan_conversion.filter_size);
  check_odd("ray_casting.kernel_3d", options.ray_casting.kernel_3d);
  check_odd("ray_casting.window_2d", options.ray_casting.window_2d);
  check_odd("shading.depth_filter_size", options.shading.depth_filter_size);
  check_odd("smoothing.filter_size", options.smoothing.filter_size);
  const int buffer_length = options.ray_casting.buffer_length;
  if (buffer_length % 2 != 0) {
    throw hw::InvalidOption(
        "ray_casting.buffer_length", std::to_string(buffer_length), "must be even");
  }
  check_transfer_function(options.ray_casting);
}

}  // namespace wobblebench::render
