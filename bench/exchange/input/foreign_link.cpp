#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "base/user_error.h"
#include "bench/exchange/files/stored_voxels.h"
#include "bench/exchange/input/foreign_scan.h"
#include "hw/wire/packet.h"

namespace wobblebench::bench {

void check_memory(const ForeignScan& scan) {
  const hw::AcquisitionOptions& a = scan.plan.acquisition();
  check_half_of_memory(
      scan.path,
      double{sizeof(float)} * a.volumes * scan.plan.sticks_per_volume() * a.samples_per_stick);
}

namespace {

void write_volume(const ForeignScan& scan, std::uint32_t volume, int file) {
  const auto frames = scan.plan.acquisition().frames_per_volume;
  const auto first =
      scan.valid.begin() + (scan.valid.empty() ? 0 : std::ptrdiff_t{volume} * frames);
  const std::vector<bool> valid(first, scan.valid.empty() ? first : first + frames);
  const std::vector<std::byte> bytes =
      packets_of_volume(scan, volume, scan.samples(volume, valid), valid);
  if (!write_all(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
    throw std::runtime_error(scan.path.string() +
                             ": cannot be kept in memory: " + std::strerror(errno));
  }
}

}  // namespace

std::vector<std::byte> packets_of_volume(const ForeignScan& scan,
                                         std::uint32_t volume,
                                         const std::vector<float>& values,
                                         const std::vector<bool>& frames) {
  const hw::AcquisitionPlan& plan = scan.plan;
  std::vector<std::byte> bytes;
  const std::uint64_t first = plan.first_sequence(volume);
  hw::encode(hw::ConfigurationPacket{.sequence = first,
                                     .volume = volume,
                                     .time = plan.stick_time(first),
                                     .source = hw::StreamOrigin::hardware,
                                     .probe = plan.probe(),
                                     .acquisition = plan.acquisition(),
                                     .display_scale = scan.display_scale,
                                     .knows_times = false},
             bytes);
  const auto samples = static_cast<std::ptrdiff_t>(plan.acquisition().samples_per_stick);
  auto at = values.begin();
  for (std::size_t i = 0; i < static_cast<std::size_t>(plan.sticks_per_volume()); ++i) {
    hw::Stick stick;
    hw::schedule(stick, plan, first + i);
    if (!frames.empty() && !frames[stick.index.frame]) continue;
    stick.motor_angle_rad = scan.motor_rad.at(stick.index.frame);
    stick.samples.assign(at, at + samples);
    at += samples;
    hw::encode(stick, bytes);
  }
  hw::encode(
      hw::VolumeEndPacket{.sequence = first + static_cast<std::uint64_t>(plan.sticks_per_volume()),
                          .volume = volume,
                          .time = plan.volume_end_time(volume)},
      bytes);
  return bytes;
}

FileDescriptor recorded(const ForeignScan& scan) {
  check_memory(scan);
  FileDescriptor file(::memfd_create("wobblebench", MFD_CLOEXEC));
  if (!file.is_open()) {
    throw std::runtime_error(scan.path.string() +
                             ": cannot be kept in memory: " + std::strerror(errno));
  }
  const auto volumes = static_cast<std::uint32_t>(scan.plan.acquisition().volumes);
  for (std::uint32_t volume = 0; volume < volumes; ++volume) write_volume(scan, volume, file.get());
  return file;
}

std::filesystem::path descriptor_path(const FileDescriptor& file) {
  return "/proc/self/fd/" + std::to_string(file.get());
}

std::unique_ptr<hw::Link> open_foreign_link(const ForeignScan& scan,
                                            const hw::FileLinkOptions& options) {
  const int last = scan.plan.acquisition().volumes - 1;
  if (options.start_volume > last) {
    throw InvalidOption(
        "start_volume",
        std::to_string(options.start_volume),
        "no volume of " + scan.path.string() + ", whose last is " + std::to_string(last));
  }
  if (options.acquisition > 1) {
    throw InvalidOption(
        "acquisition", std::to_string(options.acquisition), scan.path.string() + " holds one");
  }
  const FileDescriptor file = recorded(scan);
  return std::make_unique<hw::FileLink>(descriptor_path(file), options);
}

}  // namespace wobblebench::bench
