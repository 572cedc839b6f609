#include "bench/live/messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/units.h"
#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/encoders.h"
#include "bench/output/image_io.h"
#include "bench/output/picture/error_picture.h"
#include "bench/output/picture/scan_plane.h"
#include "bench/results/counts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kPlaneSide = 320;
constexpr unsigned kNoValue = 65535;
constexpr double kLeastStep_mm = 0.005;

void put_number(std::uint32_t number, int bytes, std::string& to) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>((number >> (8 * i)) & 255U);
}

/// sRGB's transfer function as a table, whose steps are finer than those of 8 bits.
float display_value(float light) {
  constexpr int kTableSteps = 1 << 14;
  static const std::vector<float> table = [] {
    std::vector<float> values;
    for (int i = 0; i <= kTableSteps; ++i) {
      values.push_back(encoded(static_cast<float>(i) / static_cast<float>(kTableSteps)));
    }
    return values;
  }();
  const float at = std::clamp(light, 0.0F, 1.0F) * static_cast<float>(kTableSteps);
  return table[static_cast<std::size_t>(std::lrint(at))];
}

/// Empty of an empty image.
std::string jpeg(const Image<glm::vec3>& image, Values meaning) {
  if (image.pixels.empty()) return {};
  Raster raster{.width = image.width,
                .height = image.height,
                .channels = {"R", "G", "B"},
                .bytes = true,
                .values = {},
                .attributes = {{"Compression", "jpeg:92"}, {"jpeg:subsampling", "4:4:4"}}};
  raster.values.reserve(3 * image.pixels.size());
  const bool is_light = meaning == Values::light;
  for (const glm::vec3& rgb : image.pixels) {
    for (int i = 0; i < 3; ++i) {
      raster.values.push_back(is_light ? display_value(rgb[i]) : rgb[i]);
    }
  }
  const std::vector<char> bytes = encoders().encode(raster, ".jpg");
  return {bytes.begin(), bytes.end()};
}

Json header_of(const char* type, const LivePicture& shown) {
  const Image<float>& depth_m = shown.picture.depth_m;
  return {{"type", type},
          {"serial", shown.state->serial},
          {"volume", shown.volume},
          {"width", depth_m.width},
          {"height", depth_m.height}};
}

/// Depths as whole steps from `low_mm`, 16 bits each.
struct DepthCode {
  double low_mm = 0, step_mm = kLeastStep_mm;

  explicit DepthCode(const std::vector<const Image<float>*>& maps_m) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const Image<float>* map_m : maps_m) {
      for (const float depth_m : map_m->pixels) {
        if (!std::isfinite(depth_m)) continue;
        least = std::min(least, double{depth_m} / kMillimetre);
        most = std::max(most, double{depth_m} / kMillimetre);
      }
    }
    if (most < least) return;
    low_mm = least;
    step_mm = std::max(kLeastStep_mm, (most - least) / (kNoValue - 1));
  }

  std::string codes(const Image<float>& map_m) const {
    std::string bytes;
    bytes.reserve(2 * map_m.pixels.size());
    for (const float depth_m : map_m.pixels) {
      const double steps = (double{depth_m} / kMillimetre - low_mm) / step_mm;
      const auto code = std::isfinite(depth_m) ? std::lrint(steps) : long{kNoValue};
      put_number(static_cast<std::uint32_t>(code), 2, bytes);
    }
    return bytes;
  }
};

std::string class_bytes(const Image<PixelClass>& classes) {
  std::string bytes;
  for (const PixelClass one : classes.pixels) bytes += static_cast<char>(one);
  return bytes;
}

Json error_json(const DepthError& error) {
  Json classes = Json::array();
  for (const PixelClassName& name : pixel_class_names()) {
    classes.push_back({{"code", static_cast<int>(name.of)},
                       {"name", name.name},
                       {"colour", html_colour(name.rgb)}});
  }
  Json json = {{"limit_mm", kErrorLimit_mm}, {"classes", std::move(classes)}};
  json.update(to_json(described(error)));
  return json;
}

hw::PolarVolume volume_of(const LivePicture& shown) {
  hw::PolarVolume volume(shown.state->scene.plan(), shown.volume);
  int index = 0;
  for (const hw::PolarFrame& frame : *shown.frames) {
    volume.place_frame(index++, frame, hw::SampleScale::log_compressed);
  }
  return volume;
}

/// Parallel to the view of a probe that looks along z, at the middle of the box.
ScanPlane plane_of_equal_depth(const render::VolumeOfInterest& box, int side) {
  const double width_m = std::max(box.size_m.x, box.size_m.y);
  const double pixel_m = width_m / side;
  const double first = -0.5 * (width_m - pixel_m);
  return {.corner_m = box.center_m + glm::dvec3(first, first, 0),
          .right = {1, 0, 0},
          .down = {0, 1, 0},
          .pixel_m = pixel_m,
          .side = side};
}

/// The time of an echo's firing, or where the device has a clock of its own, of its arrival.
double age_ms(const StickTimes& echo, hw::HostTime now) {
  return to_milliseconds(now - echo.fired.value_or(echo.received));
}

}  // namespace

LiveMessage binary_message(Json header, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) header["parts"].push_back(part.size());
  const std::string text = header.dump();
  std::string bytes;
  put_number(static_cast<std::uint32_t>(text.size()), 4, bytes);
  bytes += text;
  for (const std::string& part : parts) bytes += part;
  return {std::make_shared<const std::string>(std::move(bytes)), false};
}

