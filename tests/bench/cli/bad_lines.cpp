#include "tests/bench/cli/bad_lines.h"

#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>

#include "bench/exchange/files/npy.h"
#include "tests/bench/cli/wrong_values.h"
#include "tests/bench/studies/tables/recording.h"
#include "tests/support/expect.h"

namespace wobblebench::bench::testing {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Random choices that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  /// In [0, count).
  std::size_t below(std::size_t count) { return random_() % count; }
  bool chance(double probability) {
    return static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
  }
  template <class T>
  const T& one_of(const std::vector<T>& choices) {
    return choices.at(below(choices.size()));
  }
  std::string letters(std::size_t count) {
    std::string text;
    while (text.size() < count) text += static_cast<char>('a' + below(26));
    return text;
  }

 private:
  std::mt19937_64 random_;
};

/// What can be given where a file is read, and is none.
Words no_files() {
  Words paths = words_of("none folder loop whole.wbst/under none/\xff /proc/self/none");
  paths.insert(paths.end(), {"", std::string(300, 'a'), "none\nnone"});
  return paths;
}

Words no_scenes() {
  return words_of(
      "fifo /dev/null whole.wbst wrong_key.toml wrong_type.toml wrong_range.toml "
      "wrong_syntax.toml wrong_section.toml wrong_twice.toml wrong_bytes.toml");
}

Words no_output_folders() {
  Words paths =
      words_of("whole.wbst whole.wbst/out fifo fifo/out loop /proc/out /dev/null /dev/null/out");
  paths.insert(paths.end(), {"", std::string(300, 'a')});
  return paths;
}

Words no_numbers() {
  Words texts =
      words_of("+5 1.5 1e3 0x10 nan inf -inf five true 5,6 \xff 1'000 --5 184467440737095516160");
  texts.insert(texts.end(), {"", " 5", "5 ", "5\n6"});
  return texts;
}

bool is_flag(const CLI::Option& option) {
  return option.get_expected_max() == 0;
}
bool is_list(const CLI::Option& option) {
  return option.get_items_expected_max() > 1;
}
bool is_number(const CLI::Option& option) {
  return option.get_type_name().starts_with("INT");
}

/// The range of a number, of its type's name: "INT in [1, 100]".
std::pair<long, long> range_of(const CLI::Option& option) {
  std::istringstream text(option.get_type_name());
  long min = 0, max = 0;
  char comma = 0;
  text.ignore(100, '[') >> min >> comma >> max;
  return {min, max};
}

std::string name_of(const CLI::Option& option) {
  return option.get_positional() ? option.get_name() : "--" + option.get_lnames().front();
}

/// A value that is refused for nothing; none where the line had to be another.
std::optional<std::string> right_value(const CLI::Option& option) {
  static const std::map<std::string, std::string> values = {{"--board", "file=whole.wbst"},
                                                            {"RECORDING", "whole.wbst"},
                                                            {"FOLDER", "folder"},
                                                            {"--gl", "osmesa"},
                                                            {"--set", "phantom.name=sphere"},
                                                            {"--study", "shear"},
                                                            {"--shard", "1/2"},
                                                            {"PLAN", "plan.toml"},
                                                            {"FILE", "right.npy"},
                                                            {"--scene", "right.toml"},
                                                            {"BASE", "this"},
                                                            {"NEW", "this"},
                                                            {"FROM", "right.toml"},
                                                            {"--to", "right.npz"},
                                                            {"--unit", "mm"},
                                                            {"--limit", "p95_mm<=2"},
                                                            {"--kind", "ray"}};
  static const std::set<std::string> unfit = {"--no-cache", "--gpu", "--requests", "--iq"};
  if (unfit.contains(name_of(option))) return {};
  if (is_flag(option)) return "";
  if (is_number(option)) return std::to_string(std::max(1L, range_of(option).first));
  const auto found = values.find(name_of(option));
  return found == values.end() ? std::nullopt : std::optional(found->second);
}

/// What a refusal of the value holds: the name of the option; of a word without one the word, if it
/// is printed as it is.
std::string words_about(const CLI::Option& option, const std::string& value = "") {
  if (!option.get_positional() || value.empty()) return name_of(option);
  const bool printable =
      std::all_of(value.begin(), value.end(), [](char c) { return c > ' ' && c <= '~'; });
  return printable ? value : "";
}

}  // namespace

void make_named_files(const fs::path& folder) {
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name) << text;
  };
  write("whole.wbst", recording_of(recorded_plan()));
  write("right.toml", "[phantom]\nname = \"sphere\"\n");
  write("right.npy",
        npy_bytes(std::array<std::uint64_t, 2>{512, 512}, std::vector<float>(512 * 512)));
  write("plan.toml", "[scenes.ball]\n[axes]\n\"render.ray_casting.steps\" = [64, 128]\n");
  write("wrong_key.toml", "[acquisition]\ndeptn_mm = 100\n");
  write("wrong_type.toml", "[acquisition]\nsticks_per_frame = \"many\"\n");
  write("wrong_range.toml", "[acquisition]\ndepth_mm = nan\n");
  write("wrong_syntax.toml", "[acquisition\n");
  write("wrong_section.toml", "[acquisitions]\n\"\" = 1\n");
  write("wrong_twice.toml", "[phantom]\nname = \"sphere\"\nname = \"sphere\"\n");
  write("wrong_bytes.toml", "[phantom]\nname = \"\xff\"\n");
  fs::create_directory(folder / "folder");
  fs::create_symlink("loop", folder / "loop");
  if (::mkfifo((folder / "fifo").c_str(), 0600) != 0) throw std::runtime_error("mkfifo");
}

