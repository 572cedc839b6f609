#include "bench/exchange/input/foreign_scan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "base/number_text.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/exchange/files/meta_image.h"
#include "bench/exchange/input/coordinates.h"
#include "bench/exchange/input/described_file.h"
#include "bench/exchange/input/foreign_array.h"
#include "bench/exchange/input/resample.h"
#include "bench/scene/given_aperture.h"

namespace wobblebench::bench {

namespace {

/// Frames that the file marks as invalid have no sticks.
std::vector<bool> valid_frames(const VoxelFile& file, const ForeignArray& array) {
  std::vector<bool> valid;
  for (std::uint64_t volume = 0; volume < array.volumes(); ++volume) {
    for (std::uint64_t frame = 0; frame < array.size(2); ++frame) {
      const std::string field = frame_field(array.third_in_file(frame, volume), "ImageStatus");
      const auto found = file.fields.find(field);
      valid.push_back(found == file.fields.end() || lower_case(found->second) == "ok");
    }
  }
  return valid;
}

/// From the file's values to samples, 0 to 1 over the dynamic range.
class Values {
 public:
  explicit Values(const Described& described) : geometry_(described.geometry) {
    const bool has_range = geometry_.has("black") && geometry_.has("white");
    const Element element = described.file.element;
    if (element == Element::uint8 && !geometry_.has("black")) geometry_.black = 0;
    if (element == Element::uint8 && !geometry_.has("white")) geometry_.white = 255;
    if (is_of_export(described.file) && !has_range) {
      geometry_.black = 0;
      geometry_.white = element == Element::uint8 ? 255 : element == Element::uint16 ? 65535 : 1;
    } else if (element != Element::uint8) {
      described.need("white", "which value is the brightest that is displayed");
      if (geometry_.values == ValueScale::log) {
        described.need("black", "which value is the darkest that is displayed");
      }
    }
    if (geometry_.values == ValueScale::linear || geometry_.has("full_scale_db")) {
      described.need("dynamic_range_db", "how many dB lie between black and white");
    }
    if (geometry_.tgc_db_per_cm_mhz != 0 && !geometry_.has("preset")) {
      described.need("center_frequency_mhz", "the frequency by which tgc_db_per_cm_mhz counts");
    }
    if (geometry_.white <= geometry_.black) {
      described.refuse("geometry.white = " + significant(geometry_.white, 6) +
                       ": must be more than black, " + significant(geometry_.black, 6));
    }
  }

  double sample(double value) const {
    const double share = (value - geometry_.black) / (geometry_.white - geometry_.black);
    // What is darker than black is below the display's range; what is brighter than white is not as
    // the geometry says, and left to be refused.
    if (share <= 0) return 0;
    if (geometry_.values == ValueScale::log) return share;
    return std::max(0.0, 1 + 20 * std::log10(share) / geometry_.dynamic_range_db);
  }

  std::string text() const {
    return significant(geometry_.black, 6) + " to " + significant(geometry_.white, 6) + " are " +
           (geometry_.has("dynamic_range_db") ? significant(geometry_.dynamic_range_db, 4) + " dB"
                                              : "a dynamic range that is not known") +
           (geometry_.values == ValueScale::linear ? ", linear values" : "");
  }

