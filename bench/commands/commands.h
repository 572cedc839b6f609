// The commands of the command line, one file each. Each returns the exit code; mistakes of the user
// are thrown as UserError.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobblebench::bench {

struct CommandArguments {
  std::filesystem::path scene;        ///< TOML file; empty: the defaults
  std::vector<std::string> settings;  ///< --set section.key=value
  std::filesystem::path out = "out";
  std::string board = "sim";
  bool json = false;                 ///< print report.json on stdout instead of a summary
  bool full = false;                 ///< tables: the paper's sizes
  int repeats = 3;                   ///< tables, trade
  std::vector<std::string> studies;  ///< validate: which; none: all
  std::string figure_path;           ///< validate: before the figures' names in the page's links
};

int run_command(const CommandArguments& arguments);
int phantom_command(const CommandArguments& arguments);
int tables_command(const CommandArguments& arguments);
int validate_command(const CommandArguments& arguments);
int trade_command(const CommandArguments& arguments);

}  // namespace wobblebench::bench
