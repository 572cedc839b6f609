// The phantoms by name, and the checks of their options.
#include <cmath>
#include <numeric>
#include <sstream>

#include "phantoms/builders.h"
#include "phantoms/io/imports.h"
#include "phantoms/io/scatterer_file.h"
#include "phantoms/phantom.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

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

void check_any_voxel(const PhantomOptions&) {}

void check_points(const PhantomOptions& options) {
  check_material("background", options.background);
}

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

void check_fetal_face(const PhantomOptions& options) {
  check_voxel(options, 2e-3);
  check_mouth(options);
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

const std::vector<Source>& built_in() {
  static const std::vector<Source> all = {{"fetal_face", make_fetal_face, check_fetal_face},
                                          {"plane", make_plane, check_any_voxel},
                                          {"steps", make_steps, check_steps},
                                          {"sphere", make_sphere, check_radius},
                                          {"points", make_points, check_points},
                                          {"cyst", make_cyst, check_radius},
                                          {"bone_plate", make_bone_plate, check_thickness},
                                          {"speckle_block", make_speckle_block, check_any_voxel}};
  return all;
}

const std::vector<Source>& imported() {
  static const std::vector<Source> all = {{"mesh", make_mesh, check_mesh},
                                          {"vdb", make_vdb, check_vdb},
                                          {"file", make_file, check_file}};
  return all;
}

const Source& source_of(const std::string& name) {
  std::string known;
  for (const auto* sources : {&built_in(), &imported()}) {
    for (const Source& source : *sources) {
      if (source.name == name) return source;
      known += (known.empty() ? "" : ", ") + source.name;
    }
  }
  throw refusal("name", quoted(name), "must be one of " + known);
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
  (void)read_scatterers(options);  // its lines
}

Phantom make_phantom(const PhantomOptions& options) {
  check_ranges(options);
  const Source& source = source_of(options.name);
  source.check(options);
  const PointScatterers listed = read_scatterers(options);
  const Phantom phantom = source.build(options);
  return listed.empty() ? phantom : phantom.with(listed);
}

}  // namespace wobblebench::phantoms
