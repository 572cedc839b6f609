#include "bench/studies/rungs/rung_comparison.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <utility>

#include "base/duration.h"
#include "base/file.h"
#include "base/user_error.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/scene/resolved_scene.h"
#include "phantoms/grids.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/shapes/shapes.h"
#include "sim/fidelity.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

phantoms::Phantom block(const glm::dvec3& half_m, double voxel_m) {
  const double reach_m = std::max({half_m.x, half_m.y, half_m.z});
  const double room = reach_m + 2 * phantoms::kHalfWidthVoxels * voxel_m;
  auto grids = std::make_shared<phantoms::Grids>();
  grids->signed_distance = {phantoms::build_level_set(
      "block",
      [=](const glm::dvec3& p) { return phantoms::box_distance(p, half_m); },
      {glm::dvec3(-room), glm::dvec3(room)},
      voxel_m,
      phantoms::Distances::exact)};
  return {"block",
          phantoms::material_table(),
          phantoms::material_index("amniotic_fluid"),
          {{"block", phantoms::material_index("soft_tissue"), true}},
          {glm::dvec3(-reach_m), glm::dvec3(reach_m)},
          glm::dvec3(0),
          grids};
}

namespace {

constexpr int kChildFailed = 1;
constexpr int kChildRefused = 2;  ///< what the user gave

/// What was measured says why it failed through a pipe, and the caller says it to the user.
struct Pipe {
  FileDescriptor read;
  FileDescriptor write;
};

Pipe open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  }
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

[[noreturn]] void run_and_exit(pid_t parent, const std::function<void()>& body, int message_to) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kChildFailed);  // that has ended meanwhile, unseen
  // A signal ends the fork without clean-up, which is the parent's task.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  const auto fail = [&](const std::exception& error, int code) {
    // The exit code says that it failed, even where the reason is lost.
    static_cast<void>(!::write(message_to, error.what(), std::strlen(error.what())));
    ::_exit(code);
  };
  try {
    with_late_refusals(body);
  } catch (const UserError& error) {
    fail(error, kChildRefused);
  } catch (const std::exception& error) {
    fail(error, kChildFailed);
  }
  ::_exit(0);
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> piece;
  for (;;) {
    const ssize_t count = ::read(descriptor, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

double peak_memory_bytes(const std::function<void()>& body) {
  Pipe message = open_pipe();
  const pid_t self = ::getpid(), child = ::fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) run_and_exit(self, body, message.write.get());
  message.write.close();
  const std::string reason = read_all(message.read.get());
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) throw std::runtime_error(std::string("wait4: ") + std::strerror(errno));
  }
  if (WIFSIGNALED(status)) {
    throw std::runtime_error("memory: the process that was measured was ended by signal " +
                             std::to_string(WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) == kChildRefused) throw UserError(reason);
  if (WEXITSTATUS(status) != 0) throw std::runtime_error("memory: " + reason);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);  // Linux counts kilobytes
}

const std::vector<sim::Rung>& volume_rungs() {
  static const std::vector<sim::Rung> rungs = {
      sim::Rung::geometry, sim::Rung::field, sim::Rung::scatterers};
  return rungs;
}

RungScene small_sheet(const sim::SimulationOptions& options) {
  constexpr double kRange_m = 75e-3, kHalf_m = 1e-3;
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = 0.078,
                                  .sector_rad = 4 * kDegree,
                                  .sticks_per_frame = 4,
                                  .samples_per_stick = 256,
                                  .frames_per_volume = 1});
  return {phantoms::still_at(block({4e-3, 4e-3, kHalf_m}, 0.5e-3),
                             {0, 0, plan.probe().radius_m + kRange_m}),
          plan,
          options};
}

Image<float> frame_picture(const hw::AcquisitionPlan& plan,
                           const std::vector<float>& volume,
                           int frame,
                           int width) {
  const auto& a = plan.acquisition();
  const double radius_m = plan.probe().radius_m, reach_m = radius_m + a.depth_m;
  const double half_m = reach_m * std::sin(0.5 * a.sector_rad);
  const double top_m = radius_m * std::cos(0.5 * a.sector_rad);
  const int height = static_cast<int>(width * (reach_m - top_m) / (2 * half_m));
  Image<float> picture(width, height, 1.0f);
  const float* frame_begin = volume.data() + static_cast<std::size_t>(frame) *
                                                 static_cast<std::size_t>(a.sticks_per_frame) *
                                                 static_cast<std::size_t>(a.samples_per_stick);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double x = half_m * ((column + 0.5) / width * 2 - 1);
      const double z = top_m + (reach_m - top_m) * (row + 0.5) / height;
      const double k = (std::hypot(x, z) - radius_m) / plan.sample_spacing_m() - 0.5;
      const double l = (std::atan2(x, z) - plan.theta_rad(0)) / plan.theta_step_rad();
      if (k < 0 || l < 0 || k > a.samples_per_stick - 1 || l > a.sticks_per_frame - 1) continue;
      const int k0 = std::min(static_cast<int>(k), a.samples_per_stick - 2);
      const int l0 = std::min(static_cast<int>(l), a.sticks_per_frame - 2);
      const float u = static_cast<float>(k - k0), v = static_cast<float>(l - l0);
      const float* stick = frame_begin + static_cast<std::ptrdiff_t>(l0) * a.samples_per_stick + k0;
      const float* next = stick + a.samples_per_stick;
      picture.at(column, row) = (1 - v) * (stick[0] + u * (stick[1] - stick[0])) +
                                v * (next[0] + u * (next[1] - next[0]));
    }
  }
  return picture;
}