class BadLines::Impl {
 public:
  Impl(const Program& program, bool takes_sim, std::uint64_t seed)
      : app_(program.description, program.name),
        commands_(program.add_commands(app_)),
        wrong_values_(
            {{"--set", wrong_settings(), "wrong"},
             {"--board",
              takes_sim ? wrong_boards() : Words{"sim", "nonsense", "", "file=none.wbst"},
              "wrong"},
             {"--gl", {"glide", "", "OSMESA", "\xff", "osmesa,egl", "vulkan\n"}, "unknown"},
             {"--study", {"none", "", "Speckle", "speckle,density", "\xff"}, "unknown"},
             {"--out", no_output_folders(), "no folder"},
             {"SCENE", no_files(), "no file"},
             {"SCENE", no_scenes(), "no scene"},
             {"RECORDING", no_files(), "no recording"},
             {"--salvage", {"", "folder", "whole.wbst", "whole.wbst/new"}, "no place"},
             {"FOLDER", {"none", "whole.wbst", "", "fifo", "loop"}, "no folder"}}),
        dice_(seed) {}

  BadLine next() {
    for (;;) {
      command_ = dice_.one_of(commands_).parser;
      const Way way = dice_.chance(0.6) ? &Impl::wrong_value : dice_.one_of(ways_);
      if (std::optional<BadLine> line = (this->*way)()) return *line;
    }
  }

 private:
  using Way = std::optional<BadLine> (Impl::*)();

  bool has_subcommands() const { return !app_.get_subcommands({}).empty(); }

  /// Options of the command but help, for which `wanted` holds.
  std::vector<const CLI::Option*> options(const std::function<bool(const CLI::Option&)>& wanted) {
    std::vector<const CLI::Option*> found;
    for (const CLI::Option* option : command_->get_options()) {
      const bool answers =
          option == command_->get_help_ptr() || option == command_->get_version_ptr();
      if (!answers && wanted(*option)) found.push_back(option);
    }
    return found;
  }
  const CLI::Option* any_option(const std::function<bool(const CLI::Option&)>& wanted) {
    const auto found = options(wanted);
    return found.empty() ? nullptr : dice_.one_of(found);
  }
  const CLI::Option* option_named(const std::string& name) {
    return any_option([&](const CLI::Option& one) { return name_of(one) == name; });
  }

  Words given(const CLI::Option& option, const std::string& value) {
    const std::string name = name_of(option);
    if (option.get_positional()) return {value};
    // CLI11 takes "--name=" without a value as "--name".
    if (!value.empty() && dice_.chance(0.3)) return {name + "=" + value};
    return {name, value};
  }

  /// A line of the command with `wrong` in it; `about`: the option that is wrong, which is not
  /// given rightly too. Some other options are given, and those that are required.
  BadLine line_with(const Words& wrong,
                    const std::string& why,
                    const CLI::Option* about = nullptr,
                    bool at_end = false) {
    static const std::set<std::string> needed = {"--limit", "--to"};  // of tune, score; of export
    std::vector<Words> parts;
    std::size_t positionals = 0;
    for (const CLI::Option* option : options([](const CLI::Option&) { return true; })) {
      if (option == about) continue;
      const bool wanted = option->get_required() || needed.contains(name_of(*option)) ||
                          (!option->get_positional() && name_of(*option) != "--full" &&
                           name_of(*option) != "--salvage" && dice_.chance(0.2));
      if (!wanted) continue;
      const auto value = right_value(*option);
      if (!value) {
        if (option->get_required()) throw std::logic_error(name_of(*option) + ": no right value");
        continue;
      }
      const Words words = is_flag(*option) ? Words{name_of(*option)} : given(*option, *value);
      const bool first = option->get_positional();
      parts.insert(first ? parts.begin() + static_cast<long>(positionals) : parts.end(), words);
      if (first) ++positionals;
    }
    // Positionals keep their order.
    const std::size_t first =
        about && about->get_positional() ? positionals_before(*about) : positionals;
    const std::size_t place = at_end ? parts.size() : first + dice_.below(parts.size() - first + 1);
    const bool keep_place = about && about->get_positional();
    parts.insert(parts.begin() + static_cast<long>(keep_place ? first : place), wrong);
    BadLine line{{}, why, about ? words_about(*about) : ""};
    if (has_subcommands()) line.words.push_back(command_->get_name());
    for (const Words& part : parts) line.words.insert(line.words.end(), part.begin(), part.end());
    return line;
  }
  std::size_t positionals_before(const CLI::Option& option) {
    const auto required =
        options([](const CLI::Option& one) { return one.get_positional() && one.get_required(); });
    const auto at = std::find(required.begin(), required.end(), &option);
    return static_cast<std::size_t>(at - required.begin());
  }

