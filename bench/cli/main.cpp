#include <exception>

#include "bench/command/commands.h"

namespace {

/// Runs before the shared libraries are initialised: one of them starts a thread then, and nothing
/// catches what it throws where the system refuses threads.
void expect_early_failures() {
  std::set_terminate(wobblebench::bench::end_with_a_line);
}

[[gnu::section(".preinit_array"),
  gnu::used]] void (*const before_libraries)() = expect_early_failures;

}  // namespace

int main(int argc, char** argv) {
  using namespace wobblebench::bench;
  return run_program(wobblebench_program(), argc, argv);
}
