#include "bench/cli/common_options.h"

#include <CLI/CLI.hpp>

#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

/// An unset variable of a script gives an empty argument, which does not mean the defaults.
std::string refuse_empty(const std::string& path) {
  return path.empty() ? "is empty; must be a TOML file" : "";
}

}  // namespace

CLI::App& add_subcommand(CLI::App& app, const std::string& name, const std::string& description) {
  return *app.add_subcommand(name, description);
}

void add_path(CLI::App& command,
              const std::string& name,
              std::filesystem::path& path,
              const std::string& help) {
  command.add_option(name, path, help);
}

void add_required_path(CLI::App& command,
                       const std::string& name,
                       std::filesystem::path& path,
                       const std::string& help) {
  command.add_option(name, path, help)->required();
}

void add_text(CLI::App& command,
              const std::string& name,
              std::string& text,
              const std::string& help) {
  command.add_option(name, text, help);
}

void add_list(CLI::App& command,
              const std::string& name,
              std::vector<std::string>& values,
              const std::string& help) {
  CLI::Option* option = command.add_option(name, values, help)->allow_extra_args(false);
  if (!values.empty()) option->capture_default_str();
}

void add_flag(CLI::App& command, const std::string& name, bool& flag, const std::string& help) {
  command.add_flag(name, flag, help);
}

void add_seed(CLI::App& command,
              const std::string& name,
              std::uint64_t& seed,
              const std::string& help) {
  command.add_option(name, seed, help)->capture_default_str();
}

void add_integer(CLI::App& command,
                 const std::string& name,
                 int& value,
                 const std::string& help,
                 int min,
                 int max) {
  command.add_option(name, value, help)->check(CLI::Range(min, max))->capture_default_str();
}

void add_scene_options(CLI::App& command, SceneArguments& scene) {
  command.add_option("SCENE", scene.file, "TOML file that names what differs from the defaults")
      ->check(refuse_empty);
  add_list(command, "--set", scene.settings, "Override one option: section.key=value (repeatable)");
}

void add_cache_options(CLI::App& command, CacheArguments& cache) {
  add_flag(command, "--no-cache", cache.off, "Make phantom and tissue map anew, and keep neither");
  add_integer(command,
              "--cache-mb",
              cache.megabytes,
              "Most that $XDG_CACHE_HOME/wobblebench may hold, in 10^6 bytes",
              0,
              1000000);
}

void add_output_options(CLI::App& command, OutputArguments& output) {
  command.add_option("--out", output.folder, "Folder for the results")->capture_default_str();
  add_flag(command, "--json", output.json, "Print report.json on stdout");
}

void add_board_option(CLI::App& command, std::string& board) {
  command
      .add_option("--board",
                  board,
                  "Where sticks come from: sim, file=RECORDING or xdma=DEVICE, then ,key=value …")
      ->capture_default_str();
}

void add_gl_option(CLI::App& command, std::string& backend) {
  std::vector<std::string> names = render::context_backends();
  names.insert(names.begin(), "auto");
  command.add_option("--gl", backend, "Where OpenGL comes from; auto: the first that is here")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
}

void add_repeats_option(CLI::App& command, int& repeats) {
  add_integer(command, "--repeats", repeats, "Counted runs of each setting", 1, 100);
}

}  // namespace wobblebench::bench
