// What every program of ours does with its command line: one place for refusals, exit codes, the
// version and the standard streams.
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace wobblebench::bench {

/// A command of a program, or all of it. Parsing fills in its options; `run` then executes it and
/// returns the exit code. Errors in the user's input are thrown as UserError.
struct Command {
  CLI::App* parser;
  std::function<int()> run;
};

/// Exit codes: kFailed also where a check failed.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kBadInput = 2;

struct Program {
  std::string name;
  std::string description;
  /// Adds the program's commands with their options to the parser. It is called once.
  std::function<std::vector<Command>(CLI::App&)> add_commands;
};

/// Parses the command line and runs its command. Returns the exit code: that of the command;
/// kBadInput for a line that cannot be parsed, kFailed for stdout that cannot be written, that of
/// refusal_of() for an exception, all with one line "NAME: what is wrong" on stderr. Call it
/// first in main: standard descriptors that the caller closed are taken, so that no file of ours
/// becomes one of them.
int run_program(const Program& program, int argc, char** argv);

/// What a user reads of an exception, and the exit code: each type has a line of its own.
struct Refusal {
  std::string line;
  int code = kFailed;
};
Refusal refusal_of(const std::exception_ptr& exception);

/// For std::set_terminate(): the line of an exception that nothing caught, and its exit code.
[[noreturn]] void end_with_a_line();

/// The program's command line as words of a shell, by run_program().
const std::string& command_line();

/// From now on the first SIGINT, SIGTERM or SIGHUP asks the command to stop, and a second one ends
/// the program. A signal that was ignored stays so.
void stop_in_order();
bool stop_requested();

}  // namespace wobblebench::bench
