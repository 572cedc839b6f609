#include "bench/studies/dataset/dataset_scenes.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/cache/sha256.h"
#include "bench/command/program.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/output_folder.h"
#include "bench/output/report_parts.h"
#include "bench/results/error.h"
#include "bench/scene/scene_text.h"
#include "bench/studies/compare/child_program.h"
#include "bench/studies/plans/option_tables.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSceneFile = "scene.toml";
constexpr const char* kLineFile = "scene.json";
constexpr const char* kRecording = "recording.wbst";
constexpr std::size_t kMostJsonBytes = 100'000'000;

/// They hold times and dates, so that no two runs write the same.
constexpr std::array<std::string_view, 4> kNotCompared = {
    "report.json", "recording.json", "report.html", kLineFile};

bool is_compared(const std::string& name) {
  return std::ranges::find(kNotCompared, name) == kNotCompared.end();
}

std::string padded(int index) {
  const std::string digits = std::to_string(index);
  return std::string(6 - std::min<std::size_t>(6, digits.size()), '0') + digits;
}

Json read_json(const fs::path& file) {
  Json json = Json::parse(read_file(file, kMostJsonBytes), nullptr, false);
  if (json.is_discarded()) throw std::runtime_error(file.string() + ": is no JSON");
  return json;
}

[[noreturn]] void refuse_out(const fs::path& folder, const std::string& reason) {
  throw UserError("--out = " + folder.string() + ": " + reason);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse_out(folder, "cannot be made: " + why_not_made(folder, error));
}

/// Under its name as a whole, or not at all; several commands may write the same at once.
void write_whole(const fs::path& path, const std::string& text) {
  const fs::path partial = path.string() + "." + std::to_string(::getpid()) + ".partial";
  write_file(partial, text);
  fs::rename(partial, path);
  sync_folder(path.parent_path());
}

/// A value as JSON has it: TOML writes numbers, truth values and most texts alike.
Json json_value(const std::string& toml) {
  Json value = Json::parse(toml, nullptr, false);
  return value.is_discarded() ? Json(plain_value(toml)) : value;
}

Json settings_json(const DrawnScene& drawn) {
  Json json = Json::object();
  for (const std::string& setting : drawn.settings) {
    const auto equals = setting.find('=');
    json[setting.substr(0, equals)] = json_value(setting.substr(equals + 1));
  }
  return json;
}

/// The programs' arguments that make a scene: of its file and the folder for its results.
std::vector<std::vector<std::string>> commands_of(const PopulationPlan& plan,
                                                  const SceneMaking& how,
                                                  const fs::path& scene,
                                                  const fs::path& out) {
  const std::string recording = (out / kRecording).string();
  std::vector<std::vector<std::string>> commands = {
      {"record", scene.string(), "--out", out.string()},
      {"run", scene.string(), "--board", "file=" + recording, "--labels", "--out", out.string()}};
  if (how.gl != "auto") commands.back().insert(commands.back().end(), {"--gl", how.gl});
  if (plan.exports.empty()) return commands;
  std::vector<std::string> exported = {"export", recording, "--scene", scene.string()};
  for (const std::string& to : plan.exports) {
    exported.insert(exported.end(), {"--to", (out / to).string()});
  }
  commands.push_back(std::move(exported));
  return commands;
}

std::string command_text(const PopulationPlan& plan, const SceneMaking& how, int index) {
  std::string text;
  const fs::path scene = fs::path("scenes") / padded(index) / kSceneFile;
  for (const auto& words : commands_of(plan, how, scene, "again")) {
    text += text.empty() ? "wobblebench" : " && wobblebench";
    for (const std::string& word : words) text.append(" ").append(shell_word(word));
  }
  return text;
}

