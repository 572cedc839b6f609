// Builds or imports a phantom, prints its properties, and writes it for other OpenVDB tools.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/common.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "base/number_text.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/report.h"
#include "bench/scene/idle_options.h"
#include "bench/scene/resolved_scene.h"
#include "bench/scene/scene.h"
#include "phantoms/grids.h"
#include "phantoms/label_finder.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

namespace {

/// Rounded to a nanometre: 0.16 m reads 160 mm.
double to_mm(double metres) {
  return std::round(metres * 1e9) / 1e6;
}

Json to_mm(const glm::dvec3& point_m) {
  return {to_mm(point_m.x), to_mm(point_m.y), to_mm(point_m.z)};
}

double in_mb(std::uint64_t bytes) {
  return std::round(static_cast<double>(bytes) / 1e4) / 100;
}

const std::string& material_name(const phantoms::Phantom& phantom, phantoms::MaterialIndex index) {
  return phantom.materials().at(static_cast<std::size_t>(index)).name;
}

/// "33.51 ml, 50.27 cm2".
std::string size_text(const phantoms::Phantom& phantom, std::size_t index) {
  const auto size = phantoms::body_size(phantom, index);
  if (!size) return "cut at the ends of its grid";
  return significant(size->volume_m3 * 1e6, 4) + " ml, " + significant(size->area_m2 * 1e4, 4) +
         " cm2";
}

/// Those of the material table that occur in the phantom.
std::set<phantoms::MaterialIndex> used_materials(const phantoms::Phantom& phantom) {
  std::set<phantoms::MaterialIndex> used = {phantom.background()};
  for (const auto& surface : phantom.surfaces()) used.insert(surface.inside);
  return used;
}

Table material_table(const phantoms::Phantom& phantom) {
  using M = phantoms::Material;
  std::vector<M> used;
  for (const auto index : used_materials(phantom)) {
    used.push_back(phantom.materials().at(static_cast<std::size_t>(index)));
  }
  return table_of<M>(
      {.name = "materials", .caption = "Materials"},
      used,
      {{{"name", "material"}, &M::name},
       {{"sound_speed_m_s", "speed of sound", "m/s", 0}, &M::sound_speed_m_s},
       {{"impedance_mrayl", "impedance", "MRayl", 3},
        [](const M& m) { return m.impedance_rayl / 1e6; }},
       {{"attenuation_db_per_cm_mhz", "attenuation", "dB/cm/MHz"}, &M::attenuation_db_per_cm_mhz},
       {{"backscatter_db", "backscatter", "dB", 1}, &M::backscatter_db},
       {{"roughness"}, &M::roughness},
       {{"source"}, &M::source}});
}

Table surface_table(const phantoms::Phantom& phantom) {
  Table table{.name = "surfaces",
              .caption = "Surfaces and the grids that hold them",
              .columns = {{"name", "surface"},
                          {"inside"},
                          {"target"},
                          {"volume_ml", "volume", "ml"},
                          {"surface_cm2", "area", "cm²"},
                          {"voxel_mm", "voxel", "mm", 3},
                          {"voxels"},
                          {"memory_mb", "memory", "MB"}}};
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const auto& surface = phantom.surfaces()[i];
    const auto grid = phantoms::grid_memory(phantom, i);
    const auto size = phantoms::body_size(phantom, i);
    table.add({surface.name,
               material_name(phantom, surface.inside),
               surface.is_target,
               size ? Cell(size->volume_m3 * 1e6) : Cell(),
               size ? Cell(size->area_m2 * 1e4) : Cell(),
               to_mm(grid.voxel_m),
               grid.voxels,
               in_mb(grid.bytes)});
  }
  return table;
}

Json joint_json(const std::optional<phantoms::Joint>& joint) {
  if (!joint) return nullptr;
  return {{"center_mm", to_mm(joint->center_m)},
          {"inner_mm", to_mm(joint->inner_m)},
          {"outer_mm", to_mm(joint->outer_m)},
          {"mouth_open_mm", joint->mouth ? to_mm(joint->mouth->opening_m) : 0}};
}

