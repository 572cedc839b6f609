// Numbers as text, against printf.
#include "base/number_text.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstdio>
#include <vector>

namespace wobblebench {
namespace {

std::string printed(const char* format, double value, int digits) {
  std::string text(512, '\0');
  const int length = std::snprintf(text.data(), text.size(), format, digits, value);
  return text.substr(0, static_cast<std::size_t>(length));
}

TEST(NumberText, IsWhatPrintfWrites) {
  const std::vector<double> values = {0,       -0.0,     1,         -1.5,        0.05,   2.5,
                                      0.125,   9.95,     99.9999,   1e5,         123456, 1234567,
                                      1e-5,    1.23e-7,  1e15,      1e17,        -1e300, DBL_MAX,
                                      DBL_MIN, HUGE_VAL, -HUGE_VAL, std::nan("")};
  for (const double value : values) {
    for (const int digits : {0, 1, 2, 3, 4, 6, 9, 12, 17}) {
      EXPECT_EQ(fixed(value, digits), printed("%.*f", value, digits));
      EXPECT_EQ(significant(value, digits), printed("%.*g", value, digits));
    }
  }
}

TEST(NumberText, Examples) {
  EXPECT_EQ(fixed(54.55, 1), "54.5") << "below a half in binary";
  EXPECT_EQ(fixed(2, 3), "2.000");
  EXPECT_EQ(significant(2, 3), "2");
  EXPECT_EQ(significant(1234567, 4), "1.235e+06");
}

}  // namespace
}  // namespace wobblebench
