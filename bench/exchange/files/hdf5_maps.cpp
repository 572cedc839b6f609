#include "bench/exchange/files/hdf5_maps.h"

#include "bench/output/loaded_library.h"

namespace wobblebench::bench {

std::unique_ptr<Hdf5Maps> make_hdf5_maps(
    const std::filesystem::path& path,
    const std::vector<std::pair<std::string, std::string>>& attributes) {
  using Make = Hdf5Maps*(const std::filesystem::path&,
                         const std::vector<std::pair<std::string, std::string>>&);
  static auto* const make = reinterpret_cast<Make*>(
      function_of_library("wobblebench_hdf5", "wobblebench_make_hdf5_maps", "no HDF5 files"));
  return std::unique_ptr<Hdf5Maps>(make(path, attributes));
}

}  // namespace wobblebench::bench