  std::optional<BadLine> value_of(const std::string& name, const Words& values, const char* why) {
    const CLI::Option* option = option_named(name);
    if (!option) return {};
    const std::string& value = dice_.one_of(values);
    BadLine line = line_with(given(*option, value), name + ": " + why, option);
    line.says = words_about(*option, value);
    // Of a setting a plan's refusal may name the scene of the plan; a data set has another plan.
    if (name == "--set" && option_named("PLAN")) line.says = "";
    if (command_->get_name() == "dataset") line.says = "";
    return line;
  }

  std::optional<BadLine> unknown_command() {
    if (!has_subcommands()) return {};
    const Words words = {dice_.letters(1 + dice_.below(12)) + "x", "", "Run", "\xff", "-", "run "};
    BadLine line{{dice_.one_of(words)}, "unknown command", ""};
    if (dice_.chance(0.5)) line.words.push_back("--json");
    return line;
  }
  std::optional<BadLine> nothing_at_all() { return BadLine{{}, "nothing", ""}; }
  std::optional<BadLine> unknown_option() {
    const Words words = {"--" + dice_.letters(3 + dice_.below(20)) + "-x",
                         "-z",
                         "--\xff",
                         "--json-",
                         "--out-of",
                         "--=5"};
    const std::string& word = dice_.one_of(words);
    BadLine line = line_with({word}, "unknown option");
    if (word != "--\xff") line.says = word;
    return line;
  }
  std::optional<BadLine> missing_value() {
    const auto* option =
        any_option([](const CLI::Option& one) { return !is_flag(one) && !one.get_positional(); });
    if (!option) return {};
    return line_with({name_of(*option)}, "no value of " + name_of(*option), option, true);
  }
  std::optional<BadLine> repeated_option() {
    const auto* option = any_option([](const CLI::Option& one) {
      return !is_flag(one) && !is_list(one) && !one.get_positional() && right_value(one);
    });
    if (!option) return {};
    Words twice = given(*option, *right_value(*option));
    const Words again = given(*option, *right_value(*option));
    twice.insert(twice.end(), again.begin(), again.end());
    return line_with(twice, name_of(*option) + " twice", option);
  }
  std::optional<BadLine> flag_with_value() {
    const auto* option = any_option(is_flag);
    if (!option) return {};
    const std::string value = dice_.one_of(Words{"7", "maybe", "\xff", "-1", "0"});
    return line_with({name_of(*option) + "=" + value}, "a flag with a value", option);
  }
  std::optional<BadLine> wrong_number() {
    const auto* option = any_option(is_number);
    if (!option) return {};
    Words values = no_numbers();
    const auto [min, max] = range_of(*option);
    values.push_back(std::to_string(min - 1));
    values.push_back(max > 0 ? std::to_string(max + 1) : "18446744073709551616");
    const std::string& value = dice_.one_of(values);
    BadLine line = line_with(given(*option, value), "wrong " + name_of(*option), option);
    if (value.starts_with("--")) line.says = value;  // an option that is unknown
    return line;
  }
  std::optional<BadLine> wrong_value() {
    const WrongValues& wrong =
        dice_.chance(0.3) ? wrong_values_.front() : dice_.one_of(wrong_values_);
    return value_of(wrong.option, wrong.values, wrong.why);
  }
  std::optional<BadLine> too_many_words() {
    const auto positional =
        options([](const CLI::Option& one) { return one.get_positional(); }).size();
    Words words(positional + 1, "wrong_key.toml");
    return line_with(words, "too many words");
  }
  std::optional<BadLine> missing_requirement() {
    const auto* option = any_option([](const CLI::Option& one) { return one.get_required(); });
    if (!option) return {};
    return line_with({}, "no " + name_of(*option), option);
  }
  std::optional<BadLine> options_that_exclude() {
    if (!option_named("--full")) return {};
    return line_with(
        {"--full", "--divisor", "2"}, "--full and --divisor", option_named("--divisor"));
  }

  inline static const std::vector<Way> ways_ = {&Impl::unknown_command,
                                                &Impl::nothing_at_all,
                                                &Impl::unknown_option,
                                                &Impl::missing_value,
                                                &Impl::repeated_option,
                                                &Impl::flag_with_value,
                                                &Impl::wrong_number,
                                                &Impl::too_many_words,
                                                &Impl::missing_requirement,
                                                &Impl::options_that_exclude};

  struct WrongValues {
    const char* option;
    Words values;
    const char* why;
  };

  CLI::App app_;
  std::vector<Command> commands_;
  std::vector<WrongValues> wrong_values_;
  Dice dice_;
  CLI::App* command_ = nullptr;
};

BadLines::BadLines(const Program& program, bool takes_sim, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(program, takes_sim, seed)) {}
BadLines::~BadLines() = default;

BadLine BadLines::next() {
  return impl_->next();
}

}  // namespace wobblebench::bench::testing
