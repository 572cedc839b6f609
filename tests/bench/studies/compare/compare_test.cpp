// Verdicts over pairs of runs, against intervals from a table of Student's t; limits; kept figures.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/studies/compare/compare_document.h"
#include "bench/studies/compare/history.h"
#include "bench/studies/compare/verdicts.h"
#include "tests/bench/cli/program_under_test.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

MeasuredSide side_of(const std::string& figure, const std::vector<double>& values) {
  MeasuredSide side{.what = "x", .gl_renderer = "llvmpipe"};
  for (std::size_t i = 0; i < values.size(); ++i) {
    side.runs.push_back({.scene = "face", .seed = i + 1, .figures = {}});
    if (!std::isnan(values[i])) side.runs.back().figures[figure] = values[i];
  }
  return side;
}

Verdict verdict_on(const ChangeLimit& limit,
                   const std::vector<double>& base,
                   const std::vector<double>& now) {
  const auto all = verdicts(side_of(limit.figure, base), side_of(limit.figure, now), {limit});
  EXPECT_EQ(all.size(), 1U);
  return all.at(0);
}

/// Differences 0.1, 0.2, 0.3: mean 0.2, deviation 0.1, t(0.975, 2) = 4.303 (tables), half 0.2484.
TEST(Compare, IntervalOfPairedDifferences) {
  const std::vector<double> base = {1, 5, 9}, now = {1.1, 5.2, 9.3};
  const Verdict open = verdict_on({"p95_mm", Allowed::worse_by, 0.1}, base, now);
  EXPECT_NEAR(open.change.mean, 0.2, 1e-12);
  EXPECT_NEAR(open.change.half, 4.303 * 0.1 / std::sqrt(3.0), 1e-4);
  EXPECT_EQ(open.outcome, Outcome::open);
  EXPECT_EQ(verdict_on({"p95_mm", Allowed::worse_by, 0.45}, base, now).outcome, Outcome::kept);
  const std::vector<double> worse = {2.1, 6.2, 10.3};
  EXPECT_EQ(verdict_on({"p95_mm", Allowed::worse_by, 0.1}, base, worse).outcome, Outcome::broken);
  EXPECT_EQ(verdict_on({"p95_mm", Allowed::worse_by, 0.1}, worse, base).outcome, Outcome::kept);
}

TEST(Compare, SignedFiguresAreJudgedInBothDirections) {
  const ChangeLimit limit{"median_mm", Allowed::changed_by, 0.05};
  // From -0.05 to 0.05 the magnitude is the same, and yet the surface has moved by 0.1 mm.
  EXPECT_EQ(verdict_on(limit, {-0.05, -0.05}, {0.05, 0.05}).outcome, Outcome::broken);
  EXPECT_EQ(verdict_on(limit, {0.05, 0.05}, {-0.05, -0.05}).outcome, Outcome::broken);
  EXPECT_EQ(verdict_on(limit, {0.05, 0.05}, {0.02, 0.02}).outcome, Outcome::kept);
}

TEST(Compare, OneFetchAmongMillionsIsAChange) {
  const ChangeLimit limit{"fetches", Allowed::equal};
  const Verdict changed = verdict_on(limit, {31936724, 5}, {31936725, 5});
  EXPECT_EQ(changed.outcome, Outcome::broken);
  EXPECT_NE(line_of(verdict_on(limit, {31936724}, {31936725})).find("31936724 to 31936725"),
            std::string::npos);
  EXPECT_EQ(verdict_on(limit, {31936724, 5}, {31936724, 5}).outcome, Outcome::kept);
}

/// Ratios 2 and 0.5: their geometric mean is 1, where the mean is 1.25.
/// Less work is no fault, and one seed's saving makes no room for another's growth.
TEST(Compare, WorkBreaksOnlyWhereItGrows) {
  const ChangeLimit limit{"fetches", Allowed::ratio, 1};
  EXPECT_EQ(verdict_on(limit, {900, 500}, {800, 400}).outcome, Outcome::kept);
  EXPECT_EQ(verdict_on(limit, {900, 500}, {900, 500}).outcome, Outcome::kept);
  EXPECT_EQ(verdict_on(limit, {31936724, 500}, {31936725, 400}).outcome, Outcome::broken);
  EXPECT_EQ(verdict_on({"fetches", Allowed::ratio, 1.1}, {100, 100}, {110, 90}).outcome,
            Outcome::kept);
  EXPECT_EQ(text_of(limit), "not more");
}

/// Of SSIM and PSNR less is worse.
TEST(Compare, ALikenessIsWorseWhereItFalls) {
  for (const char* const figure : {"ssim", "picture_ssim"}) {
    const ChangeLimit limit{figure, Allowed::worse_by, 0.01};
    EXPECT_EQ(verdict_on(limit, {0.9}, {0.8}).outcome, Outcome::broken) << figure;
    EXPECT_EQ(verdict_on(limit, {0.8}, {0.9}).outcome, Outcome::kept) << figure;
  }
}