 private:
  Geometry geometry_;
};

std::vector<double> frame_angles(const Described& described, std::uint64_t frames) {
  const Geometry& geometry = described.geometry;
  if (geometry.has("fan_deg") && geometry.has("motor_angles_deg")) {
    described.refuse("geometry.motor_angles_deg: must not be given with fan_deg");
  }
  if (geometry.has("motor_angles_deg")) {
    if (geometry.motor_angles_rad.size() == frames) return geometry.motor_angles_rad;
    described.refuse("geometry.motor_angles_deg: has " +
                     std::to_string(geometry.motor_angles_rad.size()) + " angles; must have " +
                     std::to_string(frames) + ", one a frame");
  }
  if (frames > 1) described.need("fan_deg", "the angle from the first frame to the last");
  std::vector<double> angles;
  for (std::uint64_t f = 0; f < frames; ++f) {
    const double share =
        frames == 1 ? 0.5 : static_cast<double>(f) / static_cast<double>(frames - 1);
    angles.push_back((share - 0.5) * geometry.fan_rad);
  }
  return angles;
}

int whole(std::uint64_t number) {
  return static_cast<int>(std::min<std::uint64_t>(number, 1 << 30));
}

/// What is not given of its aperture is not known, and has no default.
hw::ProbeOptions probe_of(const Described& described) {
  const Geometry& geometry = described.geometry;
  if (geometry.has("preset")) {
    const std::string why = preset_refusal(geometry.probe.preset, geometry.probe.radius_m);
    if (!why.empty()) described.refuse("geometry.preset: " + why);
  }
  return with_given_aperture(
      geometry.probe,
      [&](const std::string& key) { return geometry.has(key); },
      [&](const std::string& why) { described.refuse("geometry." + why); });
}

/// The plan of the geometry for sticks of these numbers. Throws UserError where they are beyond
/// those of any plan.
hw::AcquisitionPlan plan_of(const Described& described,
                            std::uint64_t samples,
                            std::uint64_t lines,
                            std::uint64_t volumes,
                            const std::vector<double>& motor_rad) {
  const Geometry& geometry = described.geometry;
  const hw::ProbeOptions probe = probe_of(described);
  hw::AcquisitionOptions scan;
  scan.depth_m = geometry.depth_m;
  scan.sector_rad = geometry.sector_rad;
  scan.samples_per_stick = whole(samples);
  scan.sticks_per_frame = whole(lines);
  scan.frames_per_volume = whole(motor_rad.size());
  scan.volumes = whole(volumes);
  const auto [least, most] = std::ranges::minmax(motor_rad);
  // Around the middle, as all plans are.
  scan.fan_rad =
      motor_rad.size() == 1 ? 1 * kDegree : 2 * std::max(std::abs(least), std::abs(most));
  try {
    return {probe, scan};
  } catch (const InvalidOption& error) {
    throw UserError(described.file.path.string() + ": " + error.what());
  }
}

void need_fan(const Described& described, std::uint64_t frames) {
  described.need("radius_mm", "the radius of the probe's face");
  described.need("sector_deg", "the angle from the first line to the last");
  described.need("depth_mm", "the range from the face to the end of the last sample");
  if (frames > 1) {
    described.need("wobble_radius_mm", "how far behind the face the motor's axis lies");
  }
}

/// Refuses keys that do not act with the layout.
void refuse_idle(const Described& described) {
  const Layout layout = described.geometry.layout;
  const auto refuse = [&](const char* key, bool acts, const char* with) {
    if (acts || !described.geometry.has(key)) return;
    described.refuse("geometry." + std::string(key) + ": acts with layout = " + with);
  };
  refuse("center_px", layout == Layout::planes, "\"planes\"");
  refuse("lines", layout != Layout::polar, "\"planes\" or \"cartesian\"");
  refuse("frames", layout == Layout::cartesian, "\"cartesian\"");
  refuse("samples", layout != Layout::polar, "\"planes\" or \"cartesian\"");
  refuse("motor_angles_deg", layout != Layout::cartesian, "\"polar\" or \"planes\"");
  refuse("spacing_mm", layout != Layout::polar, "\"planes\" or \"cartesian\"");
  const Geometry& geometry = described.geometry;
  const bool has_beam = geometry.has("elements") || geometry.has("element_height_mm");
  if (has_beam || geometry.has("preset")) return;
  const auto refuse_without_beam = [&](const char* key) {
    if (!geometry.has(key)) return;
    described.refuse("geometry." + std::string(key) + ": acts with elements or element_height_mm");
  };
  refuse_without_beam("fractional_bandwidth");
  if (!geometry.has("tgc_db_per_cm_mhz")) refuse_without_beam("center_frequency_mhz");
}

std::string sizes_text(const VoxelFile& file) {
  std::string text;
  for (const auto size : file.sizes)
    text.append(text.empty() ? "" : " x ").append(std::to_string(size));
  return text;
}

std::string summary_of(const Described& described,
                       const Values& values,
                       const std::string& layout) {
  const VoxelFile& file = described.file;
  std::ostringstream text;
  text << "voxels      " << sizes_text(file) << " of " << element_name(file.element)
       << ", taken as " << layout << "; " << values.text() << "\n"
       << "times       not known: the file's own are not taken\n";
  return text.str();
}

hw::DisplayScale scale_of(const Geometry& geometry) {
  if (!geometry.has("dynamic_range_db")) return {};
  if (!geometry.has("full_scale_db")) {
    return {.dynamic_range_db = geometry.dynamic_range_db, .range_alone = true};
  }
  return {geometry.full_scale_db, geometry.dynamic_range_db, geometry.tgc_db_per_cm_mhz};
}

ForeignScan polar_scan(const Described& described) {
  ForeignArray array(described.file, described.geometry, {"sample", "line", "frame"});
  need_fan(described, array.size(2));
  const Values values(described);
  auto motor_rad = frame_angles(described, array.size(2));
  auto plan = plan_of(described, array.size(0), array.size(1), array.volumes(), motor_rad);
  if (!described.coordinates_m.empty()) {
    check_sticks(described.coordinates_m, array, plan, motor_rad);
  }
  const auto samples = [array, values](std::uint32_t volume, const std::vector<bool>& frames) {
    std::vector<float> read = array.values(volume, frames);
    for (float& value : read) value = static_cast<float>(values.sample(double{value}));
    return read;
  };
  return {.path = described.file.path,
          .plan = plan,
          .display_scale = scale_of(described.geometry),
          .motor_rad = std::move(motor_rad),
          .samples = samples,
          .valid = valid_frames(described.file, array),
          .summary = summary_of(described, values, "sticks: samples by line and frame")};
}

/// One step along an axis of the array, as the file says it. Throws UserError where it does not.
glm::dvec3 direction_mm(const ForeignArray& array, std::size_t axis) {
  const VoxelFile& file = array.file();
  const std::size_t in_file = array.axis_in_file(axis);
  if (file.directions_mm.empty()) {
    throw UserError(file.path.string() + ": has no spacing" +
                    (file.missing.empty() ? "" : ": " + file.missing) +
                    "; must be given as geometry.spacing_mm");
  }
  if (in_file < file.directions_mm.size()) {
    const auto& direction = file.directions_mm[in_file];
    if (direction && glm::length(*direction) > 0) return *direction;
  }
  throw UserError(file.path.string() + ": axis " + std::to_string(in_file) +
                  " has no direction in space; must have one");
}

/// Millimetres along the first two axes.
std::array<double, 2> pixel_m(const Described& described, const ForeignArray& array) {
  const Geometry& geometry = described.geometry;
  if (geometry.has("spacing_mm")) {
    if (geometry.spacing_m.size() == 2) return {geometry.spacing_m[0], geometry.spacing_m[1]};
    described.refuse("geometry.spacing_mm: must be two numbers, of a column and of a row");
  }
  // PLUS writes 1 where the spacing is not known: a sequence is taken at its word only from export.
  if (!is_of_export(described.file))
    described.need("spacing_mm", "mm from column to column and from row to row");
  std::array<double, 2> step{};
  for (std::size_t i = 0; i < 2; ++i) {
    step.at(i) = glm::length(direction_mm(array, i)) * kMillimetre;
  }
  return step;
}

ForeignScan planes_scan(const Described& described) {
  ForeignArray array(described.file, described.geometry, {"column", "row", "frame"});
  need_fan(described, array.size(2));
  described.need("center_px", "column and row of the centre of curvature");
  if (described.geometry.center_px.size() != 2) {
    described.refuse("geometry.center_px: must be two numbers, column and row");
  }
  const Values values(described);
  auto motor_rad = frame_angles(described, array.size(2));
  const PlanePixels pixels{
      .columns = array.size(0),
      .rows = array.size(1),
      .step_m = pixel_m(described, array),
      .center = {described.geometry.center_px[0], described.geometry.center_px[1]}};
  if (!described.coordinates_m.empty()) {
    check_steps(described.coordinates_m, array, pixels.step_m);
  }
  const StickCounts counts =
      sticks_of(described.geometry, std::min(pixels.step_m[0], pixels.step_m[1]));
  auto plan = plan_of(described, counts.samples, counts.lines, array.volumes(), motor_rad);
  if (const double outside = share_outside(plan, pixels); outside > 0.5) {
    described.refuse("geometry: " + significant(100 * outside, 3) +
                     " % of the sector lies outside the picture; must lie in it");
  }
  const auto samples = [array, values, pixels, plan](std::uint32_t volume,
                                                     const std::vector<bool>& frames) {
    return sticks_of_planes(plan, pixels, array.values(volume, frames), [&](double value) {
      return values.sample(value);
    });
  };
  return {.path = described.file.path,
          .plan = plan,
          .display_scale = scale_of(described.geometry),
          .motor_rad = std::move(motor_rad),
          .samples = samples,
          .valid = valid_frames(described.file, array),
          .summary = summary_of(described, values, "scan-converted planes of a fan")};
}

/// Where the voxels lie, in the probe frame.
VoxelGrid grid_of(const Described& described, const ForeignArray& array) {
  VoxelGrid grid{.sizes = {array.size(0), array.size(1), array.size(2)}};
  const Geometry& geometry = described.geometry;
  const VoxelFile& file = described.file;
  if (geometry.has("spacing_mm") && geometry.spacing_m.size() != 3) {
    described.refuse("geometry.spacing_mm: must be three numbers, along x, y and z");
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const int axis = static_cast<int>(i);
    if (geometry.has("spacing_mm")) {
      grid.step_m[axis] = glm::dvec3(0);
      grid.step_m[axis][axis] = geometry.spacing_m[i];
      continue;
    }
    grid.step_m[axis] = direction_mm(array, i) * kMillimetre;
  }
  grid.origin_m = file.origin_mm * kMillimetre;
  if (std::abs(glm::determinant(grid.step_m)) < 1e-15) {
    throw UserError(file.path.string() + ": its axes lie in one plane; must span a volume");
  }
  return grid;
}

ForeignScan cartesian_scan(Described described) {
  if (!described.coordinates_m.empty()) place_by(described.coordinates_m, described.file);
  ForeignArray array(described.file, described.geometry, {"x", "y", "z"});
  VoxelGrid grid = grid_of(described, array);
  const double step_m = grid.least_step_m();
  std::string layout = "a grid in the probe frame";
  if (!described.geometry.has("radius_mm")) {
    set_looking_fan(grid, described.geometry);
    layout = "a grid seen along its last axis, by a fan of sticks that is made up for it";
  }
  need_fan(described, 2);
  const Values values(described);
  const StickCounts counts = sticks_of(described.geometry, step_m);
  auto motor_rad = frame_angles(described, counts.frames);
  auto plan = plan_of(described, counts.samples, counts.lines, array.volumes(), motor_rad);
  const auto samples = [array, values, grid, plan](std::uint32_t volume, const auto&) {
    return sticks_of_grid(
        plan, grid, array.values(volume), [&](double value) { return values.sample(value); });
  };
  return {.path = described.file.path,
          .plan = plan,
          .display_scale = scale_of(described.geometry),
          .motor_rad = std::move(motor_rad),
          .samples = samples,
          .summary = summary_of(described, values, layout)};
}

ForeignScan scan_of(Described described) {
  described.need("layout", "polar, planes or cartesian");
  refuse_idle(described);
  switch (described.geometry.layout) {
    case Layout::polar:
      return polar_scan(described);
    case Layout::planes:
      return planes_scan(described);
    case Layout::cartesian:
      return cartesian_scan(std::move(described));
  }
  throw std::logic_error("a layout without a reader");
}

}  // namespace

ForeignScan open_foreign_scan(const std::filesystem::path& path,
                              const std::filesystem::path& geometry) {
  return scan_of(describe_file(path, geometry));
}

ForeignScan scan_of_voxels(VoxelFile file, const std::filesystem::path& geometry) {
  return scan_of(describe_voxels(std::move(file), geometry));
}

}  // namespace wobblebench::bench
