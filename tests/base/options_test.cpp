#include "base/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/units.h"
#include "tests/support/expect.h"

namespace wobblebench {
namespace {

struct Box {
  glm::dvec3 size_m{0.1, 0.2, 0.3};
  int count = 3;
};

template <OptionsOf<Box> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.vec3("size_mm", o.size_m, kMillimetre, 1, 1000);
  v.integer("count", o.count, 1, 9);
}

std::string refusal(const Box& box, std::string_view prefix = "") {
  return refusal_of<InvalidOption>([&] { check_options(box, prefix); });
}

TEST(Options, NameKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({.count = 0}), "count = 0: must be within 1 and 9");
  EXPECT_EQ(refusal({.count = 10}, "box."), "box.count = 10: must be within 1 and 9");
}

TEST(Options, RefuseEachComponentOfAVector) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double wrong : {0.0, 1.1, std::nan(""), HUGE_VAL}) {
      Box box;
      box.size_m[axis] = wrong;
      EXPECT_TRUE(holds(refusal(box), "must be within 1 and 1000")) << wrong;
    }
  }
}

}  // namespace
}  // namespace wobblebench
