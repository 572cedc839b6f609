#include "bench/scene/scene_cost.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/user_error.h"
#include "phantoms/motion.h"
#include "render/geometry/slice_geometry.h"
#include "sim/fidelity.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::bench {

namespace {

constexpr double kSampleBytes = sizeof(float);

// Measured by docs/decisions/0020-files-of-others.md.
constexpr double kProgramBytes = 0.3e9;
constexpr double kFaceArea_m2 = 0.22, kFaceScanned_m2 = 0.013;
constexpr double kBandVoxelBytes = 15;
constexpr double kRegistrationReach_m = 7e-3;
constexpr double kWidenedVoxelBytes = 60;
constexpr double kPixelBytes = 256;

double samples_per_volume(const hw::AcquisitionPlan& plan) {
  return 1.0 * plan.sticks_per_volume() * plan.acquisition().samples_per_stick;
}

/// A volume in transfer is stored where it is made and where it is assembled.
double acquisition_bytes(const Scene& scene, const hw::AcquisitionPlan& plan) {
  const double volume = kSampleBytes * samples_per_volume(plan);
  const sim::Rung rung = sim::choose_fidelity(scene.simulation, plan, scene.moves()).rung;
  const auto echoes = sim::echo_model_type(rung).memory(plan, scene.simulation, scene.moves());
  return std::max(echoes.constructing, echoes.kept + 2 * volume);
}

double texel_bytes(render::TextureFormat format) {
  switch (format) {
    case render::TextureFormat::r8:
      return 1;
    case render::TextureFormat::r16:
      return 2;
    case render::TextureFormat::r32f:
      return 4;
  }
  throw std::logic_error("TextureFormat: no such format");
}

std::string gigabytes(double bytes) {
  std::ostringstream text;
  text.precision(3);
  text << bytes / 1e9 << " GB";
  return text.str();
}

/// Areas of a phantom's surfaces, m^2: of all, and of its targets within its region of interest.
struct Areas {
  double all = 0;
  double scanned = 0;
};

double ball(double radius_m) {
  return 4 * std::numbers::pi * radius_m * radius_m;
}

Areas areas_of(const phantoms::PhantomOptions& options) {
  const double box = (2 * 60e-3) * (2 * 60e-3);  // the widest region of interest
  const double slab = 2 * 0.24 * 0.24 + 4 * 0.24 * 0.04;
  const double radius = options.radius_m;
  const std::string& name = options.name;
  if (name == "fetal_face") return {kFaceArea_m2, kFaceScanned_m2};
  if (name == "plane") return {slab, 70e-3 * 70e-3};
  if (name == "steps") return {slab, box / 2};
  if (name == "sphere") return {ball(radius), std::min(ball(radius), box)};
  if (name == "cyst") return {ball(radius), 0};
  if (name == "bone_plate") return {2 * 0.03 * 0.03 + 4 * 0.03 * options.thickness_m, 0};
  if (name == "speckle_block") return {2 * 0.3 * 0.3 + 4 * 0.3 * 0.24, 0};
  return {};  // points; or a file: its import states its own limit
}

double phantom_bytes(const phantoms::PhantomOptions& options) {
  const double voxels = 8 * areas_of(options).all / (options.voxel_m * options.voxel_m);
  return kBandVoxelBytes * voxels;
}

double registration_bytes(const phantoms::PhantomOptions& options) {
  const double volume_m3 = 2 * kRegistrationReach_m * areas_of(options).scanned;
  return kWidenedVoxelBytes * volume_m3 / std::pow(options.voxel_m, 3);
}

double picture_bytes(const render::RenderOptions& options) {
  const double size = options.ray_casting.image_size;
  return kPixelBytes * size * size;
}

struct Part {
  double bytes;
  std::string keys;
};

std::string key(const std::string& name, double value) {
  std::ostringstream text;
  text << name << " = " << value;
  return text.str();
}

/// The needs with the keys that they grow with, the steepest first.
std::vector<Part> parts(const Scene& scene, const MemoryNeed& need) {
  const auto& a = scene.acquisition;
  const std::string voxel = key("phantom.voxel_mm", scene.phantom.voxel_m / kMillimetre);
  const std::string frames = key("acquisition.frames_per_volume", a.frames_per_volume);
  return {
      {need.phantom, voxel},
      {need.acquisition,
       frames + ", " + key("acquisition.sticks_per_frame", a.sticks_per_frame) + ", " +
           key("acquisition.samples_per_stick", a.samples_per_stick)},
      {need.slices,
       frames + ", " +
           key("render.scan_conversion.slice_size", scene.render.scan_conversion.slice_size)},
      {need.pictures, key("render.ray_casting.image_size", scene.render.ray_casting.image_size)},
      {need.registration, voxel}};
}

[[noreturn]] void refuse(const std::string& keys, double need, double available) {
  throw UserError(keys + ": need about " + gigabytes(need) + " of memory; there are " +
                  gigabytes(available));
}

namespace fs = std::filesystem;

/// Infinite where the file is missing or says "max".
double limit_in(const fs::path& file) {
  std::ifstream in(file);
  double bytes = 0;
  return in >> bytes ? bytes : std::numeric_limits<double>::infinity();
}

/// The least limit of the groups from `group` up to the hierarchy's root.
double least_limit(const fs::path& hierarchy, std::string group, const std::string& name) {
  double least = limit_in(hierarchy / name);
  while (group.find_first_not_of('/') != std::string::npos) {
    least = std::min(least, limit_in(fs::path(hierarchy.string() + group) / name));
    group.resize(group.rfind('/'));
  }
  return least;
}

/// `controllers`: ":NAME,NAME,".
bool lists_memory(const std::string& controllers) {
  return controllers.starts_with(":memory,") || controllers.find(",memory,") != std::string::npos;
}

/// Lines of /proc/self/cgroup are NUMBER:CONTROLLERS:GROUP, and those of v2 name no controller.
double cgroup_limit_bytes(const fs::path& root) {
  const fs::path mounted = root / "sys/fs/cgroup";
  double least = std::numeric_limits<double>::infinity();
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first, second - first) + ',';
    const std::string group = line.substr(second + 1);
    if (controllers == ":,") {
      least = std::min(least, least_limit(mounted, group, "memory.max"));
    } else if (lists_memory(controllers)) {
      least = std::min(least, least_limit(mounted / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}

}  // namespace

double MemoryNeed::of_run() const {
  return kProgramBytes + phantom +
         std::max({acquisition, slices + pictures, registration + pictures});
}

MemoryNeed memory_need(const Scene& scene) {
  const hw::AcquisitionPlan plan = scene.plan();
  const double volume = kSampleBytes * samples_per_volume(plan);
  const auto& conversion = scene.render.scan_conversion;
  const double slice = 1.0 * conversion.slice_size * conversion.slice_size;
  MemoryNeed need;
  need.phantom = phantom_bytes(scene.phantom);
  need.registration = registration_bytes(scene.phantom);
  need.pictures = picture_bytes(scene.render);
  need.acquisition = acquisition_bytes(scene, plan);
  const hw::AcquisitionPlan dense =
      render::dense_plan(plan, render::dense_factors(plan, scene.render));
  // The frames as they came, and those of which slices are made.
  need.slices = slice * dense.acquisition().frames_per_volume * texel_bytes(conversion.format) +
                volume + kSampleBytes * samples_per_volume(dense);
  return need;
}

void check_memory(const Scene& scene, const std::string& source, double available_bytes) {
  MemoryNeed need = memory_need(scene);
  need.registration = 0;
  for (const Part& part : parts(scene, need)) {
    if (part.bytes > available_bytes)
      refuse(source + ": " + part.keys, part.bytes, available_bytes);
  }
}

void check_memory_of_run(const Scene& scene, double available_bytes) {
  const MemoryNeed need = memory_need(scene);
  if (need.of_run() <= available_bytes) return;
  const auto all = parts(scene, need);
  const auto most = std::max_element(
      all.begin(), all.end(), [](const Part& a, const Part& b) { return a.bytes < b.bytes; });
  refuse(most->keys, need.of_run(), available_bytes);
}

double available_memory_bytes(const fs::path& root) {
  const double machine = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
                         static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  return std::min(machine, cgroup_limit_bytes(root));
}

}  // namespace wobblebench::bench
