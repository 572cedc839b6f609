// `run --tolerance`, by running the program.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

/// Small, but with a surface far from its silhouette, and a rim of a pixel or two, which is kept.
const Words kBall =
    set("phantom.name=sphere phantom.voxel_mm=2 acquisition.frames_per_volume=13 "
        "acquisition.sticks_per_frame=24 render.ray_casting.image_size=64 "
        "render.scan_conversion.slice_size=64 render.ray_casting.iso_level=0.72 "
        "render.ray_casting.outline_mm=0");

class Tolerance : public InFolder {
 protected:
  ProcessResult run(const std::string& tolerance, const Words& more = {}) const {
    return bench("run --json --tolerance " + tolerance, {kBall, more});
  }
  static const Json& outside_silhouettes(const Json& report) {
    for (const Json& region : report.at("error").at("regions")) {
      if (region.at("group") == "silhouette" && region.at("name") == "outside") return region;
    }
    throw std::out_of_range("no region outside the silhouettes");
  }
};

TEST_F(Tolerance, IsKeptByTheFastestSettingThatHolds) {
  const auto report = report_of(run("20mm")), tolerance = report.at("tolerance");
  EXPECT_TRUE(tolerance.at("promised"));
  EXPECT_TRUE(tolerance.at("held"));
  Json measured = report.at("timing").at("tolerance").at("measured");
  EXPECT_LE(measured.back().at("outside_p95_bound_mm"), 20);
  EXPECT_LE(measured.back().at("missed_or_false_bound_percent"), 5);
  measured.erase(measured.size() - 1);
  for (const Json& faster : measured) EXPECT_FALSE(faster.at("holds"));
  EXPECT_EQ(tolerance.at("reached_mm"), outside_silhouettes(report).at("p95_mm").get<double>());
  EXPECT_EQ(report.at("simulation").at("rung"), tolerance.at("rung"));
}

TEST_F(Tolerance, ThatNoSettingKeepsEndsWithOneLineAndTheMostAccuratePicture) {
  const auto result = run("0.01mm");
  expect_line(result, 1, "--tolerance = 0.01mm: no setting keeps it");
  const Json tolerance = Json::parse(result.out).at("tolerance");
  EXPECT_FALSE(tolerance.at("promised"));
  EXPECT_FALSE(tolerance.at("held"));
  EXPECT_EQ(tolerance.at("rung"), tolerance.at("finest_rung"));
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
}

TEST_F(Tolerance, LeavesTheKeysThatTheSceneNames) {
  const auto report =
      report_of(run("20mm", set("render.ray_casting.steps=77 simulation.fidelity=field")));
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
  expect_refusals(
      {{"run --tolerance 0.5", "--tolerance = 0.5: must be 0.01mm to 100mm"},
       {"run --tolerance -1mm", "--tolerance = -1mm: must be"},
       {"run --tolerance nanmm", "--tolerance = nanmm: must be"},
       {"run --tolerance 1mm --board file=none.wbst", "--tolerance: needs --board sim"},
       {"run --tolerance 1mm --set render.preset=baseline", "leave render.preset out"}});
}

}  // namespace
}  // namespace wobblebench::bench
