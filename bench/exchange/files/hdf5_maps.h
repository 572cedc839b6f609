// HDF5 files of maps as zea has them (github.com/tue-bmd/zea, zea/data/spec.py), by libhdf5 in a
// library of its own, which is loaded when the first one is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace wobblebench::bench {

enum class MapType { f32, u8, boolean };

/// A group of `values`, `coordinates` and what is said of them.
struct Hdf5Map {
  std::string name;
  MapType type = MapType::f32;
  std::vector<std::uint64_t> shape;  ///< volumes, z, x, y, and channels where it has any
  std::vector<std::uint64_t> coordinates_shape;  ///< the last is 3; empty: none
  std::vector<std::string> labels;               ///< of the channels
  std::string unit;
  std::string description;
};

/// Functions throw std::runtime_error "PATH: …".
class Hdf5Maps {
 public:
  virtual ~Hdf5Maps() = default;
  virtual void add_map(const Hdf5Map& map) = 0;
  /// All values of a volume, in the map's type; all coordinates, float32 m, of one volume or of
  /// all.
  virtual void write_values(const std::string& map, std::uint64_t volume, const void* values) = 0;
  virtual void write_coordinates(const std::string& map,
                                 std::uint64_t volume,
                                 std::span<const float> coordinates_m) = 0;
  /// Writes what is buffered, and closes the file.
  virtual void finish() = 0;
};

/// A new file with these attributes of its root. Throws std::runtime_error, also where this build
/// has no HDF5.
std::unique_ptr<Hdf5Maps> make_hdf5_maps(
    const std::filesystem::path& path,
    const std::vector<std::pair<std::string, std::string>>& attributes);

}  // namespace wobblebench::bench
