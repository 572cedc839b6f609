// Imports level sets that other programs wrote.
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "base/text.h"
#include "phantoms/builders.h"
#include "phantoms/float_grid.h"
#include "phantoms/framing.h"
#include "phantoms/grids.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"
#include "phantoms/io/vdb_file.h"
#include "phantoms/io/vdb_lattice.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

using Grid = FloatGrid;

constexpr const char* kNotCubic = "does not have cubic voxels";

constexpr double kFinestVoxel_m = 0.05e-3;

// Narrower bands cannot be interpolated on both sides of the surface.
constexpr double kNarrowestBandVoxels = 1.5;

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string grid_word(const std::string& name) {
  return "grid " + quoted(name) + " ";
}

bool is_level_set(const VdbGrid& grid) {
  return (grid.value_type == "float" || grid.value_type == "double") &&
         grid.grid_class == "level set";
}

std::string contents(const std::vector<VdbGrid>& grids) {
  std::vector<std::string> words;
  for (const auto& grid : grids) {
    const std::string name = is_printable_text(grid.name) ? grid.name : "(unprintable)";
    words.push_back(name + " (" + grid.value_type + " " + grid.grid_class + ")");
  }
  return words.empty() ? "no grids" : listed(words);
}

Grid::Ptr level_set_of(const VdbGrid& grid) {
  if (!is_printable_text(grid.name))
    throw std::invalid_argument("a grid's name is not printable UTF-8 text");
  if (grid.value_type != "float" && grid.value_type != "double") {
    throw std::invalid_argument(grid_word(grid.name) + "holds " + grid.value_type +
                                ", not float or double");
  }
  if (!grid.distances) throw std::invalid_argument(grid_word(grid.name) + kNotCubic);
  if (grid.distances->empty()) throw std::invalid_argument(grid_word(grid.name) + "is empty");
  Grid::Ptr distances = along_axes(grid.distances);
  check_level_set(grid.name, *distances);
  return distances;
}

// The grids that the scene names, or all level sets if it names none.
std::vector<Grid::Ptr> selected(const VdbFile& file, const std::vector<std::string>& names) {
  std::vector<Grid::Ptr> found;
  for (const auto& grid : file.grids) {
    if (names.empty() && is_level_set(grid)) found.push_back(level_set_of(grid));
  }
  for (const std::string& name : names) {
    const auto grid = std::find_if(file.grids.begin(),
                                   file.grids.end(),
                                   [&](const auto& candidate) { return candidate.name == name; });
    if (grid == file.grids.end()) {
      throw refusal("grids", quoted(name), "no such grid; the file holds " + contents(file.grids));
    }
    found.push_back(level_set_of(*grid));
  }
  if (!found.empty()) return found;
  throw std::invalid_argument("holds no level set, but " + contents(file.grids));
}

std::vector<std::string> names_of(const std::vector<Grid::Ptr>& grids) {
  std::vector<std::string> names;
  for (const auto& grid : grids) {
    const std::string name = grid->getName();
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      throw std::invalid_argument("two of the grids are named " + quoted(name));
    }
    names.push_back(name);
  }
  return names;
}

// Mean gradient magnitude over the voxels next to the surface: 1 for distances in the unit of the
// voxel size.
double mean_gradient(const Grid& grid) {
  const auto tree = grid.getConstAccessor();
  const double voxel = grid.voxelSize()[0];
  double sum = 0, count = 0;
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (!value.isVoxelValue() || std::abs(*value) > voxel) continue;
    openvdb::Vec3d difference;
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord low = value.getCoord(), high = low;
      low[axis] -= 1;
      high[axis] += 1;
      difference[axis] = double(tree.getValue(high)) - double(tree.getValue(low));
    }
    sum += difference.length() / (2 * voxel);
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

void check_distances(const std::string& name, const Grid& grid) {
  if (double(grid.background()) < kNarrowestBandVoxels * grid.voxelSize()[0]) {
    throw std::invalid_argument(grid_word(name) + "has a narrow band of less than 1.5 voxels");
  }
  const double slope = mean_gradient(grid);
  if (slope > 0.7 && slope < 1.4) return;
  std::ostringstream reason;
  reason << grid_word(name) << "does not hold distances in the unit of its voxels: their mean slope"
         << " at the surface is " << slope << ", not 1";
  throw std::invalid_argument(reason.str());
}

// Bounding box of the negative values, in metres.
Box bounds_of(const std::string& name, const Grid& grid) {
  openvdb::CoordBBox box;
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (*value < 0) box.expand(value.getBoundingBox());
  }
  if (box.empty()) throw std::invalid_argument(grid_word(name) + "encloses nothing");
  const openvdb::BBoxd world =
      grid.transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d()));
  return {to_glm(world.min()), to_glm(world.max())};
}

