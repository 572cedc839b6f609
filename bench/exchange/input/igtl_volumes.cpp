#include "bench/exchange/input/igtl_volumes.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/units.h"
#include "base/user_error.h"
#include "bench/exchange/input/geometry.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kVolumeKey = "wobblebench_volume";
constexpr const char* kFrameKey = "wobblebench_frame";
/// Of what one gap in the time stamps can hold.
constexpr double kMostLost = 1e6;
constexpr double kSamePlace_mm = 1e-3;

Element element_of(IgtlScalar scalar) {
  switch (scalar) {
    case IgtlScalar::int8:
      return Element::int8;
    case IgtlScalar::uint8:
      return Element::uint8;
    case IgtlScalar::int16:
      return Element::int16;
    case IgtlScalar::uint16:
      return Element::uint16;
    case IgtlScalar::int32:
      return Element::int32;
    case IgtlScalar::uint32:
      return Element::uint32;
    case IgtlScalar::float32:
      return Element::float32;
    case IgtlScalar::float64:
      return Element::float64;
  }
  throw std::logic_error("a type of numbers without a name");
}

/// From an image's axes to those of files: left, posterior, superior.
glm::dvec3 on_lps(const IgtlImage& image, const glm::dvec3& v) {
  return image.lps ? v : glm::dvec3(-v.x, -v.y, v.z);
}

std::optional<std::uint32_t> number_of(const ReceivedImage& received, const char* key) {
  const auto found = received.metadata.find(key);
  if (found == received.metadata.end()) return {};
  std::uint32_t number = 0;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

VoxelFile described(const std::string& server,
                    const ReceivedImage& first,
                    std::uint32_t frames,
                    const FileDescriptor& voxels) {
  const IgtlImage& image = first.image;
  VoxelFile file{.path = server,
                 .data_path = descriptor_path(voxels),
                 .element = element_of(image.scalar),
                 .big_endian = image.big_endian};
  file.sizes = {image.sizes[0], image.sizes[1], frames > 1 ? frames : image.sizes[2]};
  for (const glm::dvec3& step : image.steps) file.directions_mm.emplace_back(on_lps(image, step));
  file.origin_mm = on_lps(image, image.first_voxel());
  file.fields.insert(first.metadata.begin(), first.metadata.end());
  return file;
}

Geometry geometry_of(const std::string& server,
                     const ReceivedImage& first,
                     const std::filesystem::path& geometry) {
  if (!geometry.empty()) return read_geometry(geometry);
  return geometry_of_fields(server, {first.metadata.begin(), first.metadata.end()});
}

/// Planes come one by one; a grid of one layer is none.
std::uint32_t planes_of(const std::string& server,
                        const ReceivedImage& first,
                        const Geometry& geometry) {
  if (first.image.sizes[2] > 1) return 1;
  if (!geometry.has("frames_per_volume") || geometry.frames_per_volume < 1) {
    throw UserError(server +
                    ": sends single planes: geometry.frames_per_volume: is missing; must say how "
                    "many make a volume");
  }
  return static_cast<std::uint32_t>(geometry.frames_per_volume);
}

}  // namespace

IgtlVolumes::IgtlVolumes(const std::string& server,
                         const ReceivedImage& first,
                         const std::filesystem::path& geometry,
                         const IgtlLinkOptions& options,
                         std::shared_ptr<LeftOut> left_out)
    : server_(server),
      options_(options),
      left_out_(std::move(left_out)),
      kind_(first.image),
      voxels_(::memfd_create("wobblebench", MFD_CLOEXEC)) {
  kind_.voxels = {};
  const Geometry said = geometry_of(server, first, geometry);
  frames_ = planes_of(server, first, said);
  lies_in_space_ = said.layout == Layout::cartesian;
  const bool has_frame = frames_ == 1 || number_of(first, kFrameKey).has_value();
  is_numbered_ = has_frame && number_of(first, kVolumeKey).has_value();
  if (frames_ > 1 && !is_numbered_ && options.planes != PlaneOrder::in_order) {
    throw UserError(server + ": sends planes without their numbers (metadata " + kVolumeKey +
                    " and " + kFrameKey +
                    "); planes=in_order takes the first that comes for the first of the fan");
  }
  const std::uint64_t bytes = std::uint64_t{first.image.voxels.size()} * frames_;
  if (!voxels_.is_open() || ::ftruncate(voxels_.get(), static_cast<off_t>(bytes)) != 0) {
    throw std::runtime_error(
        server + ": a volume cannot be kept in memory: " + std::generic_category().message(errno));
  }
  scan_ = scan_of_voxels(described(server, first, frames_, voxels_), geometry);
  check_memory(*scan_);  // of one volume
  hw::AcquisitionOptions endless = scan_->plan.acquisition();
  endless.volumes = hw::kMostVolumes;
  scan_->plan = hw::AcquisitionPlan(scan_->plan.probe(), endless);
  there_.assign(frames_, false);
  first_volume_ = number_of(first, kVolumeKey).value_or(0);
}

