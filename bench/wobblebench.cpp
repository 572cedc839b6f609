// The command line. Exit codes: 0 done, 1 a check that was asked for failed or the machine could
// not do it, 2 bad input.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "bench/commands/commands.h"
#include "bench/user_error.h"
#include "hw/options.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

void add_output(CLI::App& command, CommandArguments& arguments) {
  command.add_option("--out", arguments.out, "Folder for the results")->capture_default_str();
  command.add_flag("--json", arguments.json, "Print report.json on stdout");
}

void add_repeats(CLI::App& command, CommandArguments& arguments) {
  command.add_option("--repeats", arguments.repeats, "Counted runs of each setting")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
}

void add_common(CLI::App& command, CommandArguments& arguments) {
  command
      .add_option("SCENE", arguments.scene, "TOML file that names what differs from the defaults")
      ->check([](const std::string& path) {
        // An unset variable of a script, say: not a wish for the defaults.
        return std::string(path.empty() ? "is empty; must be a TOML file" : "");
      });
  command
      .add_option(
          "--set", arguments.settings, "Override one option: section.key=value (repeatable)")
      ->allow_extra_args(false);
  add_output(command, arguments);
}

int dispatch(int argc, char** argv) {
  CLI::App app{"wobblebench: a test bench for 4D ultrasound surface rendering"};
  app.require_subcommand(1);
  CommandArguments arguments;

  auto* run =
      app.add_subcommand("run", "Acquire, render, compare with the truth: images, depth, report");
  add_common(*run, arguments);
  run->add_option("--board", arguments.board, "Where sticks come from: sim")->capture_default_str();

  auto* phantom = app.add_subcommand("phantom", "Build a phantom and write it as phantom.vdb");
  add_common(*phantom, arguments);

  auto* tables = app.add_subcommand("tables", "Tables I to IV beside the paper's");
  add_common(*tables, arguments);
  tables->add_flag("--full", arguments.full, "The paper's sizes; otherwise half of them a side");
  add_repeats(*tables, arguments);

  auto* validate = app.add_subcommand(
      "validate", "The simulated probe's physics against closed forms and publications");
  add_output(*validate, arguments);
  validate->add_option("--study", arguments.studies, "One study instead of all (repeatable)")
      ->allow_extra_args(false);
  validate->add_option("--figure-path",
                       arguments.figure_path,
                       "What stands before the figures' file names in validation.md's links");

  auto* trade = app.add_subcommand("trade", "Speed against accuracy over the simulator's rungs");
  add_common(*trade, arguments);
  add_repeats(*trade, arguments);

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw UserError(std::string(error.what()) + " (wobblebench --help lists commands and options)");
  }
  if (*run) return run_command(arguments);
  if (*phantom) return phantom_command(arguments);
  if (*validate) return validate_command(arguments);
  if (*trade) return trade_command(arguments);
  return tables_command(arguments);
}

int report_error(const std::string& what, int code) {
  std::fprintf(stderr, "wobblebench: %s\n", one_line(what).c_str());
  return code;
}

}  // namespace

}  // namespace wobblebench::bench

int main(int argc, char** argv) {
  using namespace wobblebench::bench;
  try {
    return dispatch(argc, argv);
  } catch (const UserError& error) {
    return report_error(error.what(), kBadInput);
  } catch (const wobblebench::hw::InvalidOption& error) {
    // What the scene's own check cannot know: a scan too large for its rung.
    return report_error(std::string("simulation.") + error.what(), kBadInput);
  } catch (const wobblebench::phantoms::InvalidPhantom& error) {
    return report_error(std::string("phantom.") + error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return report_error("out of memory", kFailed);
  } catch (const std::exception& error) {
    return report_error(error.what(), kFailed);
  }
}
