#include "bench/exchange/input/foreign_array.h"

#include <algorithm>
#include <utility>

#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kVolume = "volume";

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

}  // namespace

ForeignArray::ForeignArray(VoxelFile file,
                           const Geometry& geometry,
                           std::array<std::string, 3> names)
    : file_(std::move(file)), names_(std::move(names)) {
  place_axes(geometry);
  split_volumes(geometry);
  for (std::size_t i = 0; i < 3; ++i) {
    stride_.at(i) = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      if (place_.at(k) < place_.at(i)) stride_.at(i) *= sizes_.at(k);
    }
  }
}

void ForeignArray::refuse(const std::string& why) const {
  throw UserError(file_.path.string() + ": " + why);
}

void ForeignArray::place_axes(const Geometry& geometry) {
  std::vector<std::string> known(names_.begin(), names_.end());
  known.emplace_back(kVolume);
  std::vector<std::string> axes = geometry.axes;
  const std::size_t count = file_.sizes.size();
  if (axes.empty()) axes.assign(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(count));
  const bool is_complete = axes.size() == count;
  bool is_good = is_complete && std::ranges::count(axes, known[0]) == 1 &&
                 std::ranges::count(axes, known[1]) == 1;
  for (const std::string& axis : axes) {
    is_good =
        is_good && std::ranges::count(known, axis) == 1 && std::ranges::count(axes, axis) == 1;
  }
  if (!is_good) {
    refuse("geometry.axes = [" + listed(axes) + "]: must name its " + std::to_string(count) +
           " axes, fastest first, by " + listed(known));
  }
  if (std::ranges::count(axes, kVolume) == 1 && axes.back() != kVolume) {
    refuse("geometry.axes = [" + listed(axes) + "]: volume must be the last");
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::ranges::find(axes, names_.at(i));
    place_.at(i) = static_cast<std::size_t>(found - axes.begin());
    if (found != axes.end()) sizes_.at(i) = file_.sizes.at(place_.at(i));
  }
  if (axes.back() == kVolume) volumes_ = file_.sizes.back();
  for (const std::string& axis : geometry.reversed) {
    const auto found = std::ranges::find(names_, axis);
    if (found == names_.end()) {
      refuse("geometry.reversed = " + axis + ": must be of " +
             listed({names_.begin(), names_.end()}));
    }
    reversed_.at(static_cast<std::size_t>(found - names_.begin())) = true;
  }
}

/// A frame axis that holds the frames of several volumes, one volume after the other.
void ForeignArray::split_volumes(const Geometry& geometry) {
  const auto frames = static_cast<std::uint64_t>(geometry.frames_per_volume);
  if (frames == 0) return;
  const bool is_last = place_.at(2) + 1 == file_.sizes.size();
  if (names_.at(2) != "frame" || !is_last || sizes_.at(2) % frames != 0) {
    refuse("geometry.frames_per_volume = " + std::to_string(frames) + ": must divide " +
           std::to_string(sizes_.at(2)) + " frames along the last axis");
  }
  volumes_ = sizes_.at(2) / frames;
  sizes_.at(2) = frames;
}

/// Reads plane by plane where they lie so: memory follows what is asked for.
std::vector<float> ForeignArray::values(std::uint64_t volume,
                                        const std::vector<bool>& thirds) const {
  const std::uint64_t plane = sizes_[0] * sizes_[1], count = plane * sizes_[2];
  const bool in_planes = stride_[2] == plane;
  std::vector<float> in_file, values;
  if (!in_planes) in_file = read_voxels(file_, volume * count, count);
  for (std::uint64_t k = 0; k < sizes_[2]; ++k) {
    if (!thirds.empty() && !thirds[k]) continue;
    if (in_planes) in_file = read_voxels(file_, third_in_file(k, volume) * plane, plane);
    const std::uint64_t before = in_planes ? index(0, 0, k) / plane * plane : 0;
    for (std::uint64_t j = 0; j < sizes_[1]; ++j) {
      for (std::uint64_t i = 0; i < sizes_[0]; ++i)
        values.push_back(in_file[index(i, j, k) - before]);
    }
  }
  return values;
}

std::uint64_t ForeignArray::third_in_file(std::uint64_t third, std::uint64_t volume) const {
  return volume * sizes_[2] + (reversed_[2] ? sizes_[2] - 1 - third : third);
}

std::uint64_t ForeignArray::index(std::uint64_t first,
                                  std::uint64_t second,
                                  std::uint64_t third) const {
  const auto along = [&](std::size_t axis, std::uint64_t number) {
    return stride_[axis] * (reversed_[axis] ? sizes_[axis] - 1 - number : number);
  };
  return along(0, first) + along(1, second) + along(2, third);
}

}  // namespace wobblebench::bench
