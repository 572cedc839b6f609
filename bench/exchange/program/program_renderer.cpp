#include "bench/exchange/program/program_renderer.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/duration.h"
#include "base/file.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/exchange/files/npy.h"
#include "bench/exchange/surface/found_surface.h"
#include "bench/output/camera_matrices.h"
#include "bench/output/picture/scan_plane.h"
#include "bench/scene/scene.h"
#include "render/camera.h"
#include "render/reference/reference.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Shape = std::vector<std::uint64_t>;

Json mm(const glm::dvec3& metres) {
  return {metres.x / kMillimetre, metres.y / kMillimetre, metres.z / kMillimetre};
}

/// A file that nobody needs after a crash: without fsync(2).
void write_unsynced(const fs::path& path, std::string_view bytes) {
  const FileDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (file.is_open() && write_all(file.get(), bytes)) return;
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
}

void write_npy(const fs::path& path, const Shape& shape, const std::vector<float>& values) {
  write_unsynced(path, npy_bytes(shape, values));
}

/// The samples as they were acquired, and where they lie.
Json polar_json(const hw::PolarVolume& volume, const fs::path& file) {
  const hw::AcquisitionPlan& plan = volume.plan();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  std::vector<float> samples;
  Json motor = Json::array(), lost = Json::array(), lines = Json::array();
  for (int f = 0; f < scan.frames_per_volume; ++f) {
    const hw::PolarFrame& frame = volume.frame(f);
    samples.insert(samples.end(), frame.samples.begin(), frame.samples.end());
    Json angles = Json::array();
    for (int line = 0; line < scan.sticks_per_frame; ++line) {
      angles.push_back(frame.motor_angle_rad[static_cast<std::size_t>(line)] / kDegree);
      if (frame.arrived[static_cast<std::size_t>(line)] == 0) lost.push_back({f, line});
    }
    motor.push_back(std::move(angles));
  }
  for (int line = 0; line < scan.sticks_per_frame; ++line) {
    lines.push_back(plan.theta_rad(line) / kDegree);
  }
  const auto count = [](int value) { return static_cast<std::uint64_t>(value); };
  write_npy(
      file,
      {count(scan.frames_per_volume), count(scan.sticks_per_frame), count(scan.samples_per_stick)},
      samples);
  const double step_mm = scan.depth_m / scan.samples_per_stick / kMillimetre;
  return {{"file", file.string()},
          {"axes", "frame, line, sample; float32 in [0, 1], log-compressed"},
          {"line_angles_deg", lines},
          {"motor_angles_deg", motor},
          {"first_range_mm", 0.5 * step_mm},
          {"range_step_mm", step_mm},
          {"radius_mm", plan.geometry().radius_m() / kMillimetre},
          {"wobble_radius_mm", plan.geometry().wobble_radius_m() / kMillimetre},
          {"lost_sticks", lost}};
}

/// The samples on a grid of the probe frame that fills the box of interest.
Json cartesian_json(const hw::PolarVolume& volume,
                    const render::VolumeOfInterest& box,
                    double voxel_m,
                    const fs::path& file) {
  const auto voxels = [&](double size_m) {
    return static_cast<int>(std::floor(size_m / voxel_m + 1e-9)) + 1;
  };
  const int nx = voxels(box.size_m.x), ny = voxels(box.size_m.y), nz = voxels(box.size_m.z);
  const glm::dvec3 first_m = box.center_m - 0.5 * voxel_m * glm::dvec3(nx - 1, ny - 1, nz - 1);
  std::vector<float> samples;
  for (int z = 0; z < nz; ++z) {
    const ScanPlane plane{.corner_m = first_m + glm::dvec3(0, 0, z * voxel_m),
                          .right = {1, 0, 0},
                          .down = {0, 1, 0},
                          .pixel_m = voxel_m,
                          .side = std::max(nx, ny)};
    const Image<float> slice = scan_converted(volume, plane);
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) samples.push_back(slice.at(x, y));
    }
  }
  const auto count = [](int value) { return static_cast<std::uint64_t>(value); };
  write_npy(file, {count(nz), count(ny), count(nx)}, samples);
  return {{"file", file.string()},
          {"axes", "z, y, x of the probe frame; float32 in [0, 1], NaN outside the scan"},
          {"first_mm", mm(first_m)},
          {"spacing_mm", voxel_m / kMillimetre}};
}

