// Fault plans, injected faults, and the board's counts of the resulting losses.
#include "hw/link/fault_link.h"

#include <gtest/gtest.h>

#include <set>

#include "base/options.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

std::unique_ptr<FaultLink> faulty(const AcquisitionPlan& plan,
                                  const std::string& faults,
                                  std::uint64_t chunk_seed = 0) {
  return std::make_unique<FaultLink>(
      std::make_unique<MemoryLink>(stream_of(plan), MemoryLinkOptions{.chunk_seed = chunk_seed}),
      parse_faults(faults));
}

struct Outcome {
  Collected seen;
  BoardAccount account;
  Event last = TimedOut{};
  std::vector<FaultEvent> events;
};

Outcome run(const AcquisitionPlan& plan, const std::string& faults) {
  auto link = faulty(plan, faults, 7);
  const FaultLink& faults_of = *link;
  Board board(std::move(link));
  board.start();
  Outcome outcome;
  outcome.last = collect(board, outcome.seen);
  board.stop();
  outcome.account = board.account();
  outcome.events = faults_of.events();
  EXPECT_TRUE(outcome.account.balanced());
  for (const Stick& stick : outcome.seen.sticks) EXPECT_TRUE(is_genuine(plan, stick));
  return outcome;
}

/// Sequence numbers of the sticks with a kind of fault.
std::set<std::uint64_t> affected(const Outcome& outcome, FaultKind kind) {
  std::set<std::uint64_t> sequences;
  for (const FaultEvent& event : outcome.events) {
    if (event.kind == kind && event.packet_kind == PacketKind::stick) {
      sequences.insert(event.sequence);
    }
  }
  return sequences;
}

TEST(FaultPlan, ParsesEveryTerm) {
  const FaultPlan plan =
      parse_faults("drop:0.25+unplug@17+seed:9+delay_ms:2+stall_ms:40+corrupt@3");
  ASSERT_EQ(plan.faults.size(), 3U);
  EXPECT_EQ(plan.seed, 9U);
  EXPECT_EQ(plan.delay, std::chrono::milliseconds(2));
  EXPECT_EQ(plan.stall, std::chrono::milliseconds(40));
  EXPECT_EQ(parse_faults("stall_ms:0.25").stall, std::chrono::microseconds(250));
  EXPECT_TRUE(plan.affects(FaultKind::unplug, 17));
  EXPECT_FALSE(plan.affects(FaultKind::unplug, 16));
  EXPECT_TRUE(plan.affects(FaultKind::corrupt, 3));
  int drops = 0;
  for (std::uint64_t packet = 0; packet < 100000; ++packet) {
    drops += plan.affects(FaultKind::drop, packet);
  }
  EXPECT_NEAR(drops, 25000, 5 * std::sqrt(100000 * 0.25 * 0.75)) << "five deviations";
}

TEST(FaultPlan, RejectsInvalidTerms) {
  for (const char* text : {"",
                           "drop",
                           "drop:",
                           "drop:2",
                           "drop:-0.1",
                           "drop:nan",
                           "drop@x",
                           "drop@-1",
                           "colour:0.1",
                           "seed:1.5",
                           "stall_ms:70000",
                           "drop:0.1+",
                           "drop:0.1 "}) {
    EXPECT_THROW(parse_faults(text), InvalidOption) << text;
  }
}

TEST(FaultLink, FaultsDoNotDependOnReadSizes) {
  const AcquisitionPlan plan = small_plan(20);
  const std::string faults = "drop:0.1+corrupt:0.1+truncate:0.1+duplicate:0.1+reorder:0.1+seed:5";
  const Bytes whole = all_bytes(*faulty(plan, faults), 65536);
  EXPECT_EQ(all_bytes(*faulty(plan, faults, 3), 100), whole);
  EXPECT_EQ(all_bytes(*faulty(plan, faults + "+short_reads:1", 4), 64), whole);
  EXPECT_NE(all_bytes(*faulty(plan, faults + "+seed:6"), 65536), whole);
}