/// The folder in which one scene is made, locked while this lives, and removed with it.
class WorkFolder {
 public:
  /// Throws FolderInUse.
  explicit WorkFolder(fs::path path) : path_(made(std::move(path))), lock_(path_) {
    fs::remove_all(results());
    fs::create_directory(results());
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  fs::path results() const { return path_ / "scene"; }

 private:
  static fs::path made(fs::path path) {
    fs::create_directories(path);
    return path;
  }

  fs::path path_;
  FolderLock lock_;
};

/// Without the folder, whose name is another one when the scene is made again.
std::string without_folder(std::string line, const fs::path& folder) {
  const std::string prefix = folder.string() + "/";
  for (auto at = line.find(prefix); at != std::string::npos; at = line.find(prefix)) {
    line.erase(at, prefix.size());
  }
  const std::string program = "wobblebench: ";
  return line.starts_with(program) ? line.substr(program.size()) : line;
}

/// Runs the commands of a scene. Returns the line that refused it; empty: it was made.
std::string run_commands(const PopulationPlan& plan,
                         int index,
                         const SceneMaking& how,
                         const fs::path& folder) {
  // The running program itself, also where another was built in its place meanwhile.
  const fs::path program = "/proc/self/exe";
  const std::vector<std::string> cache =
      how.cache.off ? std::vector<std::string>{"--no-cache"}
                    : std::vector<std::string>{"--cache-mb", std::to_string(how.cache.megabytes)};
  for (auto words : commands_of(plan, how, folder / kSceneFile, folder)) {
    words.insert(words.end(), cache.begin(), cache.end());
    const ChildEnd end = run_child(program, words);
    if (stop_requested()) {
      throw std::runtime_error(
          "interrupted; the same command goes on with the scenes that are made");
    }
    if (end.exit_code == kDone) continue;
    std::string line = without_folder(end.last_error, folder);
    if (end.exit_code == kBadInput && is_refusal_of_scene(line)) return line;
    const std::string what = "scene " + std::to_string(index) + ": " + words.front() + ": " + line;
    if (end.exit_code == kBadInput) throw UserError(what);
    throw std::runtime_error(what + " (exit code " + std::to_string(end.exit_code) +
                             "); the same command goes on with the scenes that are made");
  }
  return "";
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// Pages and their charts are large, and follow from the other files.
void remove_pages(const fs::path& folder) {
  for (const fs::path& file : files_in(folder)) {
    if (file.extension() == ".html" || file.string().ends_with(".vl.json")) fs::remove(file);
  }
}

/// The figures of the picture that a user chooses scenes by.
Json error_of(const Json& report) {
  if (report.at("error").is_null()) return nullptr;
  Json figures;
  for (const Measure* one :
       {&error::kMedian, &error::kP95, &error::kMissed, &error::kFalse, &error::kSurface}) {
    figures[one->key] = report.at("error").at(one->key);
  }
  return figures;
}

/// The manifest's line of a scene whose files lie in `folder`. `refusal`: empty: it was made.
Json line_of(const PopulationPlan& plan,
             const DrawnScene& drawn,
             const SceneMaking& how,
             const std::string& refusal,
             const fs::path& folder) {
  const Json settings = settings_json(drawn);
  Json line = {{"index", drawn.index},
               {"seed", settings.at("simulation.seed")},
               {"stratum", plan.strata[drawn.stratum].name},
               {"settings", settings}};
  if (!refusal.empty()) line["refused"] = refusal;
  if (refusal.empty()) {
    const Json report = read_json(folder / "report.json");
    line["measures"] = report.at("measures");
    line["error"] = error_of(report);
  }
  line["files"] = Json::object();
  std::uintmax_t bytes = 0;
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.filename().string();
    if (!is_compared(name)) continue;
    line["files"][name] = sha256_of_file(file);
    bytes += fs::file_size(file);
  }
  line["bytes"] = bytes;
  line["command"] = command_text(plan, how, drawn.index);
  return line;
}

/// The files of a scene in `folder`, and its line.
Json fill_folder(const PopulationPlan& plan,
                 int index,
                 const SceneMaking& how,
                 const fs::path& folder) {
  const DrawnScene drawn = plan.draw(index);
  write_file(folder / kSceneFile, scene_text(plan.file, drawn.settings));
  const std::string refusal = run_commands(plan, index, how, folder);
  if (!refusal.empty()) {
    for (const fs::path& file : files_in(folder)) {
      if (file.filename() != kSceneFile) fs::remove_all(file);
    }
  }
  if (!plan.pages) remove_pages(folder);
  return line_of(plan, drawn, how, refusal, folder);
}

}  // namespace

bool is_refusal_of_scene(const std::string& line) {
  constexpr std::array<std::string_view, 8> kStarts = {"scene.toml:",
                                                       "phantom.",
                                                       "placement.",
                                                       "motion.",
                                                       "probe.",
                                                       "acquisition.",
                                                       "simulation.",
                                                       "render."};
  return std::ranges::any_of(kStarts,
                             [&](std::string_view start) { return line.starts_with(start); });
}