TEST(Compare, RatiosOfTimesAreGeometric) {
  const ChangeLimit limit{"frame_ms", Allowed::ratio, 1.25};
  EXPECT_NEAR(verdict_on(limit, {100, 100}, {200, 50}).change.mean, 0, 1e-12);
  EXPECT_EQ(verdict_on(limit, {100, 100, 100}, {150, 151, 149}).outcome, Outcome::broken);
  EXPECT_EQ(verdict_on(limit, {100, 100, 100}, {110, 111, 109}).outcome, Outcome::kept);
  EXPECT_EQ(verdict_on(limit, {100}, {900}).outcome, Outcome::open);  // one pair tells nothing
}

TEST(Compare, WhatIsNotComparedSaysWhy) {
  const double none = std::nan("");
  const ChangeLimit p95{"p95_mm", Allowed::worse_by, 0.1};
  EXPECT_EQ(verdict_on(p95, {none, none}, {none, none}).why, "formed by neither side");
  EXPECT_EQ(verdict_on(p95, {none, none}, {1, 1}).outcome, Outcome::not_compared);
  EXPECT_EQ(verdict_on(p95, {1, 1}, {none, 1}).outcome, Outcome::broken);  // a surface is lost

  MeasuredSide base = side_of("fetches", {7}), now = side_of("fetches", {7});
  base.gl_renderer = "another";
  const std::vector<ChangeLimit> work = {{"fetches", Allowed::equal}};
  EXPECT_EQ(verdicts(base, now, work).at(0).why, "counted by another renderer: another");
  base = side_of("frame_ms", {1, 2});
  now = side_of("frame_ms", {3, 4});
  base.kept = true;
  const std::vector<ChangeLimit> time = {{"frame_ms", Allowed::ratio, 1}};
  EXPECT_EQ(verdicts(base, now, time).at(0).outcome, Outcome::not_compared);
  now.runs[0].seed = 8;
  now.runs[1].seed = 9;
  EXPECT_NE(verdicts(side_of("p95_mm", {1, 2}), now, {p95}).at(0).why.find("same seed"),
            std::string::npos);
}

TEST(Compare, OnlyBrokenTimesAreMeasuredAgain) {
  const auto outcome = [](const char* figure, Outcome of) {
    return Verdict{.scene = "x", .limit = {figure}, .outcome = of};
  };
  EXPECT_FALSE(only_times_are_broken({}));
  EXPECT_FALSE(only_times_are_broken({outcome("frame_ms", Outcome::kept)}));
  EXPECT_TRUE(only_times_are_broken(
      {outcome("frame_ms", Outcome::broken), outcome("p95_mm", Outcome::kept)}));
  EXPECT_FALSE(only_times_are_broken(
      {outcome("frame_ms", Outcome::broken), outcome("p95_mm", Outcome::broken)}));
}

TEST(Compare, DefaultLimitsAreThoseOfTheirFile) {
  const auto file = read_change_limits(WOBBLEBENCH_SOURCE_DIR "/docs/scenes/compare.toml");
  std::vector<std::string> read, built_in;
  for (const ChangeLimit& limit : file) read.push_back(limit.figure + " " + text_of(limit));
  for (const ChangeLimit& limit : default_change_limits()) {
    built_in.push_back(limit.figure + " " + text_of(limit));
  }
  std::ranges::sort(read);
  std::ranges::sort(built_in);
  EXPECT_EQ(read, built_in);
}

TEST(Compare, BadLimitsAreRefused) {
  const ScratchFolder folder;
  const auto file = folder.path() / "limits.toml";
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"", "[limits]: must name a figure"},
           {"[limits]\n", "[limits]: must name a figure"},
           {"[limit]\np95_mm = { worse_by = 1 }", "limit: no such section"},
           {"[limits]\np96_mm = { worse_by = 1 }", "did you mean p95_mm?"},
           {"[limits]\np95_mm = 1", "must be one of { worse_by = NUMBER }"},
           {"[limits]\np95_mm = { worse = 1 }", "must be one of"},
           {"[limits]\np95_mm = { worse_by = 1, ratio = 2 }", "must be one of"},
           {"[limits]\np95_mm = { worse_by = -1 }", "= -1: must be a number of 0 or more"},
           {"[limits]\np95_mm = { worse_by = nan }", "must be a number of 0 or more"},
           {"[limits]\nframe_ms = { ratio = 0.9 }", "must be a number of 1 or more"},
           {"[limits]\nfetches = { equal = false }", "must be true"}}) {
    std::ofstream(file) << text;
    try {
      read_change_limits(file);
      ADD_FAILURE() << text;
    } catch (const UserError& error) {
      const std::string said = error.what();
      EXPECT_TRUE(said.starts_with(file.string())) << said;
      EXPECT_NE(said.find(part), std::string::npos) << said;
    }
  }
}