bool IgtlVolumes::lies_as_before(const IgtlImage& image) const {
  const auto differs = [&](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::distance(on_lps(image, a), on_lps(kind_, b)) > kSamePlace_mm;
  };
  if (!lies_in_space_) return true;
  if (differs(image.first_voxel(), kind_.first_voxel())) return false;
  return std::ranges::none_of(std::array{0, 1, 2}, [&](int i) {
    const auto axis = static_cast<std::size_t>(i);
    return differs(double{1} * image.sizes.at(axis) * image.steps.at(axis),
                   double{1} * kind_.sizes.at(axis) * kind_.steps.at(axis));
  });
}

/// By arrival and, with period_ms, by the times between images.
std::optional<IgtlVolumes::Place> IgtlVolumes::next_in_order(std::uint64_t timestamp) {
  if (options_.period_s > 0 && last_timestamp_ > 0 && timestamp > 0) {
    if (timestamp <= last_timestamp_) {
      left_out_->count("images: their times do not grow");
      return {};
    }
    const double gap_s = static_cast<double>(timestamp - last_timestamp_) / 4294967296.0;
    const double lost = std::round(gap_s / options_.period_s) - 1;
    images_ += static_cast<std::uint64_t>(std::clamp(lost, 0.0, kMostLost));
  }
  if (timestamp > 0) last_timestamp_ = timestamp;
  const std::uint64_t number = images_++;
  return Place{static_cast<std::uint32_t>(number / frames_),
               static_cast<std::uint32_t>(number % frames_)};
}

std::optional<IgtlVolumes::Place> IgtlVolumes::place_of(const ReceivedImage& received) {
  if (!is_numbered_) return next_in_order(received.timestamp);
  const auto volume = number_of(received, kVolumeKey);
  const auto frame =
      frames_ == 1 ? std::optional<std::uint32_t>(0) : number_of(received, kFrameKey);
  if (!volume || !frame || *frame >= frames_) {
    left_out_->count("images: without the number of a volume or a frame");
    return {};
  }
  if (*volume < first_volume_ + volume_ || (*volume == first_volume_ + volume_ && there_[*frame])) {
    left_out_->count("images: came again, or after a later volume's");
    return {};
  }
  return Place{static_cast<std::uint32_t>(*volume - first_volume_), *frame};
}

void IgtlVolumes::store(const ReceivedImage& received, std::uint32_t frame) {
  const std::string_view voxels = received.image.voxels;
  std::size_t done = 0;
  while (done < voxels.size()) {
    const auto at = static_cast<off_t>(voxels.size() * frame + done);
    const ssize_t count = ::pwrite(voxels_.get(), voxels.data() + done, voxels.size() - done, at);
    if (count <= 0) {
      throw ReceivingEnded(false, "a volume cannot be kept in memory");
    }
    done += static_cast<std::size_t>(count);
  }
  there_[frame] = true;
}

std::vector<std::byte> IgtlVolumes::add(const ReceivedImage& received) {
  const IgtlImage& image = received.image;
  const bool is_same = image.sizes == kind_.sizes && image.scalar == kind_.scalar &&
                       image.big_endian == kind_.big_endian;
  if (!is_same) throw ReceivingEnded(false, "the images change their size or type; must keep them");
  const auto place = place_of(received);
  if (!place) return {};
  if (!lies_as_before(image)) {
    left_out_->count("images: lie elsewhere than the first");
    return {};
  }
  std::vector<std::byte> packets;
  if (place->volume != volume_) {
    packets = end_volume();
    volume_ = place->volume;
  }
  store(received, place->frame);
  const bool is_last = !is_numbered_ && place->frame + 1 == frames_;
  if (!is_last && std::ranges::find(there_, false) != there_.end()) return packets;
  const std::vector<std::byte> ended = end_volume();
  packets.insert(packets.end(), ended.begin(), ended.end());
  return packets;
}

/// A volume without a frame has no packets: its sticks are missing between those of its neighbours.
std::vector<std::byte> IgtlVolumes::end_volume() {
  const std::vector<bool> frames = std::exchange(there_, std::vector<bool>(frames_, false));
  const bool is_empty = std::ranges::find(frames, true) == frames.end();
  const std::uint32_t volume = volume_++;
  if (is_empty) return {};
  try {
    const std::vector<bool> some = frames_ == 1 ? std::vector<bool>{} : frames;
    return packets_of_volume(*scan_, volume, scan_->samples(0, some), some);
  } catch (const UserError&) {
    left_out_->count("volumes: with voxels that are no finite numbers");
    return {};
  }
}

}  // namespace wobblebench::bench
