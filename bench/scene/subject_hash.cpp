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

/// Of the keys of fetal_face that are younger than the first recordings, all at their default where
/// the phantom is another one. The face itself is not the one of those recordings: its keys stay.
void drop_fetal_keys(nlohmann::ordered_json& section) {
  if (section.at("name") == "fetal_face") return;
  for (const char* key : {"identity",
                          "head_pitch_deg",
                          "head_yaw_deg",
                          "head_roll_deg",
                          "smile_mm",
                          "tongue_mm",
                          "lids_open_mm",
                          "cleft_width_mm",
                          "cleft_side",
                          "cleft_alveolus_mm",
                          "chin_back_deg",
                          "jaw_shorter_mm",
                          "nasal_bone_shorter_mm",
                          "eyes_apart_mm",
                          "bossing_mm",
                          "ears_lower_deg",
                          "hand",
                          "hand_gap_mm",
                          "cord",
                          "cord_gap_mm",
                          "placenta_mm"}) {
    section.erase(key);
  }
}

/// The section with the bytes of its files instead of their names.
std::uint32_t phantom_hash(nlohmann::ordered_json section,
                           const phantoms::PhantomOptions& phantom) {
  section.erase("file");
  drop_neutral(section, "mouth_open_mm", 0);
  drop_fetal_keys(section);
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
                    "recorded with (`scene` in the recording.json beside it)");
  };
  compare("phantom", &hw::SubjectHash::phantom);
  compare("motion", &hw::SubjectHash::motion);
  if (placed || scene.given.contains("placement.position_mm")) {
    compare("placement", &hw::SubjectHash::placement);
  }
}

}  // namespace wobblebench::bench