TEST(Compare, FiguresSurviveBeingKept) {
  MeasuredSide side = side_of("p95_mm", {1.25, 2.5});
  side.commit = "abc";
  side.settings["face"]["render.preset"] = "\"accurate\"";
  nlohmann::ordered_json report = {{"schema", 2}, {"command", "compare"}, {"new", json_of(side)}};
  const MeasuredSide read = kept_side(report, "folder");
  EXPECT_TRUE(read.kept);
  EXPECT_EQ(read.commit, "abc");
  EXPECT_EQ(read.settings, side.settings);
  ASSERT_EQ(read.runs.size(), 2U);
  EXPECT_EQ(read.runs[1].seed, 2U);
  EXPECT_EQ(read.runs[1].figures, side.runs[1].figures);
  for (const char* text : {"[]",
                           "{}",
                           "3",
                           R"({"command": "trade"})",
                           R"({"schema": 2, "command": "compare"})",
                           R"({"schema": 2, "command": "compare", "new": {"commit": 3}})"}) {
    EXPECT_THROW((void)kept_side(nlohmann::ordered_json::parse(text), "folder"), UserError) << text;
  }
  report["schema"] = 1;
  EXPECT_THROW((void)kept_side(report, "folder"), UserError);
}

/// A commit whose P95 is this for both seeds of one scene.
HistoryRecord record_of(const std::string& commit, double p95_mm, const std::string& steps = "64") {
  HistoryRecord record{"2026-01-0" + commit, side_of("p95_mm", {p95_mm, p95_mm})};
  record.side.commit = commit;
  record.side.settings[record.side.runs.front().scene]["render.ray_casting.steps"] = steps;
  return record;
}

TEST(Compare, HistoryHoldsTheNewestAgainstTheMedianOfWhatWasMeasuredAlike) {
  const MeasuredSide now = record_of("4", 1.25).side;
  const std::vector<HistoryRecord> history = {record_of("1", 0.9),
                                              record_of("2", 1.0),
                                              record_of("3", 1.1),
                                              record_of("5", 9.0, "32"),
                                              record_of("4", 9.0)};
  const MeasuredSide base = median_side(before(history, now), now);
  EXPECT_TRUE(base.kept);
  EXPECT_EQ(base.what, "median of 3 earlier commits");
  ASSERT_EQ(base.runs.size(), 2U);
  EXPECT_DOUBLE_EQ(base.runs.front().figures.at("p95_mm"), 1.0);
  const std::vector<ChangeLimit> limits = {{"p95_mm", Allowed::worse_by, 0.2}};
  EXPECT_EQ(verdicts(base, now, limits).front().outcome, Outcome::broken);
  const std::vector<Figure> figures = history_figures(before(history, now), base, now, limits);
  ASSERT_EQ(figures.size(), 1U);
  const auto& chart = std::get<Chart>(figures.front().panels.at(0));
  EXPECT_EQ(chart.x.names, (std::vector<std::string>{"1", "2", "3", "4"}));
  EXPECT_EQ(chart.series.at(1).y, (std::vector<double>{1.2, 1.2}));
}

TEST(Compare, HistorySurvivesBeingWritten) {
  const ScratchFolder folder;
  EXPECT_TRUE(read_history(folder.path() / "none").empty());
  for (const auto& record : {record_of("2", 1.0), record_of("1", 1.5), record_of("2", 2, "32")}) {
    write_record(folder.path() / "kept", record);
  }
  const std::vector<HistoryRecord> read = read_history(folder.path() / "kept");
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read.front().side.commit, "1");
  EXPECT_EQ(read.front().side.runs[1].figures.at("p95_mm"), 1.5);
  std::ofstream(folder.path() / "kept/other.json") << "{}";
  EXPECT_THROW((void)read_history(folder.path() / "kept"), UserError);
}

// ---- the command, on a small scene

const char* const kScene =
    "phantom = { name = \"sphere\", voxel_mm = 2 }\n"
    "acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }\n"
    "render.scan_conversion.slice_size = 64\n"
    "render.ray_casting.image_size = 64\n";

class CompareCommand : public testing::Test {
 protected:
  CompareCommand() { std::ofstream(folder_.path() / "ball.toml") << kScene; }

  ProcessResult compare(std::vector<std::string> words) const {
    words.insert(words.begin(), "compare");
    return run_process(WOBBLEBENCH_PROGRAM, words, folder_.path());
  }
  std::string text_of(const std::string& file) const { return read_file(folder_.path() / file); }

