// The front, its knees, effects, and the journal of the command `trade`, against known answers.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>

#include "base/user_error.h"
#include "bench/results/error.h"
#include "bench/studies/trade/trade_analysis.h"
#include "bench/studies/trade/trade_study.h"
#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

using testing_support::bytes_of;

MeanInterval exactly(double value) {
  return {value, 0, 1};
}

TradeScore score(std::size_t point, double time, double p95_mm, double wrong_percent) {
  TradeScore result;
  result.point = point;
  result.volume_ratio = time;
  result.measures.assign(traded().size(), exactly(0));
  result.measures[trade_measure("p95_mm")] = exactly(p95_mm);
  result.measures[trade_measure("missed_or_false_percent")] = exactly(wrong_percent);
  result.scenes = {{result, 0}};
  return result;
}

TEST(TradeFront, HoldsWhatNoOtherBeats) {
  const std::vector<TradeScore> scores = {score(0, 1, 5, 5),
                                          score(1, 2, 3, 5),
                                          score(2, 2, 4, 5),  // as slow as 1, and worse
                                          score(3, 3, 6, 1),  // finds more
                                          score(4, 0.5, std::nan(""), 40),
                                          score(5, 9, 3, 5)};  // slower than 1
  EXPECT_EQ(trade_front(scores), (std::vector<std::size_t>{0, 1, 3}));
}

/// What misses most of the surface has the least P95 of what is left.
TEST(TradeFront, IsOfPointsThatFindTheSurfaceOnEveryScene) {
  std::vector<TradeScore> scores = {score(0, 1, 5, 5), score(1, 0.5, 0.4, 37.6)};
  EXPECT_EQ(trade_front(scores), (std::vector<std::size_t>{0}));
  scores.push_back(score(2, 1, 4, 4));  // a mean of 1 and 7
  scores.back().scenes = {{score(2, 1, 1, 1), 0}, {score(2, 1, 7, 7), 1}};
  EXPECT_EQ(scores.back().worst(error::kP95).scene, 1U);
  EXPECT_EQ(trade_front(scores), (std::vector<std::size_t>{0}));
  scores.erase(scores.begin());
  EXPECT_EQ(trade_front(scores), (std::vector<std::size_t>{0, 1})) << "none finds it";
  EXPECT_TRUE(trade_knees(scores, trade_front(scores)).empty());
}

/// P95 = 8 / time up to time 4, and 4 / sqrt(time) beyond: one per cent of time takes 1 %, then
/// half a per cent.
TEST(TradeKnees, AreWhereTheSlopeChanges) {
  std::vector<TradeScore> scores;
  for (const double time : {1.0, 2.0, 4.0, 8.0, 16.0}) {
    scores.push_back(
        score(scores.size(), time, time <= 4 ? 8 / time : 4 / std::sqrt(time), 1 / time));
  }
  scores.push_back(score(scores.size(), 3, 7, 0.01));  // on the front, above the hull
  const auto front = trade_front(scores);
  ASSERT_EQ(front.size(), scores.size());
  const auto knees = trade_knees(scores, front);
  ASSERT_EQ(knees.size(), 1U);
  EXPECT_EQ(scores[knees[0].score].volume_ratio, 4);
  EXPECT_NEAR(knees[0].gain_before, 1, 1e-9);
  EXPECT_NEAR(knees[0].gain_after, 0.5, 1e-9);
}

/// With most of the surface missing, what is left may be as near as one likes.
TEST(TradeKnees, AreNotOfPicturesThatMissTheSurface) {
  std::vector<TradeScore> scores = {
      score(0, 1, 8, 1), score(1, 2, 4, 1), score(2, 8, 3, 1), score(3, 2, 0.1, 40)};
  const auto knees = trade_knees(scores, trade_front(scores));
  ASSERT_EQ(knees.size(), 1U);
  EXPECT_EQ(scores[knees[0].score].point, 1U);
}

/// Two settings of two levels and one of three, 40 times each combination.
TradeWork full_design() {
  TradeWork work;
  work.plan.axes = {{"a.a", {"0", "1"}, {}}, {"a.b", {"0", "1"}, {}}, {"a.c", {"0", "1", "2"}, {}}};
  for (int i = 0; i < 480; ++i) {
    work.points.push_back({{}, {i % 2, i / 2 % 2, i / 4 % 3}});
  }
  return work;
}

