#include "bench/scene/scene_cost.h"

#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "base/user_error.h"
#include "phantoms/motion.h"
#include "sim/echo/echo_model.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kSampleBytes = sizeof(float);

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

void refuse_beyond(double available,
                   double need,
                   const std::string& source,
                   const std::string& keys) {
  if (need <= available) return;
  throw UserError(source + ": " + keys + ": need about " + gigabytes(need) +
                  " of memory; this machine has " + gigabytes(available));
}

}  // namespace

MemoryNeed memory_need(const Scene& scene) {
  const hw::AcquisitionPlan plan = scene.plan();
  const double volume = kSampleBytes * samples_per_volume(plan);
  const auto& conversion = scene.render.scan_conversion;
  const double slice = 1.0 * conversion.slice_size * conversion.slice_size;
  MemoryNeed need;
  need.acquisition = acquisition_bytes(scene, plan);
  need.slices =
      slice * plan.acquisition().frames_per_volume * texel_bytes(conversion.format) + volume;
  return need;
}

double machine_memory_bytes() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(::sysconf(_SC_PAGE_SIZE));
}

void check_memory(const Scene& scene, const std::string& source, double available_bytes) {
  const MemoryNeed need = memory_need(scene);
  const auto& acquisition = scene.acquisition;
  const std::string frames =
      "acquisition.frames_per_volume = " + std::to_string(acquisition.frames_per_volume);
  const std::string sticks =
      "acquisition.sticks_per_frame = " + std::to_string(acquisition.sticks_per_frame);
  const std::string samples =
      "acquisition.samples_per_stick = " + std::to_string(acquisition.samples_per_stick);
  const std::string slices = "render.scan_conversion.slice_size = " +
                             std::to_string(scene.render.scan_conversion.slice_size);
  refuse_beyond(available_bytes, need.acquisition, source, frames + ", " + sticks + ", " + samples);
  refuse_beyond(available_bytes, need.slices, source, frames + ", " + slices);
}

}  // namespace wobblebench::bench
