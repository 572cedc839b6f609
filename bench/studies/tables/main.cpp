#include "bench/studies/tables/tables_program.h"

int main(int argc, char** argv) {
  using namespace wobblebench::bench;
  return run_program(tables_program(), argc, argv);
}
