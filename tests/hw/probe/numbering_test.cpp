// Numbers of sticks up to the last of 64 bits, against integers that do not wrap.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/wire/stream_audit.h"
#include "hw/wire/unreadable_stream.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

/// Nothing below comes near its end.
__extension__ using Wide = __int128;

constexpr Wide kTwo32 = Wide{1} << 32;
constexpr Wide kTwo64 = Wide{1} << 64;

AcquisitionPlan plan_of(int frames, int lines, MotorMode motor) {
  AcquisitionOptions acquisition;
  acquisition.frames_per_volume = frames;
  acquisition.sticks_per_frame = lines;
  acquisition.motor = motor;
  return {{}, acquisition};
}

std::vector<AcquisitionPlan> plans() {
  std::vector<AcquisitionPlan> all;
  for (const MotorMode motor : kMotorModes) {
    for (const auto& [frames, lines] : {std::pair{1, 1}, {3, 4}, {37, 64}, {7, 1}, {1024, 1024}}) {
      all.push_back(plan_of(frames, lines, motor));
    }
  }
  return all;
}

/// Numbers of 64 bits around the powers of two, and around the plan's own end.
std::vector<std::uint64_t> edges(const AcquisitionPlan& plan) {
  const Wide sticks = plan.sticks_per_volume();
  std::vector<std::uint64_t> numbers;
  for (const Wide edge : {Wide{0}, kTwo32, Wide{1} << 52, Wide{1} << 63, kTwo64, kTwo32 * sticks}) {
    for (Wide by = -2 * sticks; by <= 2 * sticks; by += by < -3 || by >= 3 ? sticks - 1 : 1) {
      if (edge + by < 0 || edge + by >= kTwo64) continue;
      numbers.push_back(static_cast<std::uint64_t>(edge + by));
      if (sticks == 1 && by > 3) break;
    }
  }
  return numbers;
}

struct WideIndex {
  Wide volume, frame, line;
};

WideIndex index_of(const AcquisitionPlan& plan, Wide sequence) {
  const Wide frames = plan.acquisition().frames_per_volume;
  const Wide lines = plan.acquisition().sticks_per_frame;
  const Wide volume = sequence / (frames * lines);
  const Wide order = sequence / lines - volume * frames;
  const bool back = plan.acquisition().motor == MotorMode::alternating && volume % 2 == 1;
  return {volume, back ? frames - 1 - order : order, sequence % lines};
}

TEST(Numbering, IndexIsThatOfUnboundedIntegersOrRefused) {
  for (const AcquisitionPlan& plan : plans()) {
    for (const std::uint64_t sequence : edges(plan)) {
      const WideIndex expected = index_of(plan, sequence);
      if (expected.volume >= kTwo32) {
        ASSERT_THROW(plan.index(sequence), std::out_of_range) << sequence;
        continue;
      }
      const StickIndex index = plan.index(sequence);
      EXPECT_TRUE(index.volume == expected.volume && index.frame == expected.frame &&
                  index.line == expected.line)
          << sequence;
      EXPECT_EQ(plan.sequence(index), sequence);
    }
  }
}

TEST(Numbering, SequenceRefusesWhatThePlanDoesNotHave) {
  const AcquisitionPlan plan = plan_of(3, 4, MotorMode::alternating);
  EXPECT_THROW(plan.sequence({1, 3, 0}), std::out_of_range) << "would wrap: F - 1 - frame";
  EXPECT_THROW(plan.sequence({0, 3, 0}), std::out_of_range);
  EXPECT_THROW(plan.sequence({0, 0, 4}), std::out_of_range);
  EXPECT_EQ(plan.sequence({0xFFFFFFFF, 0, 3}), (std::uint64_t{1} << 32) * 12 - 1);
}

