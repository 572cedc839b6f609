// The command `extremes`, by running the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

TEST(ExtremesCommand, EveryCaseDoesWhatItMust) {
  const ScratchFolder folder;
  // It keeps a hundred phantoms, which no other start would read.
  const auto result = bench({"extremes", "--json"}, folder, {.no_cache = true});
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(report.at("command"), "extremes");
  const auto& extremes = report.at("extremes");
  EXPECT_GT(extremes.at("cases").size(), 150U);
  for (const auto& outcome : extremes.at("cases")) {
    EXPECT_TRUE(outcome.at("passed")) << outcome.dump();
  }
  EXPECT_EQ(extremes.at("failed"), 0);
  EXPECT_EQ(folder.files("out"),
            (Words{"extremes.csv", "extremes.md", "report.html", "report.json"}));
}

TEST(ExtremesCommand, RefusesABadSeedBeforeAnyWork) {
  const ScratchFolder folder;
  const auto result = bench({"extremes", "--seed", "-1"}, folder);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err.find("wobblebench: --seed = -1: "), 0U) << result.err;
  EXPECT_TRUE(folder.files().empty());
}

}  // namespace
}  // namespace wobblebench::bench
