// The command line. Exit codes: 0 done, 1 a check failed or the machine could not do it, 2 bad
// input.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/standard_descriptors.h"
#include "base/user_error.h"
#include "bench/cli/commands.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {

namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

/// In the order of --help.
std::vector<Command> add_commands(CLI::App& app) {
  return {add_run_command(app),
          add_record_command(app),
          add_inspect_command(app),
          add_conformance_command(app),
          add_rehearse_command(app),
          add_board_command(app),
          add_stand_in_command(app),
          add_phantom_command(app),
          add_tables_command(app),
          add_modes_command(app),
          add_validate_command(app),
          add_trade_command(app)};
}

int run_program(int argc, char** argv) {
  CLI::App app{"wobblebench: a test bench for 4D ultrasound surface rendering"};
  app.require_subcommand(1);
  const std::vector<Command> commands = add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw UserError(std::string(error.what()) + " (wobblebench --help lists commands and options)");
  }
  for (const Command& command : commands) {
    if (*command.subcommand) return command.run();
  }
  throw std::logic_error("the command line names no command");
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
    wobblebench::occupy_standard_descriptors();
    return run_program(argc, argv);
  } catch (const wobblebench::UserError& error) {
    return report_error(error.what(), kBadInput);
  } catch (const wobblebench::InvalidOption& error) {
    // Found only while simulating: a scan too large for its rung.
    return report_error(std::string("simulation.") + error.what(), kBadInput);
  } catch (const wobblebench::phantoms::InvalidPhantom& error) {
    return report_error(std::string("phantom.") + error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return report_error("out of memory", kFailed);
  } catch (const std::exception& error) {
    return report_error(error.what(), kFailed);
  }
}
