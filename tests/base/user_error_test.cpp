#include "base/user_error.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/expect.h"

namespace wobblebench {
namespace {

TEST(OneLine, ShowsControlCharactersAndOtherBytesAsEscapes) {
  EXPECT_EQ(one_line("a\nb\t\xff"), "a\\nb\\x09\\xff");
}

TEST(OneLine, LeavesOutTheMiddleOfALongText) {
  const std::string line =
      one_line("a.toml: key = " + std::string(100'000, 'v') + ": must be one of a b");
  EXPECT_LT(line.size(), 1700u);
  EXPECT_TRUE(line.starts_with("a.toml: key = vvv"));
  EXPECT_TRUE(line.ends_with("vvv: must be one of a b"));
  EXPECT_TRUE(holds(line, " … (98434 bytes) … ")) << "of 100034, 1600 are shown";
}

TEST(OneLine, CutsBetweenCharacters) {
  for (const std::string begin : {"", "a", "ab"}) {
    std::string text = begin;
    for (int i = 0; i < 1000; ++i) text += "\xe2\x82\xac";
    EXPECT_TRUE(is_utf8(one_line(text)));
    EXPECT_FALSE(holds(one_line(text), "\\x")) << "shown as characters";
  }
}

}  // namespace
}  // namespace wobblebench