Json request_json(const hw::PolarVolume& volume,
                  const render::RenderOptions& options,
                  const ProgramSetting& setting,
                  const fs::path& folder) {
  const render::VolumeOfInterest& box = options.volume_of_interest;
  return {{"protocol", "wobblebench.render/1"},
          {"depth", (folder / "depth.npy").string()},
          {"camera", camera_json(render::make_camera(options))},
          {"box",
           {{"low_mm", mm(box.center_m - 0.5 * box.size_m)},
            {"high_mm", mm(box.center_m + 0.5 * box.size_m)}}},
          {"polar", polar_json(volume, folder / "polar.npy")},
          {"cartesian", cartesian_json(volume, box, setting.voxel_m, folder / "cartesian.npy")}};
}

std::string shape_text(const Shape& shape) {
  std::string text;
  for (const std::uint64_t size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text.empty() ? "no size" : text;
}

/// The program's answer, from millimetres; NaN, infinity, 0 and less are no surface.
Image<float> read_depths(const fs::path& file, int size) {
  const auto side = static_cast<std::uint64_t>(size);
  const NumpyArray array = read_npy(read_file(file), [&](const Shape& shape) {
    if (shape == Shape{side, side}) return;
    throw std::invalid_argument("holds " + shape_text(shape) + "; must be " +
                                shape_text({side, side}));
  });
  Image<float> depth_m(size, size, kNoSurface);
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    const double value = array.values[i];
    if (std::isfinite(value) && value > 0) {
      depth_m.pixels[i] = static_cast<float>(value * kMillimetre);
    }
  }
  return depth_m;
}

/// Milliseconds since the last call.
class Watch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    return to_milliseconds(now - std::exchange(last_, now));
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

ProgramSetting program_setting(const PictureOptions& options) {
  return {options.program, options.program_voxel_m, options.program_timeout_s};
}

void check_program(const PictureOptions& options) {
  if (!options.program.empty()) static_cast<void>(renderer_command(options.program));
}

ProgramRenderer::ProgramRenderer(const ProgramSetting& setting)
    : setting_(setting), process_(setting.name, renderer_command(setting.name)) {}

render::Picture ProgramRenderer::render(const hw::PolarVolume& volume,
                                        const render::RenderOptions& options) {
  const std::string who = "render.program = " + setting_.name + ": ";
  const fs::path depths = process_.folder() / "depth.npy",
                 request = process_.folder() / "request.json";
  Watch watch;
  fs::remove(depths);
  write_unsynced(request,
                 request_json(volume, options, setting_, process_.folder()).dump(1) + "\n");
  double exchange_ms = watch.lap_ms();
  const std::string answer =
      process_.ask(request.string(), std::chrono::duration<double>(setting_.timeout_s));
  const double program_ms = watch.lap_ms();
  constexpr std::string_view kError = "error:";
  if (answer.starts_with(kError)) {
    throw std::runtime_error(who + "said:" + one_line(answer.substr(kError.size())));
  }
  if (answer != "done") {
    throw std::runtime_error(who + "answered \"" + one_line(answer) +
                             "\"; must be done or error: TEXT");
  }
  if (!fs::exists(depths)) {
    throw std::runtime_error(
        who + "answered done and wrote no file of the name \"depth\" in the request");
  }
  Image<float> depth_m;
  try {
    depth_m = read_depths(depths, options.ray_casting.image_size);
    check_depths(depth_m, render::make_view(options), /*unit_m=*/0);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(who + "depth.npy: " + error.what());
  }
  exchange_ms += watch.lap_ms();
  render::Picture picture = render::shade_depth(depth_m, options);
  picture.volume = Image<glm::vec3>(depth_m.width, depth_m.height);
  picture.depth_m = std::move(depth_m);
  picture.passes = {{.name = "exchange", .ms = exchange_ms, .gpu_ms = -1, .fetches = {}},
                    {.name = "program", .ms = program_ms, .gpu_ms = -1, .fetches = {}}};
  return picture;
}

}  // namespace wobblebench::bench
