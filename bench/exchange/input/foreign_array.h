// Voxels by the names of their axes, whatever their order in the file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/exchange/files/voxel_file.h"
#include "bench/exchange/input/geometry.h"

namespace wobblebench::bench {

/// Three axes, fastest first in memory, and volumes in the order of the file.
class ForeignArray {
 public:
  /// `names`: of the three axes, as the geometry's `axes` and `reversed` name them. Throws
  /// UserError for names that do not fit the file.
  ForeignArray(VoxelFile file, const Geometry& geometry, std::array<std::string, 3> names);

  const VoxelFile& file() const { return file_; }
  /// Of an axis, 0 to 2.
  std::uint64_t size(std::size_t axis) const { return sizes_.at(axis); }
  std::uint64_t volumes() const { return volumes_; }
  /// Index of an axis in the file, for what the file says of it.
  std::size_t axis_in_file(std::size_t axis) const { return place_.at(axis); }

  /// Index of a voxel within its volume, where it lies in the file.
  std::uint64_t index(std::uint64_t first, std::uint64_t second, std::uint64_t third) const;

  /// Index along the third axis and all volumes, where it lies in the file.
  std::uint64_t third_in_file(std::uint64_t third, std::uint64_t volume) const;

  /// Values of a volume, [(third * size(1) + second) * size(0) + first]; of `thirds` alone, unless
  /// that is empty.
  std::vector<float> values(std::uint64_t volume, const std::vector<bool>& thirds = {}) const;

 private:
  void place_axes(const Geometry& geometry);
  void split_volumes(const Geometry& geometry);
  [[noreturn]] void refuse(const std::string& why) const;

  VoxelFile file_;
  std::array<std::string, 3> names_;
  std::array<std::size_t, 3> place_{};
  std::array<std::uint64_t, 3> sizes_{1, 1, 1};
  std::array<bool, 3> reversed_{};
  std::array<std::uint64_t, 3> stride_{};
  std::uint64_t volumes_ = 1;
};

}  // namespace wobblebench::bench
