// Numbers at their ends that no picture shows: device time, sequence numbers, phase.
#pragma once

#include <string>
#include <vector>

namespace wobblebench::bench {

struct NumberOutcome {
  std::string name;
  double worst = 0;  ///< difference from the exact number
  double bound = 0;
  std::string unit;
  std::string how;  ///< what the exact number and the bound follow from
  bool passed() const { return worst <= bound; }
};

std::vector<NumberOutcome> run_number_cases();

}  // namespace wobblebench::bench