  ScratchFolder folder_;
};

TEST_F(CompareCommand, EqualSidesAreEqualInEveryDigit) {
  std::filesystem::copy(folder_.path() / "ball.toml", folder_.path() / "ball:<?.toml");
  const auto result = compare({"this",
                               WOBBLEBENCH_PROGRAM,
                               "--scene",
                               "ball:<?.toml",
                               "--seeds",
                               "2",
                               "--limits",
                               WOBBLEBENCH_SOURCE_DIR "/tests/bench/studies/compare/limits.toml",
                               "--out",
                               "same",
                               "--junit",
                               "checks.xml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(text_of("same/report.json"));
  int equal = 0;
  for (const auto& verdict : report["verdicts"]) {
    EXPECT_EQ(verdict["outcome"], "kept") << verdict;
    EXPECT_EQ(verdict["change"], 0) << verdict;
    ++equal;
  }
  EXPECT_EQ(equal, 6);
  EXPECT_NE(text_of("checks.xml").find("ball:&lt;?"), std::string::npos);
  // What keeps the artefacts of continuous integration refuses the name of the scene.
  for (const std::string name : {"new_ball____surface.png", "base_ball____error.png"}) {
    EXPECT_NE(text_of("same/" + name), "");
  }
  EXPECT_NE(text_of("same/compare.md").find("the same settings"), std::string::npos);
}

TEST_F(CompareCommand, AKeptBaseTellsAChangedSetting) {
  const std::vector<std::string> scene = {"--scene", "ball.toml", "--seeds", "2"};
  auto words = scene;
  words.insert(words.begin(), "this");
  words.insert(words.end(), {"--out", "base"});
  ASSERT_EQ(compare(words).exit_code, 0);
  const auto result = compare({"base",
                               "this",
                               "--scene",
                               "ball.toml",
                               "--new-set",
                               "render.smoothing.filter_size=5",
                               "--out",
                               "new"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("wobblebench: ball: picture_ssim 1 to 0."), std::string::npos)
      << result.err;
  EXPECT_EQ(result.err.find("fetches"), std::string::npos) << "there are fewer: " << result.err;
  EXPECT_TRUE(result.out.starts_with("1 of 14 limits BROKEN, ")) << result.out;
  // What broke is the first of the large figures.
  EXPECT_NE(
      text_of("new/compare.md").find("filter_size=5`\n\n- **likeness of the pictures, ball** 0."),
      std::string::npos)
      << text_of("new/compare.md");
  EXPECT_NE(text_of("new/compare.md").find("| ball | `render.smoothing.filter_size` | `9` | `5` |"),
            std::string::npos);
}

TEST_F(CompareCommand, AKeptBaseIsOfItsOwnBody) {
  const std::vector<std::string> small = {
      "--scene", "ball.toml", "--set", "phantom.radius_mm=21", "--seeds", "1"};
  const auto with = [&](std::vector<std::string> words, std::size_t settings) {
    words.insert(words.end(), small.begin(), small.begin() + static_cast<long>(settings));
    return words;
  };
  ASSERT_EQ(compare(with({"this", "--out", "base"}, 6)).exit_code, 0);
  const auto same = compare(with({"base", "this", "--out", "same"}, 4));
  EXPECT_EQ(same.exit_code, 0) << same.err;
  const auto other = compare(with({"base", "this", "--out", "other"}, 2));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(
      other.err.find("ball: phantom.radius_mm = 20.0, but BASE = base was measured with 21.0"),
      std::string::npos)
      << other.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "other"));
}

TEST_F(CompareCommand, BadSidesAreRefused) {
  std::filesystem::create_directory(folder_.path() / "empty");
  for (const auto& [words, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"nothing", "this"}, "base = nothing: must be \"this\""},
           {{"/bin/false", "this"}, "is no program wobblebench"},
           {{"empty", "this"}, "empty: has no report.json"},
           {{"this", "this", "--new-set", "render.smoothing.filter_size=4"}, "filter_size"},
           {{"this", "--limits", "x.toml"}, "x.toml: no such file"},
           {{"this", "--new-set", "a=b"}, "there is no NEW"},
           {{"this", "this", "--history", "kept"}, "--history: acts without NEW"},
           {{"this", "--history", "ball.toml"}, "--history = ball.toml: is no folder"},
           {{"this", "--scene", "a?.toml", "--scene", "a*.toml"}, "scene is called a?, too"}}) {
    auto line = words;
    line.insert(line.end(), {"--scene", "ball.toml"});
    const auto result = compare(line);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out/report.json"));
  }
}

}  // namespace
}  // namespace wobblebench::bench
