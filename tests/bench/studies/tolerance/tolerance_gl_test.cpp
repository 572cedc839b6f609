// `run --tolerance`, by running the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

/// Small, but with a surface far from its silhouette.
const Words kBall = {"--set",
                     "phantom.name=sphere",
                     "--set",
                     "phantom.voxel_mm=2",
                     "--set",
                     "acquisition.frames_per_volume=13",
                     "--set",
                     "acquisition.sticks_per_frame=24",
                     "--set",
                     "render.ray_casting.image_size=64",
                     "--set",
                     "render.scan_conversion.slice_size=64"};

class Tolerance : public ::testing::Test {
 protected:
  ProcessResult run(const std::string& tolerance, const Words& more = {}) const {
    ProcessLimits limits;
    limits.cache_home = folder_.path() / "cache";
    return bench(with({"run", "--tolerance", tolerance, "--json"}, {kBall, more}), folder_, limits);
  }
  static const Json& outside_silhouettes(const Json& report) {
    for (const Json& region : report.at("error").at("regions")) {
      if (region.at("group") == "silhouette" && region.at("name") == "outside") return region;
    }
    throw std::out_of_range("no region outside the silhouettes");
  }

  ScratchFolder folder_;
};

TEST_F(Tolerance, IsKeptByTheFastestSettingThatHolds) {
  const auto result = run("20mm");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out), tolerance = report.at("tolerance");
  EXPECT_TRUE(tolerance.at("promised"));
  EXPECT_TRUE(tolerance.at("held"));
  Json measured = report.at("timing").at("tolerance").at("measured");
  EXPECT_LE(measured.back().at("outside_p95_bound_mm"), 20);
  EXPECT_LE(measured.back().at("missed_or_false_bound_percent"), 5);
  measured.erase(measured.size() - 1);
  for (const Json& faster : measured) EXPECT_FALSE(faster.at("holds"));
  EXPECT_EQ(tolerance.at("reached_mm"),
            outside_silhouettes(report).at("depth_mm").at("p95").get<double>());
  EXPECT_EQ(report.at("simulation").at("rung"), tolerance.at("rung"));
}

TEST_F(Tolerance, ThatNoSettingKeepsEndsWithOneLineAndTheMostAccuratePicture) {
  const auto result = run("0.01mm");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("--tolerance = 0.01mm: no setting keeps it"), std::string::npos)
      << result.err;
  const Json tolerance = Json::parse(result.out).at("tolerance");
  EXPECT_FALSE(tolerance.at("promised"));
  EXPECT_FALSE(tolerance.at("held"));
  EXPECT_EQ(tolerance.at("rung"), tolerance.at("finest_rung"));
  EXPECT_TRUE(fs::exists(folder_.path() / "out/surface.png"));
}

TEST_F(Tolerance, LeavesTheKeysThatTheSceneNames) {
  const auto result =
      run("20mm", {"--set", "render.ray_casting.steps=77", "--set", "simulation.fidelity=field"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  EXPECT_EQ(report.at("scene").at("render").at("ray_casting").at("steps"), 77);
  EXPECT_EQ(report.at("simulation").at("rung"), "field");
  EXPECT_TRUE(report.at("tolerance").at("rungs").empty());
}

TEST_F(Tolerance, ChoosesTheSameFromWhatWasMeasuredBeforeForAnother) {
  ASSERT_EQ(run("20mm").exit_code, 0);
  const auto known = run("3mm"), anew = run("3mm", {"--no-cache"});
  const Json of_known = Json::parse(known.out).at("tolerance"),
             of_new = Json::parse(anew.out).at("tolerance");
  for (const char* key : {"chosen", "rung", "promised"}) {
    EXPECT_EQ(of_known.at(key), of_new.at(key)) << key;
  }
  ASSERT_EQ(of_known.at("rungs").size(), of_new.at("rungs").size());
  for (std::size_t i = 0; i < of_new.at("rungs").size(); ++i) {
    EXPECT_EQ(of_known.at("rungs")[i].at("difference_mm"),
              of_new.at("rungs")[i].at("difference_mm"));
  }
}

TEST_F(Tolerance, IsRefusedByOneLineBeforeAnyWork) {
  const std::vector<std::pair<Words, std::string>> wrong = {
      {{"--tolerance", "0.5"}, "--tolerance = 0.5: must be 0.01mm to 100mm"},
      {{"--tolerance", "-1mm"}, "--tolerance = -1mm: must be"},
      {{"--tolerance", "nanmm"}, "--tolerance = nanmm: must be"},
      {{"--tolerance", "1mm", "--board", "file=none.wbst"}, "--tolerance: needs --board sim"},
      {{"--tolerance", "1mm", "--set", "render.preset=baseline"}, "leave render.preset out"}};
  for (const auto& [words, line] : wrong) {
    const auto result = bench(with({"run"}, {words}), folder_);
    EXPECT_EQ(result.exit_code, 2) << line;
    EXPECT_NE(result.err.find(line), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(folder_.path() / "out")) << line;
  }
}

}  // namespace
}  // namespace wobblebench::bench
