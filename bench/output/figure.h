// A figure of a report.
#pragma once

#include <string>

#include "bench/output/chart/chart.h"

namespace wobblebench::bench {

struct Figure {
  std::string name;     ///< of the file, without prefix and extension
  std::string caption;  ///< one sentence
  Picture3 picture;
};

}  // namespace wobblebench::bench
