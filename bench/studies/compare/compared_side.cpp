#include "bench/studies/compare/compared_side.h"

#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

#include "base/file.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/image_io.h"
#include "bench/scene/reported_run.h"
#include "bench/studies/compare/child_program.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kMostReportBytes = 100'000'000;

Json read_report(const fs::path& file) {
  Json report = Json::parse(read_file(file, kMostReportBytes), nullptr, false);
  if (report.is_discarded()) throw UserError(file.string() + ": is no JSON");
  return report;
}

std::string read_if_there(const fs::path& file) {
  std::error_code ignored;
  constexpr std::size_t kMostPictureBytes = 100'000'000;
  return fs::is_regular_file(file, ignored) ? read_file(file, kMostPictureBytes) : "";
}

/// The pictures of these files, which may be missing.
KeptPictures pictures_of(const fs::path& surface, const fs::path& error) {
  return {read_if_there(surface), read_if_there(error), read_png(surface)};
}

/// The scene's name in the names of its pictures: what keeps the artefacts of continuous
/// integration refuses these characters.
std::string file_part(std::string name) {
  const auto is_refused = [](char c) {
    return is_control(c) || std::string_view("\":<>|*?\\").find(c) != std::string_view::npos;
  };
  std::ranges::replace_if(name, is_refused, '_');
  return name;
}

std::string settings_text(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) text += " --set " + setting;
  return text;
}

ComparedSide side_of_folder(const std::string& option,
                            const std::string& text,
                            const std::vector<std::string>& own) {
  if (!own.empty()) {
    throw UserError("--" + option + "-set: without effect: " + text +
                    " has figures that were kept");
  }
  const fs::path report = fs::path(text) / "report.json";
  if (!fs::is_regular_file(report)) {
    throw UserError(text +
                    ": has no report.json; a folder must be of `wobblebench compare` or `run`");
  }
  const Json kept = read_report(report);
  ComparedSide side{.text = text, .measured = kept_side(kept, text), .folder = text};
  if (kept["command"] == "run") side.measured.board = simulated_board_of(kept, report.string());
  return side;
}

std::vector<std::string> arguments_of(const ProgramSide& of,
                                      const std::string& board,
                                      const ComparedScene& scene,
                                      std::uint64_t seed,
                                      const fs::path& out) {
  std::vector<std::string> words = {"run", "--board", board};
  if (!scene.file.empty()) words.push_back(scene.file.string());
  for (const std::string& setting : of.settings) {
    words.insert(words.end(), {"--set", setting});
  }
  words.insert(words.end(),
               {"--set", "simulation.seed=" + std::to_string(seed), "--out", out.string()});
  if (of.counts_work) words.emplace_back("--count-work");
  return words;
}

/// Where a run's results go, until they are read. The run makes the folder itself, and removes it
/// where it is interrupted.
struct RunFolder {
  fs::path path =
      fs::temp_directory_path() / ("wobblebench-compare-" + std::to_string(std::random_device()()));

  RunFolder() = default;
  ~RunFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
};

void check_end(const ChildEnd& end, const fs::path& program) {
  constexpr int kBadInput = 2;
  if (end.exit_code == 0) return;
  const std::string line = program.string() + ": " + end.last_error;
  if (end.exit_code == kBadInput) throw UserError(line);
  throw std::runtime_error(line + " (exit code " + std::to_string(end.exit_code) + ")");
}

}  // namespace

std::vector<ComparedScene> compared_scenes(const std::vector<std::string>& files) {
  if (files.empty()) return {{"default", {}}};
  std::vector<ComparedScene> scenes;
  for (const std::string& file : files) {
    ComparedScene scene{fs::path(file).stem().string(), file};
    const auto part_of = [](const ComparedScene& of) { return file_part(of.name); };
    const auto same = std::ranges::find(scenes, part_of(scene), part_of);
    if (same != scenes.end()) {
      throw UserError("--scene = " + file + ": another scene is called " + same->name + ", too");
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

ComparedSide parse_side(const std::string& option,
                        const std::string& text,
                        std::vector<std::string> settings,
                        const std::vector<std::string>& own) {
  std::error_code ignored;
  if (fs::is_directory(text, ignored)) return side_of_folder(option, text, own);
  settings.insert(settings.end(), own.begin(), own.end());
  const bool is_this = text == "this";
  const fs::path program = is_this ? fs::read_symlink("/proc/self/exe") : fs::absolute(text);
  if (!fs::is_regular_file(program, ignored) || ::access(program.c_str(), X_OK) != 0) {
    throw UserError(option + " = " + text +
                    ": must be \"this\" (the running program), the file of a wobblebench program, "
                    "or a folder of `wobblebench compare` or `run`");
  }
  std::string help;
  try {
    help = output_of_child(program, {"run", "--help"});
  } catch (const std::runtime_error& error) {
    throw UserError(option + " = " + text + ": is no program wobblebench: " + error.what());
  }
  return {.text = text,
          .program = ProgramSide{.program = program,
                                 .settings = settings,
                                 .counts_work = help.find("--count-work") != std::string::npos},
          .measured = {.what = text + settings_text(settings)}};
}

KeptPictures measure(ComparedSide& side, const ComparedScene& scene, std::uint64_t seed) {
  const ProgramSide& of = side.program.value();
  const RunFolder folder;
  const fs::path& out = folder.path;
  check_end(run_child(of.program, arguments_of(of, side.measured.board, scene, seed, out)),
            of.program);
  const Json report = read_report(out / "report.json");
  const MeasuredSide run = kept_side(report, of.program.string());
  MeasuredSide& measured = side.measured;
  measured.commit = run.commit;
  measured.cpu = run.cpu;
  measured.gl_renderer = run.gl_renderer;
  measured.settings[scene.name] = settings_in(report);
  measured.runs.push_back({scene.name, seed, run.runs.front().figures});
  return pictures_of(out / "surface.png", out / "error.png");
}

std::string compared_picture(const std::string& side,
                             const std::string& scene,
                             const std::string& kind) {
  std::string name = side;
  return name.append("_").append(file_part(scene)).append("_").append(kind).append(".png");
}

KeptPictures kept_pictures(const ComparedSide& side, const ComparedScene& scene) {
  const auto of_compare = [&](const char* kind) {
    return side.folder / compared_picture("new", scene.name, kind);
  };
  std::error_code ignored;
  if (fs::is_regular_file(of_compare("surface"), ignored)) {
    return pictures_of(of_compare("surface"), of_compare("error"));
  }
  return pictures_of(side.folder / "surface.png", side.folder / "error.png");
}

void add_likeness(MeasuredSide& base,
                  const KeptPictures& of_base,
                  MeasuredSide& now,
                  const KeptPictures& of_now,
                  const std::string& scene,
                  std::uint64_t seed) {
  const auto set = [&](MeasuredSide& side, std::optional<double> value) {
    for (MeasuredRun& run : side.runs) {
      if (run.scene != scene) continue;
      run.figures.erase(kPictureSsim.key);
      if (value && run.seed == seed) run.figures[kPictureSsim.key] = *value;
    }
  };
  const Image<glm::vec3>&a = of_base.shown, &b = of_now.shown;
  constexpr int kLeastSide = 11;  // of compare_images()
  const auto is_large = [](const auto& of) { return std::min(of.width, of.height) >= kLeastSide; };
  const bool both = is_large(a) && is_large(b);
  const bool alike = both && a.width == b.width && a.height == b.height;
  set(base, both ? std::optional(1.0) : std::nullopt);
  set(now, alike ? std::optional(compare_images(a, b).ssim) : std::nullopt);
}

}  // namespace wobblebench::bench
