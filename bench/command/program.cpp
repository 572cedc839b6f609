#include "bench/command/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <iostream>
#include <new>
#include <stdexcept>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

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
    throw UserError(std::string(error.what()) + " (" + program.name +
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

/// Set by a signal handler, which can reach nothing but a global variable.
volatile std::sig_atomic_t requested = 0;

void on_signal(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

int run_program(const Program& program, int argc, char** argv) {
  try {
    occupy_standard_descriptors();
    const int code = parse_and_run(program, argc, argv);
    check_stdout();
    return code;
  } catch (const UserError& error) {
    return report_error(program, error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return report_error(program, "out of memory", kFailed);
  } catch (const std::exception& error) {
    return report_error(program, error.what(), kFailed);
  }
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