DatasetFolder::DatasetFolder(fs::path folder, const PopulationPlan& plan, bool adds_scenes)
    : folder_(std::move(folder)) {
  if (folder_.string().find(',') != std::string::npos) {
    refuse_out(folder_, "must have no comma, which --board takes for the end of a file's name");
  }
  make_folder(folder_ / "scenes");
  check_head(plan, adds_scenes);
}

void DatasetFolder::check_head(const PopulationPlan& plan, bool adds_scenes) const {
  const fs::path file = folder_ / "dataset.json";
  const Json head = {{"schema", "wobblebench.dataset/1"},
                     {"plan", plan.hash()},
                     {"program", version_line("wobblebench")}};
  if (!fs::exists(file)) {
    write_whole(file, head.dump(1) + "\n");
    return;
  }
  const Json found = read_json(file);
  for (const std::string key : {"schema", "plan", "program"}) {
    if (key == "program" && !adds_scenes) continue;
    if (found.is_object() && found.value(key, "") == head.at(key)) continue;
    refuse_out(folder_,
               "holds scenes of another " + key +
                   "; must be a folder of this plan and program, or a new one");
  }
}

fs::path DatasetFolder::scene(int index) const {
  return folder_ / "scenes" / padded(index);
}

bool DatasetFolder::has(int index) const {
  return fs::exists(scene(index) / kLineFile);
}

Json DatasetFolder::line(int index) const {
  return read_json(scene(index) / kLineFile);
}

SceneOutcome make_scene(const PopulationPlan& plan,
                        int index,
                        const SceneMaking& how,
                        const DatasetFolder& folder) {
  try {
    const WorkFolder work(folder.path() / "scenes" / (".making-" + padded(index)));
    // Another command may have made it before the lock was taken.
    if (folder.has(index)) return SceneOutcome::made;
    const Json line = fill_folder(plan, index, how, work.results());
    write_file(work.results() / kLineFile, line.dump() + "\n");
    sync_folder(work.results());
    fs::rename(work.results(), folder.scene(index));
    sync_folder(folder.path() / "scenes");
    return line.contains("refused") ? SceneOutcome::refused : SceneOutcome::made;
  } catch (const FolderInUse&) {
    return SceneOutcome::in_other_hands;
  }
}

std::vector<std::string> verify_scene(const PopulationPlan& plan,
                                      int index,
                                      const SceneMaking& how,
                                      const DatasetFolder& folder) {
  const std::string name = "scenes/" + padded(index);
  const Json kept = folder.line(index);
  const WorkFolder work(folder.path() / (".verifying-" + padded(index)));
  const Json made = fill_folder(plan, index, how, work.results());
  std::vector<std::string> differences;
  std::map<std::string, int> names;
  for (const Json* line : {&kept, &made}) {
    for (const auto& [file, hash] : line->at("files").items()) ++names[file];
  }
  for (const auto& [file, count] : names) {
    const fs::path there = folder.scene(index) / file, again = work.results() / file;
    if (!fs::exists(there)) {
      differences.push_back(name + "/" + file + ": is missing");
    } else if (!fs::exists(again) || sha256_of_file(there) != sha256_of_file(again)) {
      differences.push_back(name + "/" + file + ": differs from the one that is made again");
    }
  }
  // Of the same files another line: of the manifest's own figures.
  if (differences.empty() && kept != made) {
    differences.push_back(name + "/" + kLineFile + ": differs from the one that is made again");
  }
  return differences;
}

std::vector<int> scenes_to_verify(const PopulationPlan& plan,
                                  const DatasetFolder& folder,
                                  std::size_t most) {
  std::vector<std::pair<double, int>> order;
  for (int i = 0; i < plan.scenes; ++i) {
    if (folder.has(i)) {
      order.emplace_back(unit_draw(plan.seed, static_cast<std::uint64_t>(i), "verify"), i);
    }
  }
  std::ranges::sort(order);
  if (order.size() > most) order.resize(most);
  std::vector<int> scenes;
  for (const auto& [unit, index] : order) scenes.push_back(index);
  return scenes;
}

}  // namespace wobblebench::bench