TEST(FaultLink, ZeroRateChangesNothing) {
  const AcquisitionPlan plan = small_plan(5);
  EXPECT_EQ(all_bytes(*faulty(plan, "drop:0"), 999), stream_of(plan));
}

TEST(FaultLink, DropsAreLinkLosses) {
  const AcquisitionPlan plan = small_plan(30);
  const Outcome outcome = run(plan, "drop:0.05+seed:3");
  const auto lost = affected(outcome, FaultKind::drop);
  EXPECT_GT(lost.size(), 5U);
  // A stick dropped at the end of the stream could not be detected.
  EXPECT_EQ(outcome.account.lost.link, lost.size());
  EXPECT_EQ(outcome.account.lost.total(), lost.size());
  for (const Stick& stick : outcome.seen.sticks) EXPECT_FALSE(lost.contains(stick.sequence));
}

TEST(FaultLink, DamageIsCorrupt) {
  const AcquisitionPlan plan = small_plan(30);
  for (const std::string kind : {"corrupt", "truncate"}) {
    const Outcome outcome = run(plan, kind + ":0.05+seed:3");
    const auto lost =
        affected(outcome, kind == "corrupt" ? FaultKind::corrupt : FaultKind::truncate);
    EXPECT_GT(lost.size(), 5U);
    EXPECT_EQ(outcome.account.lost.corrupt, lost.size()) << kind;
    EXPECT_EQ(outcome.account.lost.total(), lost.size()) << kind;
  }
}

TEST(FaultLink, RepeatedSticksAreDuplicatesAndLateOnesOutOfOrder) {
  const AcquisitionPlan plan = small_plan(30);
  const Outcome twice = run(plan, "duplicate:0.1+seed:3");
  EXPECT_EQ(twice.account.duplicates, affected(twice, FaultKind::duplicate).size());
  EXPECT_EQ(twice.account.delivered, 360U);
  const Outcome late = run(plan, "reorder:0.05+seed:4");
  EXPECT_GT(late.account.lost.out_of_order, 5U);
  EXPECT_LE(late.account.lost.out_of_order, affected(late, FaultKind::reorder).size());
  EXPECT_EQ(late.account.lost.total(), late.account.lost.out_of_order);
}

TEST(FaultLink, UnpluggedDeviceIsLostAfterEarlierPackets) {
  const Outcome outcome = run(small_plan(2), "unplug@9");
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(outcome.last));
  EXPECT_EQ(std::get<DeviceLost>(outcome.last).reason, "the device is gone (a fault, at packet 9)");
  EXPECT_EQ(outcome.seen.sticks.size(), 8U) << "packet 0 is the configuration";
}

TEST(FaultLink, StallKeepsDeadlinesAndLosesNothing) {
  const AcquisitionPlan plan = small_plan(1);
  auto link = faulty(plan, "stall@4+stall_ms:30");
  Bytes got, buffer(65536);
  const auto start = HostClock::now();
  bool timed_out = false;
  for (;;) {
    const ReadResult result = link->read(buffer, HostClock::now() + std::chrono::milliseconds(5));
    timed_out |= result.status == ReadStatus::timeout;
    got.insert(got.end(), buffer.begin(), buffer.begin() + std::ptrdiff_t(result.bytes));
    if (result.status == ReadStatus::end_of_stream) break;
  }
  EXPECT_TRUE(timed_out);
  EXPECT_GE(HostClock::now() - start, std::chrono::milliseconds(30));
  EXPECT_EQ(got, stream_of(plan));
}

TEST(FaultLink, DamageOfTheInnerLinkIsUnchanged) {
  Bytes stream = stream_of(small_plan(3));
  for (std::size_t i = 500; i < 700; ++i) stream[i] = std::byte{0x5A};
  stream.resize(stream.size() - 13);
  FaultLink link(std::make_unique<MemoryLink>(stream, MemoryLinkOptions{.chunk_seed = 3}),
                 parse_faults("drop:0"));
  EXPECT_EQ(all_bytes(link, 333), stream);
}

}  // namespace
}  // namespace wobblebench::hw
