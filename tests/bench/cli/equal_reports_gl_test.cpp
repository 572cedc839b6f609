// Two equal runs of a command have equal reports, but for "timing" and "provenance".
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

const std::string kScene =
    "phantom = { name = \"sphere\", voxel_mm = 2 }\n"
    "acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }\n"
    "render.scan_conversion.slice_size = 64\nrender.ray_casting.image_size = 64\n"
    "render.ray_casting.steps = 64\n";
const std::string kPlan =
    "design = \"sobol\"\npoints = 2\nseeds = 1\nrepeats = 1\n[scenes.ball]\n" + kScene +
    "[unseen.ball]\n" + kScene + "[axes]\n\"render.ray_casting.steps\" = [32, 64]\n";

class EqualReports : public InFolder {
 protected:
  EqualReports() { folder_.write("plan.toml", kPlan); }

  Json report_of(const Words& line) const {
    return wobblebench::bench::report_of(bench(with(line, {{"--json"}})));
  }
  /// What a reader compares: the second run meets what the first left in its folder.
  void expect_equal(const Words& line) const {
    SCOPED_TRACE(line.front());
    Json first = report_of(line), second = report_of(line);
    for (Json* report : {&first, &second}) {
      EXPECT_TRUE(report->contains("provenance"));
      report->erase("timing");
      report->erase("provenance");
    }
    EXPECT_EQ(Json::diff(first, second), Json::array());
  }
};

TEST_F(EqualReports, OfCommandsThatReadABoard) {
  expect_equal(with(words_of("run --register --board sim,faults=drop:0.1+seed:3"),
                    {kSphere, kScan, kPicture}));
  const Words record = words_of("record --volumes 5 --replace --out rec");
  expect_equal(with(record, {kSphere, kScan}));
  const std::string board = "file=rec/recording.wbst";
  expect_equal({"inspect", "rec/recording.wbst"});
  expect_equal(
      with({"run", "--board", board + ",faults=drop:0.1+corrupt:0.1"}, {kSphere, kPicture}));
  expect_equal(with({"stream", "--board", board, "--policy", "every"}, {kSphere, kPicture}));
  expect_equal(with(words_of("stream --volumes 3"), {kSphere, kScan, kPicture}));
  const Words frames = set("acquisition.sticks_per_frame=8");  // 37
  report_of(with(words_of("record --volumes 1 --out all"), {kSphere, frames}));
  expect_equal(words_of("tables --board file=all/recording.wbst --divisor 8 --repeats 1"));
}

TEST_F(EqualReports, OfCommandsThatReadNone) {
  expect_equal(with({"phantom"}, {kSphere}));
  expect_equal(words_of("rehearse --seeds 5"));
}

using EqualConformance = EqualReports;  // a suite of its own: it runs alone

TEST_F(EqualConformance, OfACorrectBoard) {
  expect_equal(with({"conformance"}, {kSphere, kScan}));
}

TEST_F(EqualReports, OfStudies) {
  expect_equal(with(words_of("accuracy --seeds 2"), {kSphere, kScan, kPicture}));
  expect_equal(words_of("tune plan.toml --limit p95_mm<=20 --evaluations 2 --random"));
  const auto trade = [&](const std::string& out) {
    Json report = report_of({"trade", "plan.toml", "--out", out});
    report.erase("timing");
    report.erase("provenance");
    return report;
  };
  EXPECT_EQ(Json::diff(trade("one"), trade("two")), Json::array());
}

/// Emitted sticks of the volume alone, not of what a thread read ahead: of 3 volumes of 144 sticks
/// the second is rendered, and every tenth stick or so is lost.
TEST_F(EqualReports, TheBoardsAccountEndsWithTheVolume) {
  report_of(with(words_of("record --volumes 3 --out rec"), {kSphere, kScan}));
  const auto of = [&](const std::string& more) {
    return report_of(
        with({"run", "--board", "file=rec/recording.wbst" + more}, {kSphere, kPicture}));
  };
  const Json whole = of("").at("board");
  EXPECT_EQ(whole.at("emitted"), 9 * 16);
  EXPECT_EQ(whole.at("delivered"), 9 * 16);
  const Json report = of(",faults=drop:0.1"), lossy = report.at("board");
  EXPECT_EQ(lossy.at("emitted"), 9 * 16);
  EXPECT_EQ(lossy.at("lost_link"), lossy.at("missing_sticks"));
  EXPECT_GE(report.at("timing").at("board").at("emitted"), 9 * 16);
}

}  // namespace
}  // namespace wobblebench::bench
