// Any bytes as the message of wobblebench-import: a grid or a mesh, or a refusal. The parsers
// behind it are not ours, and break: that is why they have a process of their own.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "phantoms/float_grid.h"
#include "phantoms/io/triangle_mesh.h"
#include "phantoms/io/vdb_file.h"

namespace phantoms = wobblebench::phantoms;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view message(reinterpret_cast<const char*>(data), size);
  try {
    for (const auto& grid : phantoms::vdb_from_message(message).grids) {
      if (grid.distances) phantoms::check_level_set(grid.name, *grid.distances);
    }
  } catch (const std::invalid_argument&) {
  }
  try {
    if (phantoms::mesh_from_message(message).triangles.empty()) std::abort();
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