/// Depth, speed and fly-back are sums of powers of two, so that a period is a whole number of ns.
TEST(Numbering, TimesAreThoseOfUnboundedIntegers) {
  for (const MotorMode motor : kMotorModes) {
    AcquisitionOptions acquisition;
    acquisition.depth_m = 0.125;
    acquisition.sound_speed_m_s = 1600;
    acquisition.dead_time_s = 0x1p-7;
    acquisition.fly_back_s = 0.25;
    acquisition.motor = motor;
    const AcquisitionPlan plan({}, acquisition);
    const Wide period_ns = 156250 + 7812500;
    const Wide fly_back_ns = motor == MotorMode::fly_back ? 250000000 : 0;
    for (const std::uint64_t sequence : edges(plan)) {
      const Wide exact =
          Wide{sequence} * period_ns + Wide{sequence} / plan.sticks_per_volume() * fly_back_ns;
      const Wide most = std::numeric_limits<std::int64_t>::max();
      const Wide time = plan.stick_time(sequence).time_since_epoch().count();
      const Wide error = time - std::min(exact, most);
      EXPECT_LE(error < 0 ? -error : error, exact < (Wide{1} << 53) ? 0 : 2) << sequence;
    }
  }
}

/// A stick whose index would be right if the volume's number wrapped.
Stick wrapped_stick(const AcquisitionPlan& plan, std::uint64_t sequence) {
  const WideIndex index = index_of(plan, sequence);
  Stick stick{.sequence = sequence,
              .index = {static_cast<std::uint32_t>(index.volume % kTwo32),
                        static_cast<std::uint32_t>(index.frame),
                        static_cast<std::uint32_t>(index.line)}};
  stick.samples.resize(static_cast<std::size_t>(plan.acquisition().samples_per_stick));
  return stick;
}

TEST(Numbering, TheAuditAcceptsNoStickOfAVolumeThatCannotBe) {
  for (const AcquisitionPlan& plan : plans()) {
    for (const std::uint64_t sequence : edges(plan)) {
      if (sequence == std::numeric_limits<std::uint64_t>::max()) continue;  // not decoded
      StreamAudit audit;
      audit.take(configuration_of(plan, 0));
      const bool possible = index_of(plan, sequence).volume < kTwo32;
      EXPECT_EQ(audit.take(wrapped_stick(plan, sequence)).accepted, possible) << sequence;
      EXPECT_EQ(audit.account().emitted, possible ? sequence : 0U);
    }
  }
}

TEST(Numbering, AConfigurationThatContradictsItselfMovesNoNumber) {
  const AcquisitionPlan plan = small_plan();
  for (const std::uint64_t sequence : {12ULL, 1ULL << 32U, 1ULL << 63U, ~0ULL}) {
    StreamAudit audit;
    audit.take(configuration_of(plan, 0));
    ConfigurationPacket wrong = configuration_of(plan, 0);
    wrong.sequence = sequence;
    EXPECT_TRUE(audit.take(wrong).contradicts);
    EXPECT_TRUE(audit.take(test_stick(plan, 0)).accepted) << sequence;
    EXPECT_EQ(audit.account().emitted, 0U);
  }
}

TEST(Numbering, BeforeAnyConfigurationANumberThatNoPlanHasIsIgnored) {
  const AcquisitionPlan plan = small_plan();
  StreamAudit audit;
  EXPECT_TRUE(audit.take(VolumeEndPacket{.sequence = ~0ULL}).contradicts);
  EXPECT_TRUE(audit.take(wrapped_stick(plan, ~0ULL - 1)).contradicts);
  audit.take(configuration_of(plan, 0));
  EXPECT_TRUE(audit.take(test_stick(plan, 0)).accepted);
}

/// Streams follow each other, each with 2^52 sticks that never came.
TEST(Numbering, CountsEndBeforeTheyWrap) {
  const AcquisitionPlan plans[] = {plan_of(1024, 1024, MotorMode::stepped),
                                   plan_of(1024, 1024, MotorMode::continuous)};
  const std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
  StreamAudit audit;
  const auto play = [&](int streams) {
    for (int i = 0; i < streams; ++i) {
      const AcquisitionPlan& plan = plans[i % 2];
      audit.take(configuration_of(plan, 0));
      audit.take(configuration_of(plan, last));
      ASSERT_TRUE(audit.account().balanced());
      ASSERT_EQ(Wide{audit.account().emitted}, (i + 1) * Wide{last} * (Wide{1} << 20)) << i;
    }
  };
  EXPECT_THROW(play(5000), UnreadableStream);
  EXPECT_TRUE(audit.account().balanced());
}

}  // namespace
}  // namespace wobblebench::hw
