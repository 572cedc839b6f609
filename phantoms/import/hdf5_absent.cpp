// Where libhdf5 was not found by CMake.
#include <stdexcept>

#include "phantoms/import/parsers.h"

namespace wobblebench::phantoms {

void write_hdf5_message(const std::filesystem::path&, MessageWriter&) {
  throw std::invalid_argument(
      "this build does not read HDF5, which needs libhdf5-dev; a .csv of the same columns will do");
}

}  // namespace wobblebench::phantoms
