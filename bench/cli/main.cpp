#include <unistd.h>

#include <csignal>
#include <exception>

#include "bench/command/commands.h"

namespace {

/// Until a command has its own way to end, and where it has none.
void end_interrupted(int signal) {
  static_cast<void>(!::write(STDERR_FILENO, "wobblebench: interrupted\n", 25));
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Runs before the shared libraries are initialised: one of them starts a thread then, and nothing
/// catches what it throws where the system refuses threads.
void expect_early_failures() {
  std::set_terminate(wobblebench::bench::end_with_a_line);
  for (const int signal : {SIGINT, SIGTERM}) {
    if (std::signal(signal, end_interrupted) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

[[gnu::section(".preinit_array"),
  gnu::used]] void (*const before_libraries)() = expect_early_failures;

}  // namespace

int main(int argc, char** argv) {
  using namespace wobblebench::bench;
  return run_program(wobblebench_program(), argc, argv);
}
