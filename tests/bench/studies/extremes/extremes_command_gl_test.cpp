// The command `extremes`, by running the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using ExtremesCommand = InFolder;

TEST_F(ExtremesCommand, EveryCaseDoesWhatItMust) {
  // It keeps a hundred phantoms, which no other start would read.
  const auto result = bench("extremes --json", {}, {.no_cache = true});
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(report.at("command"), "extremes");
  const auto& extremes = report.at("extremes");
  EXPECT_GT(extremes.at("cases").size(), 150U);
  for (const auto& outcome : extremes.at("cases")) {
    EXPECT_TRUE(outcome.at("passed")) << outcome.dump();
  }
  EXPECT_EQ(extremes.at("failed"), 0);
  EXPECT_EQ(folder_.files("out"),
            words_of("extremes.csv extremes.md extremes_numbers.csv report.html report.json"));
}

TEST_F(ExtremesCommand, RefusesABadSeedBeforeAnyWork) {
  expect_refused(bench("extremes --seed -1"), "wobblebench: --seed = -1: ");
  EXPECT_TRUE(folder_.files().empty());
}

}  // namespace
}  // namespace wobblebench::bench
