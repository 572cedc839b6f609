// What a study hands back: what it checked, every point that it measured, and figures.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/report/chart/chart.h"

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
  long n = 0;                        ///< measured from this many …
  std::string of;                    ///< … of these
  std::vector<std::uint64_t> seeds;  ///< none: nothing random in it

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

/// One row of the CSV file. Names carry their unit.
struct DataPoint {
  std::string series;
  std::string x_name;
  double x = 0;
  std::string y_name;
  double y = 0;
  std::optional<double> expected;
};

struct Figure {
  std::string name;     ///< of the file, without extension
  std::string caption;  ///< one sentence
  Picture3 picture;
};

struct StudyReport {
  std::string id;  ///< as --study takes it
  std::string title;
  std::string text;  ///< Markdown: what was done, and what it shows
  std::vector<Check> checks;
  std::vector<DataPoint> points;
  std::vector<Figure> figures;
};

/// first, first + 1, …
inline std::vector<std::uint64_t> seeds_from(std::uint64_t first, int count) {
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < count; ++i) seeds.push_back(first + static_cast<std::uint64_t>(i));
  return seeds;
}

}  // namespace wobblebench::bench