/// What the report says of point scatterers, over all keys of all tracks.
struct ScattererSummary {
  std::size_t moving = 0;
  double strongest = 0;  ///< amplitude
  phantoms::Box box{glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)};

  explicit ScattererSummary(const phantoms::PointScatterers& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      moving += !points.fixed(i);
      for (const auto& key : points.track(i)) {
        strongest = std::max(strongest, std::abs(key.point.amplitude));
        box = {glm::min(box.low, key.point.position_m), glm::max(box.high, key.point.position_m)};
      }
    }
  }
  /// Re a perfect mirror, to a hundredth.
  double strongest_db() const { return std::round(2000 * std::log10(strongest)) / 100; }
};

Json scatterers_json(const phantoms::PointScatterers& points) {
  if (points.empty()) return nullptr;
  const ScattererSummary summary(points);
  return {{"count", points.size()},
          {"moving", summary.moving},
          {"strongest_db", summary.strongest > 0 ? Json(summary.strongest_db()) : Json(nullptr)},
          {"low_mm", to_mm(summary.box.low)},
          {"high_mm", to_mm(summary.box.high)}};
}

/// "(x, y, z)", mm.
std::string corner_text(const glm::dvec3& point_m) {
  std::ostringstream text;
  text << "(" << to_mm(point_m.x) << ", " << to_mm(point_m.y) << ", " << to_mm(point_m.z) << ")";
  return text.str();
}

std::string scatterers_line(const phantoms::PointScatterers& points) {
  if (points.empty()) return "";
  const ScattererSummary summary(points);
  std::ostringstream text;
  text << "points      " << points.size() << " point scatterers";
  if (summary.moving > 0) text << ", " << summary.moving << " of them moving";
  if (summary.strongest > 0) text << ", the strongest of " << summary.strongest_db() << " dB";
  text << ", within " << corner_text(summary.box.low) << " to " << corner_text(summary.box.high)
       << " mm\n";
  return text.str();
}

/// Positions in the phantom frame; null: it has none.
Json landmarks_json(const phantoms::Phantom& phantom) {
  if (phantom.landmarks().empty()) return nullptr;
  Json landmarks = Json::object();
  for (const phantoms::Landmark& landmark : phantom.landmarks()) {
    landmarks[landmark.name] = to_mm(landmark.position_m);
  }
  return landmarks;
}

Json phantom_json(const phantoms::Phantom& phantom) {
  std::uint64_t voxels = 0, bytes = 0;
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const auto grid = phantoms::grid_memory(phantom, i);
    voxels += grid.voxels;
    bytes += grid.bytes;
  }
  return {{"name", phantom.name()},
          {"background", material_name(phantom, phantom.background())},
          {"surfaces", to_json(surface_table(phantom))},
          {"scatterers", scatterers_json(phantom.scatterers())},
          {"voxels", voxels},
          {"memory_mb", in_mb(bytes)},
          {"region_of_interest_mm",
           {{"low", to_mm(phantom.region_of_interest().low)},
            {"high", to_mm(phantom.region_of_interest().high)}}},
          {"suggested_position_mm", to_mm(phantom.suggested_position_m())},
          {"joint", joint_json(phantom.joint())},
          {"measures", measures_json(phantom)},
          {"landmarks_mm", landmarks_json(phantom)},
          {"materials", to_json(material_table(phantom))}};
}

/// The text of report.json.
std::string phantom_report(const phantoms::Phantom& phantom, const Scene& scene) {
  Json report = report_head("phantom", provenance_of_this_machine(), scene);
  report["phantom"] = phantom_json(phantom);
  return report_text(report);
}

