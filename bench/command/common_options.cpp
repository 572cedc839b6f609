#include "bench/command/common_options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <functional>
#include <limits>

#include "base/user_error.h"

#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

CLI::Option& add_value(CLI::App& command,
                       const std::string& name,
                       const std::string& type,
                       const std::string& help,
                       const std::function<void(const std::string&)>& take) {
  return *command.add_option_function<std::string>(name, take, help)->type_name(type);
}

UserError refusal(const std::string& name, const std::string& value, const std::string& allowed) {
  return UserError(name + " = " + value + ": " + allowed);
}

/// Decimal digits alone, behind a minus sign where `Number` has one.
template <class Number>
Number whole_number(const std::string& name, const std::string& text, Number min, Number max) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || number < min || number > max) {
    throw refusal(
        name,
        text,
        "must be a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return number;
}

CLI::Option& add_path_option(CLI::App& command,
                             const std::string& name,
                             const std::string& type,
                             std::filesystem::path& path,
                             const std::string& help) {
  return add_value(command, name, type, help, [name, &path](const std::string& text) {
    if (text.empty()) throw UserError(name + ": is empty; must be a path");
    path = text;
  });
}

}  // namespace

CLI::App& add_subcommand(CLI::App& app, const std::string& name, const std::string& description) {
  return *app.add_subcommand(name, description);
}

void add_path(CLI::App& command,
              const std::string& name,
              std::filesystem::path& path,
              const std::string& help) {
  add_path_option(command, name, "FILE", path, help);
}

void add_required_path(CLI::App& command,
                       const std::string& name,
                       std::filesystem::path& path,
                       const std::string& help) {
  add_path_option(command, name, "", path, help).required();
}

void add_text(CLI::App& command,
              const std::string& name,
              std::string& text,
              const std::string& help) {
  add_value(command, name, "TEXT", help, [&text](const std::string& value) { text = value; });
}

void add_list(CLI::App& command,
              const std::string& name,
              std::vector<std::string>& values,
              const std::string& help) {
  const auto take = [&values](const CLI::results_t& given) {
    values = given;
    return true;
  };
  CLI::Option* option = command.add_option(name, take, help);
  option->type_name("TEXT")
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->allow_extra_args(false);
  if (!values.empty()) option->default_str("[" + CLI::detail::join(values) + "]");
}

void add_flag(CLI::App& command, const std::string& name, bool& flag, const std::string& help) {
  command.add_flag(name, flag, help)->disable_flag_override();
}

void add_seed(CLI::App& command,
              const std::string& name,
              std::uint64_t& seed,
              const std::string& help) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
  add_value(command, name, "INT", help, [name, &seed](const std::string& text) {
    seed = whole_number<std::uint64_t>(name, text, 0, kMost);
  }).default_str(std::to_string(seed));
}

CLI::Option& add_integer(CLI::App& command,
                         const std::string& name,
                         int& value,
                         const std::string& help,
                         int min,
                         int max) {
  const std::string type = "INT in [" + std::to_string(min) + ", " + std::to_string(max) + "]";
  return *add_value(command, name, type, help, [=, &value](const std::string& text) {
            value = whole_number<int>(name, text, min, max);
          }).default_str(std::to_string(value));
}

void add_optional_integer(CLI::App& command,
                          const std::string& name,
                          int& value,
                          const std::string& help,
                          int min,
                          int max) {
  add_integer(command, name, value, help, min, max).default_str("");
}

void add_scene_options(CLI::App& command, SceneArguments& scene) {
  add_path_option(
      command, "SCENE", "", scene.file, "TOML file that names what differs from the defaults");
  add_list(command, "--set", scene.settings, "Override one option: section.key=value (repeatable)");
}

void add_plan_options(CLI::App& command, SceneArguments& plan) {
  add_path_option(
      command,
      "PLAN",
      "",
      plan.file,
      "TOML file with [scenes.NAME] and [settings.NAME], or a scene; none: the default");
  add_list(command,
           "--set",
           plan.settings,
           "Override one option of all scenes: section.key=value (repeatable)");
}

void add_cache_options(CLI::App& command, CacheArguments& cache) {
  add_flag(
      command, "--no-cache", cache.off, "Make phantom, tissue map and echoes anew, and keep none");
  add_integer(command,
              "--cache-mb",
              cache.megabytes,
              "Most that $XDG_CACHE_HOME/wobblebench may hold, in 10^6 bytes",
              0,
              1000000)
      .excludes("--no-cache");
}

void add_output_options(CLI::App& command, OutputArguments& output) {
  add_path_option(command, "--out", "FOLDER", output.folder, "Folder for the results")
      .default_str(output.folder.string());
  add_flag(command, "--json", output.json, "Print report.json on stdout");
  add_flag(command, "--open", output.open, "Open report.html in the desktop's browser (xdg-open)");
}

void add_junit_option(CLI::App& command, OutputArguments& output) {
  add_path(command,
           "--junit",
           output.junit,
           "Write the checks as JUnit's XML, NAME.xml, for continuous integration");
}

void add_board_option(CLI::App& command, std::string& board) {
  add_value(command,
            "--board",
            "TEXT",
            "Where sticks come from: sim, file=RECORDING, xdma=DEVICE or igtl=HOST:PORT, then "
            ",key=value …",
            [&board](const std::string& text) { board = text; })
      .default_str(board);
}

void add_choice(CLI::App& command,
                const std::string& name,
                std::string& value,
                const std::vector<std::string>& names,
                const std::string& help) {
  add_value(command, name, "TEXT", help, [&value](const std::string& text) { value = text; })
      .check(CLI::IsMember(names))
      ->default_str(value);
}

void add_gl_option(CLI::App& command, std::string& backend) {
  std::vector<std::string> names = render::context_backends();
  names.insert(names.begin(), "auto");
  add_choice(
      command, "--gl", backend, names, "Where OpenGL comes from; auto: the first that is here");
}

void add_renderer_option(CLI::App& command, std::vector<std::string>& renderers) {
  add_list(command,
           "--renderer",
           renderers,
           "NAME=COMMAND: another program that finds the surface where render.program = NAME "
           "(docs/score.md; repeatable)");
}

void add_repeats_option(CLI::App& command, int& repeats) {
  add_integer(command, "--repeats", repeats, "Counted runs of each setting", 1, 100);
}

std::string idle_options_text(const CLI::App& command,
                              const std::vector<ConditionalOption>& options) {
  std::string text;
  for (const ConditionalOption& option : options) {
    if (option.acts || command.get_option(option.name)->count() == 0) continue;
    text += (text.empty() ? "without effect: " : ", ") + option.name + " (acts with " +
            option.acts_with + ")";
  }
  return text;
}

}  // namespace wobblebench::bench
