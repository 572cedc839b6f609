// The phantoms by name, and the checks of their options.
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "base/near_name.h"
#include "phantoms/builders.h"
#include "phantoms/io/scatterer_file.h"
#include "phantoms/io/triangle_mesh.h"
#include "phantoms/phantom.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

namespace fs = std::filesystem;

struct Source {
  std::string name;
  Phantom (*build)(const PhantomOptions&);
  void (*check)(const PhantomOptions&);  // beyond the ranges of single options
};

// Coarser voxels do not resolve the phantom.
void check_voxel(const PhantomOptions& options, double coarsest_m) {
  if (options.voxel_m <= coarsest_m * (1 + 1e-12)) return;
  std::ostringstream allowed;
  allowed << "must be at most " << coarsest_m * 1e3 << " for the phantom " << options.name;
  throw refusal("voxel_mm", options.voxel_m * 1e3, allowed.str());
}

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

void check_material(const std::string& key, const std::string& name) {
  std::string known;
  std::vector<std::string> names;
  for (const Material& entry : material_table()) {
    if (entry.name == name) return;
    known += (known.empty() ? "" : ", ") + entry.name;
    names.push_back(entry.name);
  }
  throw refusal(key, quoted(name), "must be one of " + known + did_you_mean(name, names));
}

/// Names that do not exist, also where the phantom does not use them.
void check_names(const PhantomOptions& options) {
  for (const std::string& name : options.materials) check_material("materials", name);
  check_material("background", options.background);
  if (options.name == "vdb") return;  // its grids are known once it is read
  for (const auto& [key, names] :
       {std::pair{"grids", &options.grids}, std::pair{"targets", &options.targets}}) {
    if (names->empty()) continue;
    throw refusal(
        key,
        quoted(names->front()),
        "no such grid: the phantom " + options.name + " has none to name; phantom.name = vdb has");
  }
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
}

void check_file(const PhantomOptions& options) {
  check_readable(options.file, "a .vdb");
}

void check_any_voxel(const PhantomOptions&) {}

void check_radius(const PhantomOptions& options) {
  check_voxel(options, options.radius_m / 2);
}

void check_thickness(const PhantomOptions& options) {
  check_voxel(options, options.thickness_m / 2);
}

void check_mouth(const PhantomOptions& options) {
  // Voxels do not resolve a smaller gap.
  constexpr double kSmallest = 2e-3;
  if (options.mouth_open_m == 0) return;
  if (options.mouth_open_m < kSmallest) {
    throw refusal("mouth_open_mm", options.mouth_open_m * 1e3, "must be 0 or at least 2");
  }
  check_voxel(options, options.mouth_open_m / 4);
}

void check_tongue(const PhantomOptions& options) {
  if (options.tongue_m > 0 && options.mouth_open_m < 4e-3) {
    throw refusal("tongue_mm",
                  options.tongue_m * 1e3,
                  "needs an open mouth: mouth_open_mm must be at least 4");
  }
}

void check_cleft(const PhantomOptions& options) {
  // Voxels do not resolve a narrower gap.
  if (options.cleft_width_m == 0) return;
  if (options.cleft_width_m < 1e-3) {
    throw refusal("cleft_width_mm", options.cleft_width_m * 1e3, "must be 0 or at least 1");
  }
  check_voxel(options, options.cleft_width_m / 2);
  const double alveolus_m = options.cleft_alveolus_m;
  if (alveolus_m > 0 && alveolus_m < 1e-3) {
    throw refusal("cleft_alveolus_mm", alveolus_m * 1e3, "must be 0 or at least 1");
  }
}

void check_fetal_face(const PhantomOptions& options) {
  check_voxel(options, 2e-3);
  check_mouth(options);
  check_tongue(options);
  check_cleft(options);
  constexpr double kThinnestPlacenta = 4e-3;
  if (options.placenta_m > 0 && options.placenta_m < kThinnestPlacenta) {
    throw refusal("placenta_mm", options.placenta_m * 1e3, "must be 0 or at least 4");
  }
  // Voxels do not resolve thinner tissues.
  constexpr double kThinnest = 6e-3;
  if (options.maternal_layer_m == 0 || options.maternal_layer_m >= kThinnest) return;
  throw refusal("maternal_layer_mm", options.maternal_layer_m * 1e3, "must be 0 or at least 6");
}

void check_steps(const PhantomOptions& options) {
  const auto& heights = options.step_heights_m;
  if (heights.empty() || int(heights.size()) > kMostSteps) {
    throw refusal("step_heights_mm",
                  std::to_string(heights.size()) + " numbers",
                  "takes 1 to " + std::to_string(kMostSteps) + " numbers");
  }
  const double total = std::accumulate(heights.begin(), heights.end(), 0.0);
  if (total > kHighestStairs_m * (1 + 1e-12)) {
    std::ostringstream shown;
    shown << total * 1e3 << " in all";
    throw refusal("step_heights_mm", shown.str(), "must be at most 80 in all");
  }
  check_voxel(options, kStairs_m / double(heights.size() + 1) / 4);
}

Phantom read_file(const PhantomOptions& options) {
  return read_phantom(options.file);
}

const std::vector<Source>& built_in() {
  static const std::vector<Source> all = {{"fetal_face", make_fetal_face, check_fetal_face},
                                          {"plane", make_plane, check_any_voxel},
                                          {"steps", make_steps, check_steps},
                                          {"sphere", make_sphere, check_radius},
                                          {"points", make_points, check_any_voxel},
                                          {"cyst", make_cyst, check_radius},
                                          {"bone_plate", make_bone_plate, check_thickness},
                                          {"speckle_block", make_speckle_block, check_any_voxel}};
  return all;
}

const std::vector<Source>& imported() {
  static const std::vector<Source> all = {{"mesh", make_mesh, check_mesh},
                                          {"vdb", make_vdb, check_file},
                                          {"file", read_file, check_file}};
  return all;
}

const Source& source_of(const std::string& name) {
  std::string known;
  std::vector<std::string> names;
  for (const auto* sources : {&built_in(), &imported()}) {
    for (const Source& source : *sources) {
      if (source.name == name) return source;
      known += (known.empty() ? "" : ", ") + source.name;
      names.push_back(source.name);
    }
  }
  throw refusal("name", quoted(name), "must be one of " + known + did_you_mean(name, names));
}

}  // namespace

const std::vector<std::string>& phantom_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Source& source : built_in()) all.push_back(source.name);
    return all;
  }();
  return names;
}

void validate(const PhantomOptions& options) {
  check_ranges(options);
  source_of(options.name).check(options);
  check_names(options);
  (void)read_scatterers(options);  // its lines
}

Phantom make_phantom(const PhantomOptions& options) {
  check_ranges(options);
  const Source& source = source_of(options.name);
  source.check(options);
  check_names(options);
  const PointScatterers listed = read_scatterers(options);
  const Phantom phantom = source.build(options);
  return listed.empty() ? phantom : phantom.with(listed);
}

}  // namespace wobblebench::phantoms
