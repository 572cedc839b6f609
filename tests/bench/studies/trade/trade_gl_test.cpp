// The command `trade`, by running the program.
#include <gtest/gtest.h>
#include <wordexp.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

const std::string kScene =
    "phantom = { name = \"sphere\", voxel_mm = 2 }\n"
    "acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }\n"
    "render.scan_conversion.slice_size = 64\nrender.ray_casting.image_size = 64\n";
const std::string kPlan =
    "design = \"latin_hypercube\"\npoints = 6\nseeds = 2\nrepeats = 1\n"
    "[reference.render]\npreset = \"baseline\"\n"
    "[scenes.ball]\n" +
    kScene + "[scenes.flat]\n" + kScene +
    "[axes]\n\"render.ray_casting.steps\" = [32, 64]\n"
    "\"render.ray_casting.iso_level\" = { from = 0.5, to = 0.9 }\n"
    "\"simulation.fidelity\" = [\"geometry\", \"field\"]\n";
constexpr std::size_t kMeasurements = 24;

/// trade.csv without its last four columns, the times.
std::string without_times(const std::string& csv) {
  std::istringstream lines(csv);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    for (int i = 0; i < 4; ++i) line.resize(line.rfind(','));
    result += line + "\n";
  }
  return result;
}

/// The words of a shell's line that stands in HTML.
Words shell_words(std::string html) {
  const std::pair<std::string, std::string> references[] = {
      {"&#39;", "'"}, {"&quot;", "\""}, {"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}};
  for (const auto& [reference, character] : references) {
    for (auto at = html.find(reference); at != std::string::npos; at = html.find(reference)) {
      html.replace(at, reference.size(), character);
    }
  }
  wordexp_t words{};
  EXPECT_EQ(wordexp(html.c_str(), &words, WRDE_NOCMD), 0) << html;
  Words result(words.we_wordv, words.we_wordv + words.we_wordc);
  wordfree(&words);
  return result;
}

class Trade : public ::testing::Test {
 protected:
  Trade() { folder_.write("plan.toml", kPlan); }
  ProcessResult trade(const Words& more, const ProcessLimits& limits = {}) const {
    return bench(with({"trade", "plan.toml"}, {more}), folder_, limits);
  }
  std::string file(const std::string& name) const { return bytes_of(folder_.path() / name); }

  ScratchFolder folder_;
};

TEST_F(Trade, MeasuresEveryPointAndSaysWhatItFound) {
  const auto result = trade({"--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("command"), "trade");
  EXPECT_EQ(report.at("trade").at("measurements"), kMeasurements);
  EXPECT_EQ(report.at("timing").at("machines").size(), 1U);
  for (const char* part : {"all scenes", "ball", "flat"}) {
    EXPECT_FALSE(report.at("timing").at("trade").at("parts").at(part).at("front").empty()) << part;
  }
  for (const char* name :
       {"trade.csv", "trade.md", "trade_ball.vl.json", "points.jsonl", "report.html"}) {
    EXPECT_TRUE(fs::exists(folder_.path() / "out" / name)) << name;
  }
}

TEST_F(Trade, ShardsMergedAreOneRun) {
  ASSERT_EQ(trade({"--out", "whole"}).exit_code, 0);
  for (const std::string shard : {"1", "2", "3"}) {
    const auto part = trade({"--shard", shard + "/3", "--out", "s" + shard});
    ASSERT_EQ(part.exit_code, 0) << part.err;
    EXPECT_FALSE(fs::exists(folder_.path() / ("s" + shard) / "trade.csv"));
    EXPECT_FALSE(fs::exists(folder_.path() / ("s" + shard) / "report.html"));
  }
  const auto early = trade({"--merge", "s1", "--merge", "s3", "--out", "early"});
  EXPECT_EQ(early.exit_code, 2);
  EXPECT_NE(early.err.find("--merge: 8 of 24 measurements are in none"), std::string::npos)
      << early.err;
  EXPECT_FALSE(fs::exists(folder_.path() / "early"));
  const auto merged = trade({"--merge", "s3", "--merge", "s1", "--merge", "s2", "--out", "merged"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(without_times(file("merged/trade.csv")), without_times(file("whole/trade.csv")));
}

/// Killed at any moment, it goes on where it was: no measurement is lost but the one in flight, and
/// none is made twice. WOBBLEBENCH_KILLS sets the number of kills.
TEST_F(Trade, KilledAtAnyMomentItGoesOn) {
  const char* setting = std::getenv("WOBBLEBENCH_KILLS");
  const int kills = setting == nullptr ? 4 : std::atoi(setting);
  ASSERT_EQ(trade({"--out", "whole"}).exit_code, 0);
  const fs::path journal = folder_.path() / "killed/points.jsonl";
  const auto size = [&] {
    std::error_code none;
    const auto bytes = fs::file_size(journal, none);
    return none ? std::uintmax_t{0} : bytes;
  };
  const std::uintmax_t all = fs::file_size(folder_.path() / "whole/points.jsonl");
  std::string kept;
  for (int kill = 0; kill < kills; ++kill) {
    ProcessLimits limits;
    limits.signal = SIGKILL;
    const auto bytes = all * static_cast<std::uintmax_t>(kill + 1) / (kills + 1);
    limits.interrupt_when = [&] { return size() >= bytes; };
    const auto killed = trade({"--out", "killed"}, limits);
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL) << killed.err;
    const std::string now = file("killed/points.jsonl");
    const std::string whole = now.substr(0, now.rfind('\n') + 1);
    EXPECT_EQ(whole.substr(0, kept.size()), kept) << "what was measured stays";
    kept = whole;
  }
  const auto finished = trade({"--out", "killed"});
  ASSERT_EQ(finished.exit_code, 0);
  const auto measured = std::count(kept.begin(), kept.end(), '\n') - 2;
  EXPECT_NE(
      finished.err.find("wobblebench: went on with " + std::to_string(measured) + " measurement"),
      std::string::npos)
      << finished.err;
  const std::string last = file("killed/points.jsonl");
  EXPECT_EQ(static_cast<std::size_t>(std::count(last.begin(), last.end(), '\n')),
            kMeasurements + 2);  // the plan, the machine
  EXPECT_EQ(without_times(file("killed/trade.csv")), without_times(file("whole/trade.csv")));
}

/// The command that the page shows of a point makes the picture that was measured.
TEST_F(Trade, ThePageNamesTheCommandOfAPoint) {
  ASSERT_EQ(trade({"--out", "whole"}).exit_code, 0);
  const std::string page = file("whole/report.html");
  const auto detail = page.find("<template class=\"detail\" data-id=\"point-0\">");
  ASSERT_NE(detail, std::string::npos);
  const std::string begin = "<pre class=\"command\">wobblebench ";
  const auto at = page.find(begin, detail) + begin.size();
  const Words words = shell_words(page.substr(at, page.find('<', at) - at));
  const auto run = bench(with(words, {{"--json"}}), folder_, {});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::istringstream csv(file("whole/trade.csv"));
  std::string names, first;
  std::getline(csv, names);
  std::getline(csv, first);
  EXPECT_EQ(first.substr(0, 9), "ball,0,1,");
  const auto cells = [](const std::string& line) {
    Words fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    return fields;
  };
  const auto all = cells(names);
  const auto column =
      static_cast<std::size_t>(std::find(all.begin(), all.end(), "p95_mm") - all.begin());
  const double p95_mm = nlohmann::json::parse(run.out).at("error").at("depth_mm").at("p95");
  EXPECT_NEAR(std::stod(cells(first).at(column)), p95_mm, 1e-6 * p95_mm);
}

/// Each value is allowed alone: mid_volume with aligned sticks is not.
TEST_F(Trade, ACombinationThatIsRefusedIsAResult) {
  folder_.write("plan.toml",
                "repeats = 1\nseeds = 1\n[scenes.ball]\n" + kScene +
                    "render.preset = \"baseline\"\n"
                    "[axes]\n\"render.pipeline.mid_volume\" = [false, true]\n"
                    "\"render.reconstruction.sticks\" = [\"plain\", \"aligned\"]\n");
  const auto result = trade({"--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("trade").at("refused_points"), 1);
  EXPECT_NE(file("out/trade.csv").find("mid_volume = true: "), std::string::npos);
}

TEST_F(Trade, RefusesBadInputWithOneLineBeforeAnyWork) {
  folder_.write("level.toml",
                "[scenes.ball]\n" + kScene + "[axes]\n\"render.ray_casting.steps\" = [64, 0]\n");
  folder_.write("key.toml", "[scenes.ball]\n" + kScene + "[axes]\n\"render.x.y\" = [1, 2]\n");
  for (const Words& words : {Words{"trade"},
                             Words{"trade", "missing.toml"},
                             Words{"trade", "level.toml"},
                             Words{"trade", "key.toml"},
                             Words{"trade", "plan.toml", "--shard", "0/3"},
                             Words{"trade", "plan.toml", "--shard", "4/3"},
                             Words{"trade", "plan.toml", "--shard", "1/3x"},
                             Words{"trade", "plan.toml", "--shard", "2"},
                             Words{"trade", "plan.toml", "--shard", "1/2", "--merge", "x"},
                             Words{"trade", "plan.toml", "--set", "simulation.seed=x"}}) {
    const auto result = bench(words, folder_);
    EXPECT_EQ(result.exit_code, 2) << words.back();
    EXPECT_EQ(result.err.find("wobblebench: "), 0U) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder_.path() / "out")) << words.back();
  }
}

TEST_F(Trade, LeavesOutScenesOfAPopulationThatCannotBeBuilt) {
  // A mesh with a hole is refused when its level set is made.
  folder_.write("open.obj",
                "v -20 -20 -20\nv 20 -20 -20\nv 0 20 -20\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  folder_.write(
      "population.toml",
      "scenes = 8\n[scene]\nacquisition = { frames_per_volume = 9, sticks_per_frame = 16 }\n"
      "render.scan_conversion.slice_size = 64\nrender.ray_casting.image_size = 64\n"
      "[strata.ball]\nshare = 0.5\n"
      "phantom = { name = \"sphere\", voxel_mm = 2 }\n"
      "[strata.none]\nshare = 0.5\n"
      "phantom = { name = \"mesh\", file = \"open.obj\", voxel_mm = 2 }\n");
  folder_.write("drawn.toml",
                "population = \"population.toml\"\nper_stratum = 1\nseeds = 1\nrepeats = 1\n"
                "[axes]\n\"render.ray_casting.steps\" = [32, 64]\n");
  const ProcessResult result = bench({"trade", "drawn.toml", "--out", "out"}, folder_);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("scene none-"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("is left out: phantom.file"), std::string::npos) << result.err;
  const std::string csv = bytes_of(folder_.path() / "out/trade.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3) << csv;  // a head and two points
  EXPECT_NE(csv.find("ball-"), std::string::npos);
  EXPECT_EQ(csv.find("none-"), std::string::npos);
}

}  // namespace
}  // namespace wobblebench::bench
