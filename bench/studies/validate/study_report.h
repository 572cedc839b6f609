// The report of a study: checks, measured points and figures.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/output/chart/chart.h"

namespace wobblebench::bench {

/// A measured value against what it should be.
struct Check {
  enum class Kind {
    within,    ///< |measured - expected| <= tolerance
    at_least,  ///< measured >= expected
    at_most,   ///< measured <= expected
  };

  std::string name;  ///< dotted: study.what.where
  Kind kind = Kind::within;
  double measured = 0;
  double expected = 0;
  double tolerance = 0;
  std::string unit;                  ///< of all three; "1" for pure numbers
  std::string source;                ///< of what is expected: a closed form or a publication
  long n = 0;                        ///< number of observations …
  std::string of;                    ///< … of this kind
  std::vector<std::uint64_t> seeds;  ///< empty: nothing random in it

  bool passed() const {
    switch (kind) {
      case Kind::within:
        return std::abs(measured - expected) <= tolerance;
      case Kind::at_least:
        return measured >= expected;
      case Kind::at_most:
        return measured <= expected;
    }
    return false;
  }
};

/// One row of the CSV file. Names include their unit.
struct DataPoint {
  std::string series;
  std::string x_name;
  double x = 0;
  std::string y_name;
  double y = 0;
  std::optional<double> expected;
};

struct StudyReport {
  std::string id;  ///< as --study takes it
  std::string title;
  std::string text;  ///< Markdown: method and findings
  std::vector<Check> checks;
  std::vector<DataPoint> points;
  std::vector<Figure> figures;
};

}  // namespace wobblebench::bench