Box bounds_of(const std::vector<Grid::Ptr>& grids) {
  Box all;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const Box one = bounds_of(grids[i]->getName(), *grids[i]);
    if (i == 0) all = one;
    all = {glm::min(all.low, one.low), glm::max(all.high, one.high)};
  }
  return all;
}

// Scales from the file's unit to metres. Other programs may store unsigned values far inside: the
// flood fill restores their sign.
void scale(Grid& grid, double unit_m) {
  for (auto value = grid.beginValueAll(); value; ++value) {
    value.setValue(float(*value * unit_m));
  }
  grid.tree().root().setBackground(float(grid.background() * unit_m), /*updateChildNodes=*/false);
  grid.transform().postScale(unit_m);
  openvdb::tools::signedFloodFill(grid.tree());
}

bool is_target(const PhantomOptions& options, const std::string& name) {
  const auto& targets = options.targets;
  if (!options.target) return false;
  return targets.empty() || std::find(targets.begin(), targets.end(), name) != targets.end();
}

std::vector<Surface> surfaces_of(const PhantomOptions& options,
                                 const std::vector<std::string>& names) {
  const auto& materials = options.materials;
  if (materials.size() != 1 && materials.size() != names.size()) {
    throw refusal("materials",
                  std::to_string(materials.size()) + " names",
                  "takes 1, or one for each of " + listed(names));
  }
  for (const std::string& target : options.targets) {
    if (std::find(names.begin(), names.end(), target) == names.end()) {
      throw refusal("targets", quoted(target), "must be among the grids: " + listed(names));
    }
  }
  std::vector<Surface> surfaces;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& inside = materials[materials.size() == 1 ? 0 : i];
    surfaces.push_back({names[i], material_index(inside), is_target(options, names[i])});
  }
  return surfaces;
}

// Ours are in metres, and say more than their level sets.
void check_unit_of_ours(const PhantomOptions& options, const VdbFile& file) {
  if (file.metadata[kVersionKey] == nullptr || options.unit_m == 1) return;
  throw refusal("name",
                "\"vdb\"",
                options.file +
                    " is a phantom that this program wrote: name = \"file\" reads it, and "
                    "unit_mm = 1000 imports its level sets alone");
}

// OpenVDB takes no finer ones.
void check_voxel(const Grid& grid, double unit_m) {
  const double voxel_m = grid.voxelSize()[0] * unit_m;
  if (voxel_m >= kFinestVoxel_m) return;
  std::ostringstream reason;
  reason << grid_word(grid.getName()) << "has voxels of " << voxel_m * 1e3 << " mm, less than "
         << kFinestVoxel_m * 1e3 << " mm: is unit_mm right?";
  throw std::invalid_argument(reason.str());
}

// The phantom of the file's grids, checked, in metres, centred on the origin.
Phantom import_vdb(const PhantomOptions& options) {
  const VdbFile file = read_vdb(options.file);
  check_unit_of_ours(options, file);
  std::vector<Grid::Ptr> grids = selected(file, options.grids);
  const std::vector<std::string> names = names_of(grids);
  std::vector<Surface> surfaces = surfaces_of(options, names);
  for (auto& grid : grids) grid = on_lattice_of(*grids.front(), grid);
  double bytes = 0;
  for (const auto& grid : grids) {
    check_voxel(*grid, options.unit_m);
    check_distances(grid->getName(), *grid);
    bytes += double(grid->memUsage());
  }
  check_bytes(bytes, ": use larger voxels");
  for (const auto& grid : grids) scale(*grid, options.unit_m);
  Box bounds = bounds_of(grids);
  check_size(bounds, grids.front()->voxelSize()[0]);
  const glm::dvec3 middle = 0.5 * (bounds.low + bounds.high);
  auto result = std::make_shared<Grids>();
  for (const auto& grid : grids) {
    grid->transform().postTranslate(to_vdb(-middle));
    result->signed_distance.push_back(grid);
  }
  bounds = {bounds.low - middle, bounds.high - middle};
  return imported_phantom(options, std::move(surfaces), bounds, result);
}

}  // namespace

Phantom make_vdb(const PhantomOptions& options) {
  try {
    return import_vdb(options);
  } catch (const InvalidPhantom&) {
    throw;
  } catch (const ImportUnavailable&) {
    throw;
  } catch (const std::exception& error) {
    throw refusal("file", quoted(options.file), error.what());
  }
}

}  // namespace wobblebench::phantoms
