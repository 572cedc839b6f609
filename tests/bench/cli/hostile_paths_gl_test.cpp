// Paths that are no UTF-8, which JSON cannot hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

const Words kQuick = with(kSphere, {kPicture, kScan});

TEST(PathsOfAnyBytes, WorkOrAreOneLine) {
  const ScratchFolder folder;
  folder.write("\xff.toml", "[acquisition]\ndepth_mm = 100\n");
  for (const Words& first : {Words{"run", "--json", "--out", "\xff"},
                             {"run", "--json", "\xff.toml"},
                             {"record", "--volumes", "1", "--out", "\xfe"},
                             {"run", "--json", "--board", "file=\xfe/recording.wbst"},
                             {"run", "--json", "--board", "file=none\xff"},
                             {"inspect", "--json", "\xfe/recording.wbst"},
                             {"phantom", "--json", "--out", "\xfd"}}) {
    Words words = first;
    if (first[0] != "inspect") words.insert(words.end(), kQuick.begin(), kQuick.end());
    const auto result = bench(words, folder);
    SCOPED_TRACE(result.err);
    if (result.exit_code == 0) continue;
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    EXPECT_EQ(result.err.find("json"), std::string::npos);
  }
}

}  // namespace
}  // namespace wobblebench::bench
