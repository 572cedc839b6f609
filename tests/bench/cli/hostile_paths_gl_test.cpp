// Paths that are no UTF-8, which JSON cannot hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::run_process;
using testing_support::ScratchFolder;

const std::vector<std::string> kQuick = {"--set",
                                         "phantom.name=sphere",
                                         "--set",
                                         "phantom.voxel_mm=2",
                                         "--set",
                                         "render.scan_conversion.slice_size=64",
                                         "--set",
                                         "render.ray_casting.image_size=64",
                                         "--set",
                                         "render.ray_casting.steps=64",
                                         "--set",
                                         "acquisition.frames_per_volume=9"};

TEST(PathsOfAnyBytes, WorkOrAreOneLine) {
  const ScratchFolder folder;
  folder.write("\xff.toml", "[acquisition]\ndepth_mm = 100\n");
  for (const std::vector<std::string>& first :
       {std::vector<std::string>{"run", "--json", "--out", "\xff"},
        {"run", "--json", "\xff.toml"},
        {"record", "--volumes", "1", "--out", "\xfe"},
        {"run", "--json", "--board", "file=\xfe/recording.wbst"},
        {"run", "--json", "--board", "file=none\xff"},
        {"inspect", "--json", "\xfe/recording.wbst"},
        {"phantom", "--json", "--out", "\xfd"}}) {
    std::vector<std::string> words = first;
    if (first[0] != "inspect") words.insert(words.end(), kQuick.begin(), kQuick.end());
    const auto result = run_process(WOBBLEBENCH_PROGRAM, words, folder.path());
    SCOPED_TRACE(result.err);
    if (result.exit_code == 0) continue;
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    EXPECT_EQ(result.err.find("json"), std::string::npos);
  }
}

}  // namespace
}  // namespace wobblebench::bench
