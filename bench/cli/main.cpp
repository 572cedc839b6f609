// The command line. Exit codes: 0 done, 1 a check that was asked for failed or the machine could
// not do it, 2 bad input.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "base/options.h"
#include "bench/cli/commands.h"
#include "bench/cli/user_error.h"
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

void add_board(CLI::App& command, CommandArguments& arguments) {
  command
      .add_option("--board",
                  arguments.board,
                  "Where sticks come from: sim, file=RECORDING or xdma=DEVICE, then ,key=value …")
      ->capture_default_str();
}

int dispatch(int argc, char** argv) {
  CLI::App app{"wobblebench: a test bench for 4D ultrasound surface rendering"};
  app.require_subcommand(1);
  CommandArguments arguments;

  auto* run =
      app.add_subcommand("run", "Acquire, render, compare with the truth: images, depth, report");
  add_common(*run, arguments);
  add_board(*run, arguments);
  add_gl_option(*run, arguments.gl);

  auto* record = app.add_subcommand("record", "Write what a board sends to recording.wbst");
  add_common(*record, arguments);
  add_board(*record, arguments);
  record
      ->add_option("--volumes",
                   arguments.volumes,
                   "Stop after so many; 0: at the end of the stream, or at Ctrl-C")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();

  auto* inspect =
      app.add_subcommand("inspect", "What a recording holds, and what is wrong with it");
  inspect->add_option("RECORDING", arguments.recording, "File that `record` wrote")->required();
  inspect->add_option("--salvage", arguments.salvage, "Copy what is undamaged to this new file");
  inspect->add_flag("--json", arguments.json, "Print the report on stdout");

  auto* conformance = app.add_subcommand("conformance", "Check the board's contract on any board");
  add_common(*conformance, arguments);
  conformance
      ->add_option("--board",
                   arguments.boards,
                   "As for run, or xdma=stand-in, xdma=fifo-stand-in (repeatable)")
      ->allow_extra_args(false)
      ->capture_default_str();
  conformance->add_flag(
      "--each-fault", arguments.each_fault, "On the board with each kind of fault, too");
  conformance->add_flag(
      "--broken", arguments.broken, "Show with broken boards that each check can fail");

  auto* rehearse = app.add_subcommand(
      "rehearse", "Play probe, link, board and volumes under seeded faults on virtual time");
  add_output(*rehearse, arguments);
  rehearse->add_option("--seeds", arguments.seeds, "How many")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  rehearse->add_option("--first-seed", arguments.first_seed, "The first; the others follow")
      ->capture_default_str();
  rehearse->add_flag("--trace", arguments.trace, "Every event on stderr");

  auto* board = app.add_subcommand("board", "What the board costs: throughput, and cancelling");
  add_output(*board, arguments);
  add_repeats(*board, arguments);

  auto* stand_in = app.add_subcommand(
      "stand-in", "A node that behaves like the card's driver, until Ctrl-C (needs FUSE)");
  stand_in->add_option("FOLDER", arguments.folder, "Where xdma0_c2h_0 appears")->required();
  stand_in->add_option("SCENE", arguments.scene, "TOML file, for --board sim");
  stand_in->add_option("--set", arguments.settings, "Override one option: section.key=value")
      ->allow_extra_args(false);
  add_board(*stand_in, arguments);

  auto* phantom = app.add_subcommand("phantom", "Build a phantom and write it as phantom.vdb");
  add_common(*phantom, arguments);

  auto* tables = app.add_subcommand("tables", "Tables I to IV beside the paper's");
  add_common(*tables, arguments);
  add_board(*tables, arguments);
  add_gl_option(*tables, arguments.gl);
  add_table_options(*tables, arguments.tables);

  auto* modes = app.add_subcommand(
      "modes", "Whether mode fast makes mode plain's picture, phantom by phantom");
  add_common(*modes, arguments);
  add_gl_option(*modes, arguments.gl);

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
  if (*record) return record_command(arguments);
  if (*inspect) return inspect_command(arguments);
  if (*conformance) return conformance_command(arguments);
  if (*rehearse) return rehearse_command(arguments);
  if (*board) return board_command(arguments);
  if (*stand_in) return stand_in_command(arguments);
  if (*phantom) return phantom_command(arguments);
  if (*modes) return modes_command(arguments);
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
  } catch (const wobblebench::InvalidOption& error) {
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
