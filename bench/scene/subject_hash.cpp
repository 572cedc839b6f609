#include "bench/scene/subject_hash.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/scene/idle_options.h"
#include "hw/wire/crc32c.h"

namespace wobblebench::bench {

namespace {

bool is_imported(const phantoms::PhantomOptions& phantom) {
  const auto& built_in = phantoms::phantom_names();
  return std::find(built_in.begin(), built_in.end(), phantom.name) == built_in.end();
}

std::uint32_t continued(std::uint32_t crc, std::string_view bytes) {
  return hw::crc32c(std::as_bytes(std::span(bytes)), crc);
}

std::uint32_t text_hash(const nlohmann::ordered_json& section) {
  return continued(0, section.dump());
}

/// Never 0, which stands for "not stated".
std::uint32_t stated(std::uint32_t crc) {
  return crc == 0 ? 1 : crc;
}

/// Leaves out keys that are younger than the first recordings where they have no effect, so that
/// those recordings keep their subject.
void drop_neutral(nlohmann::ordered_json& section, const char* key, double neutral) {
  if (section.at(key) == neutral) section.erase(key);
}

/// Keys of [phantom] that the first recordings were hashed with.
constexpr std::string_view kFirstKeys[] = {"name",
                                           "voxel_mm",
                                           "gestational_age_weeks",
                                           "maternal_layer_mm",
                                           "radius_mm",
                                           "step_heights_mm",
                                           "thickness_mm",
                                           "point_echo_db",
                                           "tilt_x_deg",
                                           "tilt_y_deg",
                                           "unit_mm",
                                           "grids",
                                           "materials",
                                           "background",
                                           "target",
                                           "targets",
                                           "scatterers",
                                           "scatterers_gain_db"};
/// Goes up when fetal_face makes another body of the same options.
constexpr int kFetalFace = 2;

/// Leaves out younger keys at their default, so that those recordings keep their subject.
void drop_younger_defaults(nlohmann::ordered_json& section) {
  const Scene standard;
  const auto defaults = resolved(standard).at("phantom");
  for (const auto& [key, value] : defaults.items()) {
    if (std::ranges::find(kFirstKeys, key) == std::end(kFirstKeys) && section.at(key) == value) {
      section.erase(key);
    }
  }
}

/// The section with the bytes of its files instead of their names.
std::uint32_t phantom_hash(nlohmann::ordered_json section,
                           const phantoms::PhantomOptions& phantom) {
  drop_younger_defaults(section);
  section.erase("file");
  if (phantom.name == "fetal_face") section["version"] = kFetalFace;
  section["scatterers"] = !phantom.scatterers.empty();
  std::uint32_t crc = text_hash(section);
  const auto add = [&](const std::string& key, const std::string& path) {
    if (path.empty()) return;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      throw UserError("phantom." + key + " = " + path + ": no such file");
    }
    read_pieces(path, [&](std::string_view piece) { crc = continued(crc, piece); });
  };
  if (is_imported(phantom)) add("file", phantom.file);
  add("scatterers", phantom.scatterers);
  return crc;
}

/// Every option with its value; of those without effect on the subject, the default.
nlohmann::ordered_json options_of_subject(const Scene& scene) {
  auto options = resolved(scene);
  const Scene standard;
  const auto defaults = resolved(standard);
  for (std::string key : idle_keys_of_subject(scene)) {
    std::replace(key.begin(), key.end(), '.', '/');
    const nlohmann::ordered_json::json_pointer place("/" + key);
    options[place] = defaults.at(place);
  }
  return options;
}

hw::SubjectHash hash_of(const Scene& scene, nlohmann::ordered_json settings) {
  drop_neutral(settings["motion"], "mouth_close_mm", 0);
  drop_neutral(settings["motion"], "mouth_period_s", phantoms::MotionOptions{}.mouth_period_s);
  return {.phantom = stated(phantom_hash(settings["phantom"], scene.phantom)),
          .placement = stated(text_hash(settings["placement"])),
          .motion = stated(text_hash(settings["motion"]))};
}

}  // namespace

hw::SubjectHash subject_hash(const Scene& scene) {
  return hash_of(scene, options_of_subject(scene));
}

void refuse_other_subject(const Scene& scene,
                          const hw::SubjectHash& recorded,
                          bool placed,
                          const std::string& source) {
  if (!recorded.stated()) return;
  const hw::SubjectHash here = subject_hash(scene), older = hash_of(scene, resolved(scene));
  const auto compare = [&](const char* section, std::uint32_t hw::SubjectHash::*part) {
    if (here.*part == recorded.*part || older.*part == recorded.*part) return;
    throw UserError(source + ": the scene's [" + section +
                    "] is not that of the recording; give the scene and --set that it was "
                    "recorded with (the recording.json beside it is one)");
  };
  compare("phantom", &hw::SubjectHash::phantom);
  compare("motion", &hw::SubjectHash::motion);
  if (placed || scene.given.contains("placement.position_mm")) {
    compare("placement", &hw::SubjectHash::placement);
  }
}

}  // namespace wobblebench::bench
