#include "phantoms/io/imports.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "phantoms/framing.h"
#include "phantoms/io/mesh_file.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

namespace fs = std::filesystem;

void check_readable(const std::string& file, const std::string& kind) {
  if (file.empty()) throw refusal("file", quoted(file), "must be the path of " + kind);
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    const bool missing = !error || error == std::errc::no_such_file_or_directory;
    throw refusal("file", quoted(file), missing ? "no such file" : error.message());
  }
  if (fs::file_size(file, error) == 0) {
    throw refusal("file", quoted(file), "not readable as " + kind + " (it is empty)");
  }
  if (::access(file.c_str(), R_OK) != 0) throw refusal("file", quoted(file), "cannot be read");
}

void check_materials(const PhantomOptions& options) {
  for (const std::string& name : options.materials) check_material("materials", name);
  check_material("background", options.background);
}

std::string millimetres(const glm::dvec3& size_m) {
  std::ostringstream text;
  text << size_m.x * 1e3 << " x " << size_m.y * 1e3 << " x " << size_m.z * 1e3 << " mm";
  return text.str();
}

}  // namespace

void check_material(const std::string& key, const std::string& name) {
  std::string known;
  for (const Material& entry : material_table()) {
    if (entry.name == name) return;
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw refusal(key, quoted(name), "must be one of " + known);
}

void check_mesh(const PhantomOptions& options) {
  check_readable(options.file, "an .obj, .stl or .ply");
  const std::string extension = lower_case_extension(options.file);
  if (extension != ".obj" && extension != ".stl" && extension != ".ply") {
    throw refusal("file", quoted(options.file), "must be an .obj, .stl or .ply");
  }
  if (options.materials.size() != 1) {
    throw refusal("materials",
                  std::to_string(options.materials.size()) + " names",
                  "takes one name for a mesh");
  }
  check_materials(options);
}

void check_vdb(const PhantomOptions& options) {
  check_readable(options.file, "a .vdb");
  check_materials(options);
}

void check_file(const PhantomOptions& options) {
  check_readable(options.file, "a .vdb");
}

Phantom make_file(const PhantomOptions& options) {
  return read_phantom(options.file);
}

void check_size(const Box& bounds, double voxel_m) {
  const glm::dvec3 size = bounds.high - bounds.low;
  const double least = std::min({size.x, size.y, size.z});
  std::ostringstream reason;
  if (!(std::max({size.x, size.y, size.z}) <= kLargestBody_m)) {
    reason << "measures " << millimetres(size) << ", more than " << kLargestBody_m * 1e3
           << ": is unit_mm right?";
  } else if (!(least >= kSmallestBody * voxel_m)) {
    reason << "measures " << millimetres(size) << ", less than " << kSmallestBody << " voxels of "
           << voxel_m * 1e3 << " mm: is unit_mm right?";
  } else {
    return;
  }
  throw std::invalid_argument(reason.str());
}

Phantom imported_phantom(const PhantomOptions& options,
                         std::vector<Surface> surfaces,
                         const Box& bounds,
                         std::shared_ptr<const Grids> grids) {
  const Framing framing = framing_of_body(bounds);
  return Phantom(options.name,
                 material_table(),
                 material_index(options.background),
                 std::move(surfaces),
                 framing.region_of_interest,
                 framing.position_m,
                 std::move(grids));
}

}  // namespace wobblebench::phantoms