/// Surfaces with the sizes of their grids, region of interest, joint; `file`: where it was written.
std::string phantom_summary(const phantoms::Phantom& phantom, const std::filesystem::path& file) {
  std::ostringstream text;
  text << "phantom     " << phantom.name() << " in " << material_name(phantom, phantom.background())
       << (phantom.joint() ? ", with a joint" : "") << "\n";
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const auto& surface = phantom.surfaces()[i];
    const auto grid = phantoms::grid_memory(phantom, i);
    text << "surface     " << surface.name << ": " << material_name(phantom, surface.inside)
         << " within, " << size_text(phantom, i) << ", " << grid.voxels << " voxels of "
         << to_mm(grid.voxel_m) << " mm, " << in_mb(grid.bytes) << " MB"
         << (surface.is_target ? ", a target" : "") << "\n";
  }
  text << scatterers_line(phantom.scatterers());
  const auto& box = phantom.region_of_interest();
  text << "interest    " << corner_text(box.low) << " to " << corner_text(box.high) << " mm\n"
       << "position    " << corner_text(phantom.suggested_position_m())
       << " mm in front of the probe, unless the scene says otherwise\n"
       << "results     " << file.string() << "\n";
  return text.str();
}

Document phantom_document(const phantoms::Phantom& phantom, const std::string& summary) {
  Document document{.title = "Phantom " + phantom.name()};
  document.add(surface_table(phantom))
      .add(material_table(phantom))
      .add(Listing{"Summary", summary});
  return document;
}

/// The labels of labels.vdb.
Table label_names_table(const phantoms::Phantom& phantom) {
  Table table{.name = "labels", .columns = {{"label"}, {"name"}, {"meaning"}}};
  for (const phantoms::LabelName& name : phantoms::label_names(phantom)) {
    std::string meaning;
    for (const phantoms::PartName& part : phantoms::part_names()) {
      if (static_cast<int>(part.part) == int{name.label}) meaning = part.meaning;
    }
    table.add({static_cast<int>(name.label), name.name, meaning});
  }
  return table;
}

struct PhantomArguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  bool labels = false;
};

/// The scene with the phantom's placement. A motion that the phantom cannot make is no fault: it is
/// written at rest.
Scene placed_scene(const Scene& given, const phantoms::Phantom& phantom) {
  Scene at_rest = given;
  at_rest.motion = {};
  Scene placed = resolve_scene(at_rest, phantom).options();
  placed.motion = given.motion;
  return placed;
}

int write_phantom(const PhantomArguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  return run_in_folder(
      arguments.output,
      {{"phantom", 10}, {"write", 1}, {"labels", arguments.labels ? 3.0 : 0.0}},
      [&](OutputFolder& out, Progress& progress) {
        std::set<std::string> keys = scene.given;
        std::erase_if(keys, [](const auto& key) { return !key.starts_with("phantom."); });
        progress.warn(idle_options_text(idle_options(scene, keys)));
        PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
        const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
        progress.step("write", [&] { phantoms::write_phantom(phantom, out.stage("phantom.vdb")); });
        const std::string summary = phantom_summary(phantom, out.directory() / "phantom.vdb");
        CommandResult done{.report = phantom_report(phantom, placed_scene(scene, phantom)),
                           .summary = summary,
                           .document = phantom_document(phantom, summary)};
        if (arguments.labels) {
          progress.step("labels",
                        [&] { phantoms::write_labels(phantom, out.stage("labels.vdb")); });
          done.document.data.push_back({"labels.csv", label_names_table(phantom)});
        }
        return done;
      });
}

}  // namespace

Command add_phantom_command(CLI::App& app) {
  const auto arguments = std::make_shared<PhantomArguments>();
  CLI::App& command = add_subcommand(app, "phantom", "Build a phantom and write it as phantom.vdb");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_flag(command,
           "--labels",
           arguments->labels,
           "Write labels.vdb, the part of the phantom at each voxel, and labels.csv, their names "
           "(docs/labels.md)");
  return {&command, [arguments] { return write_phantom(*arguments); }};
}

}  // namespace wobblebench::bench
