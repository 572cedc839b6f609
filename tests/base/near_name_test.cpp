// Hints for slips of the keyboard.
#include "base/near_name.h"

#include <gtest/gtest.h>

namespace wobblebench {
namespace {

const std::vector<std::string> kCommands = {"run", "stream", "record", "inspect", "tune", "rungs"};

TEST(NearName, IsTheOneWithTheFewestEdits) {
  EXPECT_EQ(nearest_name("runn", kCommands), "run");
  EXPECT_EQ(nearest_name("strem", kCommands), "stream");
  EXPECT_EQ(nearest_name("recrod", kCommands), "record") << "neighbours that are swapped";
  EXPECT_EQ(nearest_name("Tune", kCommands), "tune");
  EXPECT_EQ(nearest_name("rung", kCommands), "run") << "the first of two as near";
}

TEST(NearName, IsNoneWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("weather", kCommands), "");
  EXPECT_EQ(nearest_name("", kCommands), "");
  EXPECT_EQ(nearest_name("x", {"y"}), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'r'), kCommands), "");
  EXPECT_EQ(nearest_name("run", {}), "");
}

TEST(NearName, IsOfferedAsAQuestion) {
  EXPECT_EQ(did_you_mean("runn", kCommands), "; did you mean run?");
  EXPECT_EQ(did_you_mean("weather", kCommands), "");
}

}  // namespace
}  // namespace wobblebench
