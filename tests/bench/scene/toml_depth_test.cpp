// TOML that nests too deep is refused before a parser recurses into it.
#include "bench/scene/toml_depth.h"

#include <gtest/gtest.h>

#include <string>

#include "base/user_error.h"
#include "bench/scene/scene.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

std::string repeated(const std::string& part, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += part;
  return all;
}

TEST(TomlDepth, DotsAndBracketsNest) {
  EXPECT_FALSE(line_nested_too_deep(repeated("a.", 31) + "a = 1"));
  EXPECT_EQ(line_nested_too_deep("x = 1\n" + repeated("a.", 32) + "a = 1"), 2);
  EXPECT_EQ(line_nested_too_deep(repeated("\"a\" . ", 32) + "a = 1"), 1);
  EXPECT_FALSE(line_nested_too_deep("a = " + repeated("[", 32) + repeated("]", 32)));
  EXPECT_EQ(line_nested_too_deep("a = [\n\n" + repeated("{b = ", 33)), 3);
}

TEST(TomlDepth, NumbersStringsAndCommentsDoNot) {
  EXPECT_FALSE(line_nested_too_deep("a = [" + repeated("1.5, ", 100) + "2.5]"));
  EXPECT_FALSE(line_nested_too_deep("# " + repeated(".[", 100) + "\na = 1"));
  EXPECT_FALSE(line_nested_too_deep("a = \"\\\"" + repeated(".[", 100) + "\""));
  EXPECT_FALSE(line_nested_too_deep("a = '" + repeated(".[", 100) + "'"));
  EXPECT_FALSE(line_nested_too_deep("a = \"\"\"\n\\\"\"" + repeated(".[\n", 100) + "\"\"\"\"\""));
  EXPECT_EQ(line_nested_too_deep("a = \"\"\"b\"\"\"\"\"\nc = " + repeated("[", 33)), 2)
      << "behind a string that ends with quotes";
  EXPECT_EQ(line_nested_too_deep("a = \"b\nc = " + repeated("[", 33)), 2)
      << "behind a string that its line ends";
}

/// The line with which a scene of this text is refused.
std::string refusal(const std::string& text, const std::vector<std::string>& settings = {}) {
  const testing_support::ScratchFolder folder;
  return refusal_of<UserError>([&] {
    load_scene(text.empty() ? std::filesystem::path() : folder.write("a.toml", text), settings);
  });
}

TEST(TomlDepth, EightyKilobytesOfDotsAreOneLine) {
  const std::string deep = "nests deeper than 32 levels; keys of a scene have three";
  const std::string key = repeated("a.", 40000) + "a", list = repeated("[", 40000);
  EXPECT_TRUE(refusal(key + " = 1\n").ends_with("a.toml: line 1: " + deep));
  EXPECT_TRUE(refusal("[" + key + "]\n").ends_with(deep));
  EXPECT_TRUE(refusal("a = " + list + repeated("]", 40000)).ends_with(deep));
  EXPECT_TRUE(refusal("", {key + "=1"}).ends_with(deep));
  EXPECT_TRUE(refusal("", {"phantom.name=" + list}).ends_with(deep));
  EXPECT_TRUE(refusal("", {"phantom.name={" + key + "=1}"}).ends_with(deep));
}

TEST(TomlDepth, APathMayHoldAnyNumberOfDots) {
  const std::string path = repeated("../", 40) + "none.vdb";
  EXPECT_TRUE(holds(refusal("", {"phantom.name=file", "phantom.file=" + path}), "no such file"));
}

TEST(SceneText, AValueOfMegabytesIsNotEchoed) {
  const std::string value(1'000'000, 'x');
  for (const std::string& line : {refusal("[phantom]\nname = \"" + value + "\"\n"),
                                  refusal("[simulation]\nfidelity = \"" + value + "\"\n"),
                                  refusal("[phantom]\n" + value + " = 1\n"),
                                  refusal("", {"phantom.name=" + value}),
                                  refusal("", {"phantom.background=" + value, "phantom.name=vdb"}),
                                  refusal("", {value})}) {
    EXPECT_LT(line.size(), 2100u) << line.substr(0, 300);
    EXPECT_NE(line, "");
  }
  EXPECT_TRUE(refusal("[simulation]\nfidelity = \"" + value + "\"\n").ends_with("\"reference\""))
      << "what is allowed is still said";
  EXPECT_TRUE(holds(refusal(std::string(17'000'000, '\n')), "has more than 16 MB"));
}

}  // namespace
}  // namespace wobblebench::bench