namespace {

constexpr int kSeeds = 3;
constexpr int kPanelWidth = 600;

/// At rest: the measurements set the motion.
RungScene scene_of(Scene given, const phantoms::Phantom& phantom) {
  given.motion = {};
  const ResolvedScene scene = resolve_scene(std::move(given), phantom);
  return {{phantom, scene.subject()->placement}, scene.plan(), scene.simulation()};
}

/// In processes of their own, before this one works on other threads.
std::vector<MemoryPeak> measure_memory(const Scene& scene, const PartDone& done) {
  std::vector<MemoryPeak> peaks;
  PartCount parts(1 + 2 * volume_rungs().size(), done);
  const auto add = [&](const std::string& what, const auto& body) {
    peaks.push_back({what, peak_memory_bytes(body)});
    parts.finish_one();
  };
  add("phantom alone", [&] { phantoms::make_phantom(scene.phantom); });
  for (const sim::Rung rung : volume_rungs()) {
    for (const bool moving : {false, true}) {
      add(sim::to_string(rung) + (moving ? ", moving" : ", still"), [&] {
        auto subject = scene_of(scene, phantoms::make_phantom(scene.phantom));
        subject.options.fidelity = rung;
        subject.subject.motion = moving ? slow_path() : phantoms::Motion();
        const sim::ProbeSimulator simulator(subject.subject, subject.plan, subject.options);
        simulator.volume(0);
      });
    }
  }
  return peaks;
}

std::vector<RungFrame> middle_frames(const RungScene& scene) {
  std::vector<RungFrame> panels;
  for (const sim::Rung rung : volume_rungs()) {
    auto options = scene.options;
    options.fidelity = rung;
    const auto volume = sim::ProbeSimulator(scene.subject, scene.plan, options).volume(0);
    panels.push_back(
        {sim::to_string(rung),
         frame_picture(
             scene.plan, volume, scene.plan.acquisition().frames_per_volume / 2, kPanelWidth)});
  }
  return panels;
}

/// The scene with another phantom in place of its own.
RungScene body_in(Scene scene, const std::string& name) {
  scene.phantom = {.name = name};
  if (name == "plane") scene.phantom.tilt_y_rad = 10 * kDegree;
  scene.given.clear();
  return scene_of(scene, phantoms::make_phantom(scene.phantom));
}

/// The scene's own phantom, and two whose truth has a closed form.
std::vector<RungError> measure_errors(const Scene& scene,
                                      const RungScene& subject,
                                      const std::vector<std::uint64_t>& seeds,
                                      const PartDone& done) {
  PartCount parts(4, done);
  std::vector<RungError> errors =
      measure_rung_errors(scene.phantom.name, subject, volume_rungs(), seeds);
  parts.finish_one();
  for (const std::string name : {"sphere", "plane"}) {
    if (name != scene.phantom.name) {
      const auto more = measure_rung_errors(name, body_in(scene, name), volume_rungs(), seeds);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    parts.finish_one();
  }
  const auto small = measure_rung_errors(
      "sheet", small_sheet(scene.simulation), {sim::Rung::scatterers, sim::Rung::reference}, seeds);
  errors.insert(errors.end(), small.begin(), small.end());
  return errors;
}

}  // namespace

std::vector<PlannedStep> rungs_steps(int repeats) {
  return {{"memory", 50},
          {"phantom", 4},
          {"times", 6.0 + 6.0 * repeats},
          {"growth", 60},
          {"errors", 15},
          {"reference", 20},
          {"frames", 6}};
}

RungsResults measure_rungs(const Scene& scene, int repeats, Progress& progress) {
  RungsResults results;
  results.phantom = scene.phantom.name;
  results.repeats = repeats;
  results.seeds = seeds_from(scene.simulation.seed, kSeeds);
  results.memory =
      progress.step("memory", [&](const PartDone& done) { return measure_memory(scene, done); });
  const auto subject = progress.step(
      "phantom", [&] { return scene_of(scene, phantoms::make_phantom(scene.phantom)); });
  results.sound_ms = to_milliseconds(subject.plan.volume_duration());
  results.times = progress.step("times", [&](const PartDone& done) {
    return measure_times(subject, volume_rungs(), repeats, done);
  });
  results.growth = progress.step("growth", [&](const PartDone& done) {
    return measure_growth(volume_rungs(), scene.simulation, {}, done);
  });
  results.errors = progress.step("errors", [&](const PartDone& done) {
    return measure_errors(scene, subject, results.seeds, done);
  });
  progress.step("reference", [&] {
    const auto small = small_sheet(scene.simulation);
    results.small_scatterers = measure_volume(small, sim::Rung::scatterers, kSmallRepeats);
    results.small_reference = measure_volume(small, sim::Rung::reference, kSmallRepeats);
  });
  results.frames = progress.step("frames", [&] { return middle_frames(subject); });
  return results;
}

}  // namespace wobblebench::bench