/// y = 10 + 3 a + 2 a b, a and b +1 or -1, and unit noise: variances 9, 0, 4 and 1. The axis c does
/// nothing.
TEST(TradeEffects, AreThoseThatTheResponseWasMadeWith) {
  const TradeWork work = full_design();
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  std::vector<TradeScore> scores;
  for (std::size_t i = 0; i < work.points.size(); ++i) {
    const auto& levels = work.points[i].levels;
    const double a = 2 * levels[0] - 1, b = 2 * levels[1] - 1;
    scores.push_back(score(i, 1, 10 + 3 * a + 2 * a * b + noise(random), 0));
  }
  const auto shares = variance_shares(work, scores, TradeResponse::p95_mm);
  ASSERT_EQ(shares.size(), 6U);
  const double expected[] = {9. / 14, 0, 0, 4. / 14, 0, 0};  // a, b, c, ab, ac, bc
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(shares[i].share, expected[i], 0.02) << i;
    EXPECT_LT(shares[i].half, 0.06) << i;
    EXPECT_LT(std::abs(shares[i].share - expected[i]), 1.6 * shares[i].half) << i;
  }
  const auto effects = level_effects(work, scores, TradeResponse::p95_mm);
  ASSERT_EQ(effects.size(), 7U);
  EXPECT_NEAR(effects[1].effect.mean, 6, 2 * effects[1].effect.half);
  EXPECT_TRUE(effects[1].effect.differs_from_zero());
  EXPECT_NEAR(effects[5].effect.mean, 0, 2 * effects[5].effect.half);
}

TEST(TradePlansOfTheDocs, AreValidInEveryLevelOfEveryAxis) {
  for (const char* name : {"trade.toml", "trade_scan.toml", "trade_requests.toml"}) {
    TradeWork work;
    work.plan =
        load_trade_plan(std::filesystem::path(WOBBLEBENCH_SOURCE_DIR) / "docs/scenes" / name);
    EXPECT_NO_THROW(check_trade(work)) << name;
  }
}

TEST(TradeShards, AreAllOfTheWorkAndNothingTwice) {
  std::vector<TradeUnit> units;
  for (std::size_t i = 0; i < 101; ++i) units.push_back({0, i, 0});
  for (const int count : {1, 2, 7, 101, 200}) {
    std::vector<TradeUnit> together;
    for (int i = 1; i <= count; ++i) {
      const auto shard = trade_shard(units, i, count);
      together.insert(together.end(), shard.begin(), shard.end());
    }
    EXPECT_EQ(together, units) << count;
  }
}

class Journal : public testing_support::FolderTest {
 protected:
  /// A journal syncs each line that it writes.
  Journal() : FolderTest(testing_support::folder_in_memory()) {}

  static TradeRecord record(std::size_t point) {
    TradeRecord result{{}, {1, point, 2}, {}, {}};
    result.measures.assign(traded().size(), 0.1 * static_cast<double>(point) + 1. / 3);
    result.measures.back() = std::nan("");
    result.volume_ratio = 1. / 7;
    return result;
  }
  std::filesystem::path file() const { return folder_ / TradeJournal::kFile; }
  /// As a new file: a file system on a disk waits for it where an old one is cut.
  void replace_file(const std::string& bytes) const {
    std::filesystem::remove(file());
    std::ofstream(file(), std::ios::binary) << bytes;
  }
  /// The file of a journal of three records.
  std::string three_records() const {
    TradeJournal journal(folder_, "plan");
    journal.append_machine("this one");
    for (std::size_t i = 0; i < 3; ++i) journal.append(record(i));
    return bytes_of(file());
  }
  /// Reads the file with these bytes. Returns the number of records, each of which must be the one
  /// that was appended; nullopt: the file was refused.
  std::optional<std::size_t> read_changed(const std::string& bytes) const {
    replace_file(bytes);
    try {
      const TradeContent content = read_trade_journal(folder_, "plan", "--merge");
      TradeRecords expected;
      for (const auto& [unit, unused] : content.records) expected.emplace(unit, record(unit.point));
      EXPECT_EQ(text_of(content.records), text_of(expected));
      return content.records.size();
    } catch (const UserError&) {
      return std::nullopt;
    }
  }
  void expect_refused(const std::string& reason) const {
    EXPECT_TRUE(
        holds(refusal_of<UserError>([&] { const TradeJournal journal(folder_, "plan"); }), reason));
  }
};

TEST_F(Journal, GivesBackWhatItWasGiven) {
  {
    TradeJournal journal(folder_, "plan");
    journal.append_machine("this one");
    for (std::size_t i = 0; i < 3; ++i) journal.append(record(i));
    journal.append({{}, {1, 9, 2}, "x = 3: must be \"even\"", {}});
  }
  const TradeJournal again(folder_, "plan");
  ASSERT_EQ(again.records().size(), 4U);
  EXPECT_EQ(again.file().machines(), std::set<std::string>{"this one"});
  const TradeRecord& second = again.records().at({1, 1, 2});
  EXPECT_EQ(second.measures.front(), record(1).measures.front());
  EXPECT_TRUE(std::isnan(second.measures.back()));
  EXPECT_EQ(second.volume_ratio, 1. / 7);
  EXPECT_EQ(again.records().at({1, 9, 2}).refused, "x = 3: must be \"even\"");
}

