#include "bench/command/program.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "base/file.h"
#include "base/near_name.h"
#include "base/options.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/command/machine_limits.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

void check_stdout() {
  std::cout.flush();
  if (std::cout.good()) return;
  // The reason may be that of an earlier write; the stream is lost, so one more shows it.
  std::cout.clear();
  errno = 0;
  std::cout << std::endl;
  const std::string reason = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  throw std::runtime_error("stdout cannot be written" + reason);
}

/// Whether the program has commands and `word` stands for one that it does not have.
std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  const bool known = std::find(names.begin(), names.end(), word) != names.end();
  if (names.empty() || known || word.starts_with("-")) return "";
  return word + ": no such command" + did_you_mean(word, names);
}

/// The first word that looks like an option that `command` does not have.
std::string unknown_option(const CLI::App& command, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (int i = 1; i < argc; ++i) {
    const std::string word = std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (!word.starts_with("--") || word == "--") continue;
    if (std::find(names.begin(), names.end(), word) != names.end()) continue;
    return word + ": no such option" + did_you_mean(word, names);
  }
  return "";
}

/// What a line that cannot be parsed holds that the program does not have; empty: it is not that.
std::string unknown_word(const CLI::App& app, int argc, char** argv) {
  if (argc < 2) return "";
  std::string first = unknown_command(app, argv[1]);
  if (!first.empty()) return first;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    if (command->get_name() == argv[1]) return unknown_option(*command, argc, argv);
  }
  return unknown_option(app, argc, argv);
}

/// CLI11's reason; of `--json=1` in words that name the option.
std::string reason_of(const CLI::ParseError& error) {
  const std::string reason = error.what();
  const auto end = reason.find(" was given a disallowed flag override");
  return end == std::string::npos ? reason : "--" + reason.substr(0, end) + ": takes no value";
}

int parse_and_run(const Program& program, int argc, char** argv) {
  CLI::App app{program.description, program.name};
  app.set_version_flag("--version", version_line(program.name), "Print name, version and commit");
  app.footer("Exit codes: 0 done, 1 a check failed or the machine could not do it, 2 bad input.");
  const std::vector<Command> commands = program.add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& answer) {  // --help, --version
    return app.exit(answer);
  } catch (const CLI::ParseError& error) {
    const std::string unknown = unknown_word(app, argc, argv);
    throw UserError((unknown.empty() ? reason_of(error) : unknown) + " (" + program.name +
                    " --help lists what it takes)");
  }
  const auto named = std::find_if(
      commands.begin(), commands.end(), [](const Command& one) { return one.parser->parsed(); });
  if (named == commands.end()) throw std::logic_error("the command line names no command");
  return named->run();
}

int report_error(const Program& program, const std::string& what, int code) {
  std::fprintf(stderr, "%s: %s\n", program.name.c_str(), one_line(what).c_str());
  return code;
}

std::string line_of(const fs::filesystem_error& error) {
  const std::string path = error.path1().string();
  return (path.empty() ? "a file" : path) + ": cannot be used: " + error.code().message();
}

/// Where the system says no more than its reason, as of a thread that cannot be started.
std::string line_of(const std::system_error& error) {
  const std::string reason = error.code().message();
  if (error.what() != reason) return error.what();
  return "the system refuses a thread, a lock or memory: " + reason + address_space_limit();
}

/// Drivers of OpenGL, and libraries that start threads, do not say that the address space is why
/// they fail.
std::string limit_of_driver(std::string_view line) {
  const bool is_of_driver = line.starts_with("no OpenGL") || line.ends_with("GL_OUT_OF_MEMORY") ||
                            line.starts_with("pthread_create has failed");
  return is_of_driver ? address_space_limit() : "";
}

/// OpenCV's exception, whose header is not included for it.
bool is_out_of_memory(const std::exception& error) {
  return std::string_view(error.what()).find("(-4:Insufficient memory)") != std::string_view::npos;
}

std::string& stored_command_line() {
  static std::string line;
  return line;
}

/// Set by a signal handler, which can reach nothing but a global variable.
volatile std::sig_atomic_t requested = 0;

void on_signal(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Refusal refusal_of(const std::exception_ptr& exception) {
  const std::string internal = "a fault of this program, please report it: ";
  const std::string out_of_memory = "out of memory" + address_space_limit();
  try {
    std::rethrow_exception(exception);
  } catch (const UserError& error) {
    return {error.what(), kBadInput};
  } catch (const InvalidOption& error) {
    return {error.what(), kBadInput};
  } catch (const std::bad_alloc&) {
    return {out_of_memory, kFailed};
  } catch (const fs::filesystem_error& error) {
    return {line_of(error), kFailed};
  } catch (const std::system_error& error) {
    return {line_of(error), kFailed};
  } catch (
      const std::logic_error& error) {  // also of containers, numbers in texts, optional values
    return {internal + error.what(), kFailed};
  } catch (const std::runtime_error& error) {
    return {error.what() + limit_of_driver(error.what()), kFailed};
  } catch (const std::exception& error) {  // of a library
    return {is_out_of_memory(error) ? out_of_memory : internal + error.what(), kFailed};
  } catch (...) {
    return {internal + "an exception without a text", kFailed};
  }
}

int run_program(const Program& program, int argc, char** argv) {
  expect_machine_limits(program.name.c_str());
  stored_command_line() = program.name;
  for (int i = 1; i < argc; ++i) stored_command_line() += " " + shell_word(argv[i]);
  try {
    occupy_standard_descriptors();
    const int code = parse_and_run(program, argc, argv);
    check_stdout();
    return code;
  } catch (...) {
    const Refusal refusal = refusal_of(std::current_exception());
    return report_error(program, refusal.line, refusal.code);
  }
}

void end_with_a_line() {
  if (std::current_exception() == nullptr) std::abort();
  const Refusal refusal = refusal_of(std::current_exception());
  std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, one_line(refusal.line).c_str());
  ::_exit(refusal.code);
}

const std::string& command_line() {
  return stored_command_line();
}

void stop_in_order() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, on_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

bool stop_requested() {
  return requested != 0;
}

}  // namespace wobblebench::bench
