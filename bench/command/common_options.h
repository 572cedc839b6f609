// Options of commands: those that several commands take, with the same text everywhere, and one
// function for each type of option. CLI11's templates take seconds to compile in each file that
// calls them; they are instantiated in common_options.cpp alone, and for texts alone: CLI11 reads
// "-1" as an unsigned number, "010" as 8, "true" as 1 and "{}" as an empty list.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace wobblebench::bench {

struct SceneArguments {
  std::filesystem::path file;         ///< TOML; empty: the defaults
  std::vector<std::string> settings;  ///< section.key=value
};

struct OutputArguments {
  std::filesystem::path folder = "out";
  bool json = false;                 ///< print report.json on stdout instead of a summary
  bool open = false;                 ///< show report.html when it is written
  std::filesystem::path junit = {};  ///< a file for the checks; empty: none
};

/// Options of the folder that keeps phantoms and tissue maps between runs.
struct CacheArguments {
  bool off = false;
  int megabytes = 1000;
  int most_megabytes() const { return off ? 0 : megabytes; }
};

CLI::App& add_subcommand(CLI::App& app, const std::string& name, const std::string& description);

/// One option each, bound to the variable. Numbers show their default, lists too unless it is
/// empty; a list takes one value each time that the option is given. A path must not be empty: an
/// unset variable of a script does not mean the default. Numbers are decimal. Values that are not
/// allowed are thrown as UserError "NAME = VALUE: what is allowed" while the line is parsed.
void add_path(CLI::App& command,
              const std::string& name,
              std::filesystem::path& path,
              const std::string& help);
void add_required_path(CLI::App& command,
                       const std::string& name,
                       std::filesystem::path& path,
                       const std::string& help);
void add_text(CLI::App& command,
              const std::string& name,
              std::string& text,
              const std::string& help);
/// One of `names`.
void add_choice(CLI::App& command,
                const std::string& name,
                std::string& value,
                const std::vector<std::string>& names,
                const std::string& help);
void add_list(CLI::App& command,
              const std::string& name,
              std::vector<std::string>& values,
              const std::string& help);
void add_flag(CLI::App& command, const std::string& name, bool& flag, const std::string& help);
void add_seed(CLI::App& command,
              const std::string& name,
              std::uint64_t& seed,
              const std::string& help);
CLI::Option& add_integer(CLI::App& command,
                         const std::string& name,
                         int& value,
                         const std::string& help,
                         int min,
                         int max);

/// Without a default: `value` stays as it is unless the option is given.
void add_optional_integer(CLI::App& command,
                          const std::string& name,
                          int& value,
                          const std::string& help,
                          int min,
                          int max);

/// SCENE and --set.
void add_scene_options(CLI::App& command, SceneArguments& scene);
/// PLAN, a plan or a scene, and --set.
void add_plan_options(CLI::App& command, SceneArguments& plan);
/// --no-cache and --cache-mb.
void add_cache_options(CLI::App& command, CacheArguments& cache);
/// --out, --json and --open.
void add_output_options(CLI::App& command, OutputArguments& output);
/// The same after --no-cache and --cache-mb.
inline void add_output_options(CLI::App& command, OutputArguments& output, CacheArguments& cache) {
  add_cache_options(command, cache);
  add_output_options(command, output);
}
/// --junit, of commands that check.
void add_junit_option(CLI::App& command, OutputArguments& output);
void add_board_option(CLI::App& command, std::string& board);
/// --renderer, of commands that take renderers of other programs (define_renderers()).
void add_renderer_option(CLI::App& command, std::vector<std::string>& renderers);
void add_gl_option(CLI::App& command, std::string& backend);
void add_repeats_option(CLI::App& command, int& repeats);

/// An option of a command that acts under one condition.
struct ConditionalOption {
  std::string name;  ///< "--queue"
  bool acts = true;
  std::string acts_with;  ///< "--policy every"
};

/// "without effect: --queue (acts with --policy every), …" of those that stand on the command line
/// and do not act; empty: there are none.
std::string idle_options_text(const CLI::App& command,
                              const std::vector<ConditionalOption>& options);

}  // namespace wobblebench::bench