/// Cut at any byte, as by a kill, it loses at most the record that was being written.
TEST_F(Journal, CutAtAnyByteItLosesTheLastRecordAtMost) {
  {
    TradeJournal journal(folder_, "plan");
    for (std::size_t i = 0; i < 3; ++i) journal.append(record(i));
  }
  const std::string whole = bytes_of(file());
  for (std::size_t bytes = 0; bytes <= whole.size(); ++bytes) {
    const std::string left = whole.substr(0, bytes);
    replace_file(left);
    const auto lines = std::count(left.begin(), left.end(), '\n');
    {
      TradeJournal journal(folder_, "plan");
      ASSERT_EQ(journal.records().size(), static_cast<std::size_t>(std::max(0L, lines - 1)));
      for (std::size_t i = 0; i < 3; ++i) journal.append(record(i));
    }
    ASSERT_EQ(bytes_of(file()), whole) << bytes;
  }
}

void flip(std::string& bytes, std::size_t bit) {
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
}

/// A changed bit is found wherever it is, but for the end of the last line, which makes that line
/// one that is not finished.
TEST_F(Journal, EveryChangedBitIsFound) {
  const std::string whole = three_records();
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string changed = whole;
    flip(changed, bit);
    const auto records = read_changed(changed);
    if (bit / 8 == whole.size() - 1) {
      ASSERT_EQ(records, 2U) << "bit " << bit;
    } else {
      ASSERT_EQ(records, std::nullopt) << "bit " << bit;
    }
  }
}

/// Several bits, bytes and cuts at random: refused, or each record that is read is as it was.
TEST_F(Journal, WhateverHappensToItNoRecordIsReadAsAnother) {
  const std::string whole = three_records();
  std::mt19937_64 random(11);
  for (int i = 0; i < 4000; ++i) {
    std::string changed = whole;
    for (auto n = random() % 6; n-- > 0;) flip(changed, random() % (8 * changed.size()));
    if (random() % 3 == 0) changed.resize(random() % changed.size());
    if (random() % 3 == 0) changed.insert(random() % (changed.size() + 1), 1, '\n');
    if (random() % 3 == 0 && !changed.empty()) {
      const std::size_t at = random() % changed.size();
      changed.erase(at, random() % 400);
    }
    static_cast<void>(read_changed(changed));
    ASSERT_FALSE(HasFailure()) << changed;
  }
}

TEST_F(Journal, WhatIsNoRegularFileIsRefusedAndNotWaitedFor) {
  const auto refused = [&](const std::string& reason) {
    expect_refused(reason);
    if (reason != "hard link") {
      EXPECT_THROW(read_trade_journal(folder_, "plan", "--merge"), UserError) << reason;
    }
    std::filesystem::remove(file());
  };
  ASSERT_EQ(::mkfifo(file().c_str(), 0600), 0);
  refused("is no regular file");
  std::filesystem::create_directory(file());
  refused("is a folder");
  std::filesystem::create_symlink("/dev/zero", file());
  refused("is a symbolic link");
  std::filesystem::create_symlink("/dev/zero", folder_ / "link");
  std::ofstream(folder_ / "victim") << "";
  std::filesystem::create_hard_link(folder_ / "victim", file());
  refused("hard link");
  EXPECT_EQ(bytes_of(folder_ / "victim"), "");
}

/// Of a file that is not a journal, be it without the end of a line, nothing is taken off.
TEST_F(Journal, AFileOfAnotherKindStaysAsItIs) {
  for (const char* text : {"notes", "notes\n", "{\"scene\":1}\n", "\n"}) {
    replace_file(text);
    expect_refused("is no journal of measurements");
    EXPECT_EQ(bytes_of(file()), text);
  }
  replace_file("{\"schema\":\"wobblebench.trade.points/1\",\"plan\":\"plan\"}\n");
  expect_refused("earlier version");
}

/// A refused --merge, or a command that was stopped before its first measurement, binds no folder
/// to its plan.
TEST_F(Journal, WithoutAMeasurementItIsOfNoPlan) {
  { const TradeJournal journal(folder_, "plan"); }
  EXPECT_FALSE(std::filesystem::exists(file()));
  TradeJournal(folder_, "plan").append_machine("this one");
  TradeJournal(folder_, "another").append(record(1));
  const TradeContent content = read_trade_journal(folder_, "another", "--merge");
  EXPECT_EQ(content.records.size(), 1U);
  EXPECT_TRUE(content.machines.empty());
}

TEST_F(Journal, OfAVersionThatMeasuredOtherFiguresIsRefused) {
  JournalFile(folder_,
              {TradeJournal::kFile, "wobblebench.trade.points/2", "plan"},
              [](const nlohmann::ordered_json&) {})
      .append({{"scene", 0}});
  expect_refused("was written by another version of the program; give another folder");
}

TEST_F(Journal, OfAnotherPlanIsRefusedAndStaysAsItIs) {
  TradeJournal(folder_, "plan").append(record(0));
  const auto size = std::filesystem::file_size(file());
  EXPECT_THROW(TradeJournal(folder_, "another"), UserError);
  EXPECT_THROW(read_trade_journal(folder_, "another", "--merge"), UserError);
  EXPECT_THROW(read_trade_journal(folder_ / "none", "plan", "--merge"), UserError);
  EXPECT_EQ(std::filesystem::file_size(file()), size);
}

}  // namespace
}  // namespace wobblebench::bench
