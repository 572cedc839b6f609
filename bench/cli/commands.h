// The commands of the command line, one file each. Each returns the exit code; mistakes of the user
// are thrown as UserError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/tables/arguments.h"

namespace wobblebench::bench {

struct CommandArguments {
  std::filesystem::path scene;        ///< TOML file; empty: the defaults
  std::vector<std::string> settings;  ///< --set section.key=value
  std::filesystem::path out = "out";
  std::string board = "sim";
  std::vector<std::string> boards = {"sim"};  ///< conformance
  std::filesystem::path folder;               ///< stand-in: where it is mounted
  int volumes = 0;                  ///< record: stop after so many; 0: at the end of the stream
  std::filesystem::path recording;  ///< inspect
  std::filesystem::path salvage;    ///< inspect: where to copy what is sound; empty: nowhere
  bool json = false;                ///< print report.json on stdout instead of a summary
  bool each_fault = false;          ///< conformance: on the board with each fault, too
  bool broken = false;              ///< conformance: show that each check can fail
  int seeds = 1000;                 ///< rehearse
  std::uint64_t first_seed = 1;     ///< rehearse
  bool trace = false;               ///< rehearse: every event on stderr
  std::string gl = "osmesa";        ///< run, tables, modes: where OpenGL comes from
  TableArguments tables;
  int repeats = 3;                   ///< trade, board
  std::vector<std::string> studies;  ///< validate: which; none: all
  std::string figure_path;           ///< validate: before the figures' names in the page's links
};

int run_command(const CommandArguments& arguments);
int phantom_command(const CommandArguments& arguments);
int record_command(const CommandArguments& arguments);
int inspect_command(const CommandArguments& arguments);
int conformance_command(const CommandArguments& arguments);
int rehearse_command(const CommandArguments& arguments);
int stand_in_command(const CommandArguments& arguments);
int board_command(const CommandArguments& arguments);
int tables_command(const CommandArguments& arguments);
int modes_command(const CommandArguments& arguments);
int validate_command(const CommandArguments& arguments);
int trade_command(const CommandArguments& arguments);

}  // namespace wobblebench::bench