LiveMessage picture_message(const LivePicture& shown) {
  Json header = header_of("picture", shown);
  header["lost_sticks"] = shown.lost_sticks;
  header["render_ms"] = shown.render_ms;
  header["coarse"] = shown.is_coarse;
  const render::Camera camera = shown.state->scene.view().camera;
  header["mm_per_pixel"] =
      camera.pixel_m() / kMillimetre * camera.image_size / shown.picture.depth_m.width;
  return binary_message(std::move(header), {jpeg(shown.picture.surface, Values::light)});
}

Truth LiveTruth::of(const LivePicture& shown) {
  const ResolvedScene& scene = shown.state->scene;
  if (scene.moves()) return true_surface(scene, maps_, shown.volume);
  if (!still_) still_.emplace(scene, maps_, shown.volume);
  return true_surface(scene, scene.view(), *still_, shown.volume);
}

LiveMessage maps_message(const LivePicture& shown, LiveTruth& true_surfaces) {
  const Image<float>& found_m = shown.picture.depth_m;
  const ResolvedScene& scene = shown.state->scene;
  Json header = header_of("maps", shown);
  const auto add = [&](const DepthCode& code) {
    header["low_mm"] = code.low_mm;
    header["step_mm"] = code.step_mm;
  };
  if (!scene.subject()) {
    const DepthCode code({&found_m});
    add(code);
    return binary_message(std::move(header), {code.codes(found_m)});
  }
  const Truth truth = true_surfaces.of(shown);
  // Of an earlier volume the picture that ShadingBase::rendered shades is not kept.
  const bool can_shade = !shown.picture.volume.pixels.empty() ||
                         scene.render().shading.base == render::ShadingBase::constant;
  header.update(error_json(measure_depth_error(found_m, truth, scene.view().camera)));
  const DepthCode code({&found_m, &truth.depth_m});
  add(code);
  return binary_message(
      std::move(header),
      {code.codes(found_m),
       code.codes(truth.depth_m),
       class_bytes(pixel_classes(shown.picture, truth)),
       can_shade ? jpeg(shade_truth(truth, scene.render(), shown.picture.volume), Values::light)
                 : std::string()});
}

LiveMessage planes_message(const LivePicture& shown) {
  const ResolvedScene& scene = shown.state->scene;
  const hw::PolarVolume volume = volume_of(shown);
  const int frame = scene.plan().acquisition().frames_per_volume / 2;
  const std::array<ScanPlane, 3> planes = {
      frame_plane(scene.plan(), frame, kPlaneSide),
      plane_across_frames(scene.plan(), kPlaneSide),
      plane_of_equal_depth(scene.render().volume_of_interest, kPlaneSide)};
  Json header = header_of("planes", shown);
  std::vector<std::string> parts;
  for (const ScanPlane& plane : planes) {
    const auto grey = coloured(scan_converted(volume, plane), 0, 1, black_to_white, glm::vec3(0));
    parts.push_back(jpeg(grey, Values::display));
    Json lines = Json::array();
    for (const Segment& line :
         surface_in_plane(shown.picture.depth_m, scene.view().camera, plane)) {
      lines.push_back({line[0].x, line[0].y, line[1].x, line[1].y});
    }
    header["planes"].push_back({{"lines", std::move(lines)},
                                {"side", plane.side},
                                {"mm_per_pixel", plane.pixel_m / kMillimetre}});
  }
  return binary_message(std::move(header), parts);
}

LiveMessage compared_message(const LivePicture& shown, const render::Picture& start) {
  return binary_message(
      header_of("compared", shown),
      {jpeg(shown.picture.surface, Values::light), jpeg(start.surface, Values::light)});
}

LiveMessage past_message(std::uint64_t number, const std::string& of, const LiveMessage& message) {
  Json header = {{"type", "past"}, {"number", number}, {"of", of}};
  if (!message.bytes) return binary_message(std::move(header), {});
  return binary_message(std::move(header), {*message.bytes});
}

LiveMessage firing_message(const StreamFrame& frame) {
  Json lost = Json::array();
  for (std::size_t line = 0; line < frame.samples.arrived.size(); ++line) {
    if (frame.samples.arrived[line] == 0) lost.push_back(line);
  }
  const Json json = {{"type", "firing"},
                     {"volume", frame.volume},
                     {"frame", frame.frame},
                     {"lost", std::move(lost)}};
  return {std::make_shared<const std::string>(json.dump()), true};
}

LiveMessage times_message(const ShownPicture& shown,
                          std::uint64_t pictures,
                          const hw::BoardAccount& account,
                          const hw::WireDamage& damage,
                          double sound_ms) {
  const PictureTimes& times = shown.times;
  Json passes = {{"scan_conversion", times.update_ms}};
  for (const render::PassTime& pass : times.passes) {
    if (pass.name != "scan_conversion") passes[pass.name] = pass.ms;
  }
  const Json json = {{"type", "times"},
                     {"volume", times.volume},
                     {"pictures", pictures},
                     {"ready_ms", to_milliseconds(times.ready.time_since_epoch())},
                     {"sound_ms", sound_ms},
                     {"waited_ms", times.waited_ms},
                     {"age_newest_ms", age_ms(times.last, times.ready)},
                     {"age_oldest_ms", age_ms(times.first, times.ready)},
                     {"passes", std::move(passes)},
                     {"waiting_volumes", shown.waiting_volumes},
                     {"superseded_volumes", shown.superseded},
                     {"board", to_json(described(account))},
                     {"damaged_bytes", damage.bytes_skipped}};
  return {std::make_shared<const std::string>(json.dump()), true};
}

}  // namespace wobblebench::bench
