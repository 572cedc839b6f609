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

class Trade : public InFolder {
 protected:
  Trade() { folder_.write("plan.toml", kPlan); }
  ProcessResult trade(const Words& more, const ProcessLimits& limits = {}) const {
    return bench("trade plan.toml", {more}, limits);
  }
  std::string file(const std::string& name) const { return bytes_of(at(name)); }

  static fs::path whole() { return result_of({"trade", "plan.toml"}, {{"plan.toml", kPlan}}); }
};

TEST_F(Trade, MeasuresEveryPointAndSaysWhatItFound) {
  const auto report = nlohmann::json::parse(bytes_of(whole() / "report.json"));
  EXPECT_EQ(report.at("command"), "trade");
  EXPECT_EQ(report.at("trade").at("measurements"), kMeasurements);
  EXPECT_EQ(report.at("timing").at("machines").size(), 1U);
  for (const char* part : {"all scenes", "ball", "flat"}) {
    EXPECT_FALSE(report.at("timing").at("trade").at("parts").at(part).at("front").empty()) << part;
  }
  for (const char* name :
       {"trade.csv", "trade.md", "trade_ball.vl.json", "points.jsonl", "report.html"}) {
    EXPECT_TRUE(fs::exists(whole() / name)) << name;
  }
}

TEST_F(Trade, ShardsMergedAreOneRun) {
  for (const std::string shard : {"1", "2", "3"}) {
    const auto part = trade({"--shard", shard + "/3", "--out", "s" + shard});
    ASSERT_EQ(part.exit_code, 0) << part.err;
    EXPECT_FALSE(fs::exists(folder_.path() / ("s" + shard) / "trade.csv"));
    EXPECT_FALSE(fs::exists(folder_.path() / ("s" + shard) / "report.html"));
  }
  const auto early = trade(words_of("--merge s1 --merge s3 --out early"));
  expect_line(early, 2, "--merge: 8 of 24 measurements are in none");
  EXPECT_FALSE(fs::exists(at("early")));
  const auto merged = trade(words_of("--merge s3 --merge s1 --merge s2 --out merged"));
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(without_times(file("merged/trade.csv")),
            without_times(bytes_of(whole() / "trade.csv")));
}

/// Killed at any moment, it goes on where it was: no measurement is lost but the one in flight, and
/// none is made twice. WOBBLEBENCH_KILLS sets the number of kills.
TEST_F(Trade, KilledAtAnyMomentItGoesOn) {
  const char* setting = std::getenv("WOBBLEBENCH_KILLS");
  const int kills = setting == nullptr ? 4 : std::atoi(setting);
  const fs::path journal = at("killed/points.jsonl");
  const auto size = [&] {
    std::error_code none;
    const auto bytes = fs::file_size(journal, none);
    return none ? std::uintmax_t{0} : bytes;
  };
  const std::uintmax_t all = fs::file_size(whole() / "points.jsonl");
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
  EXPECT_TRUE(holds(finished.err,
                    "wobblebench: went on with " + std::to_string(measured) + " measurement"));
  const std::string last = file("killed/points.jsonl");
  EXPECT_EQ(static_cast<std::size_t>(std::count(last.begin(), last.end(), '\n')),
            kMeasurements + 2);  // the plan, the machine
  EXPECT_EQ(without_times(file("killed/trade.csv")),
            without_times(bytes_of(whole() / "trade.csv")));
}

/// The command that the page shows of a point makes the picture that was measured.
TEST_F(Trade, ThePageNamesTheCommandOfAPoint) {
  const std::string page = bytes_of(whole() / "report.html");
  const auto detail = page.find("<template class=\"detail\" data-id=\"point-0\">");
  ASSERT_NE(detail, std::string::npos);
  const std::string begin = "<pre class=\"command\">wobblebench ";
  const auto at = page.find(begin, detail) + begin.size();
  const Words words = shell_words(page.substr(at, page.find('<', at) - at));
  const auto run = report_of(bench(with(words, {{"--json"}})));
  std::istringstream csv(bytes_of(whole() / "trade.csv"));
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
  const auto column = std::ranges::find(all, "p95_mm") - all.begin();
  const double p95_mm = run.at("error").at("p95_mm");
  EXPECT_NEAR(std::stod(cells(first).at(column)), p95_mm, 1e-6 * p95_mm);
}

/// Each value is allowed alone: mid_volume with aligned sticks is not.
TEST_F(Trade, ACombinationThatIsRefusedIsAResult) {
  folder_.write("plan.toml",
                "repeats = 1\nseeds = 1\n[scenes.ball]\n" + kScene +
                    "render.preset = \"baseline\"\n"
                    "[axes]\n\"render.pipeline.mid_volume\" = [false, true]\n"
                    "\"render.reconstruction.sticks\" = [\"plain\", \"aligned\"]\n");
  EXPECT_EQ(report_of(trade({"--json"})).at("trade").at("refused_points"), 1);
  EXPECT_TRUE(holds(file("out/trade.csv"), "mid_volume = true: "));
}

TEST_F(Trade, RefusesBadInputWithOneLineBeforeAnyWork) {
  folder_.write("level.toml",
                "[scenes.ball]\n" + kScene + "[axes]\n\"render.ray_casting.steps\" = [64, 0]\n");
  folder_.write("key.toml", "[scenes.ball]\n" + kScene + "[axes]\n\"render.x.y\" = [1, 2]\n");
  expect_refusals({{"trade", "PLAN"},
                   {"trade missing.toml", "missing.toml: "},
                   {"trade level.toml", "render.ray_casting.steps = 0: "},
                   {"trade key.toml", "render.x: unknown"},
                   {"trade plan.toml --shard 0/3", "--shard = 0/3: "},
                   {"trade plan.toml --shard 4/3", "--shard = 4/3: "},
                   {"trade plan.toml --shard 1/3x", "--shard = 1/3x: "},
                   {"trade plan.toml --shard 2", "--shard = 2: "},
                   {"trade plan.toml --shard 1/2 --merge x", "--merge"},
                   {"trade plan.toml --set simulation.seed=x", "simulation.seed"}});
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
  const ProcessResult result = bench("trade drawn.toml --out out");
  expect_line(result, 0, "scene none-");
  EXPECT_TRUE(holds(result.err, "is left out: phantom.file"));
  const std::string csv = bytes_of(at("out/trade.csv"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3) << csv;  // a head and two points
  EXPECT_TRUE(holds(csv, "ball-"));
  EXPECT_FALSE(holds(csv, "none-"));
}

}  // namespace
}  // namespace wobblebench::bench
