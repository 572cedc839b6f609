#include "bench/command/commands.h"

int main(int argc, char** argv) {
  using namespace wobblebench::bench;
  return run_program(wobblebench_program(), argc, argv);
}
