// The oracle of simulated recordings sees what a broken recorder, inspection or salvage would do.
#include "bench/board_checks/fault_simulation/recording_simulation.h"

#include <gtest/gtest.h>

#include <fstream>

#include "bench/board_checks/fault_simulation/oracle.h"
#include "bench/pipeline/stick_sources.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

using Bytes = std::vector<std::byte>;

class OracleOfARecording : public testing_support::FolderTest {
 protected:
  OracleOfARecording() : scenario_{.seed = 3, .plan = plan()}, oracle_(scenario_) {
    sim::SimLink link(synthetic_sticks(scenario_.plan, scenario_.seed));
    Bytes buffer(65536);
    for (;;) {
      const hw::ReadResult result = link.read(buffer, hw::HostTime::max());
      if (result.status != hw::ReadStatus::ok) break;
      sent_.insert(sent_.end(), buffer.begin(), buffer.begin() + std::ptrdiff_t(result.bytes));
    }
    packets_ = oracle_.find(sent_);
  }
  static hw::AcquisitionPlan plan() {
    hw::AcquisitionOptions acquisition;
    acquisition.frames_per_volume = 2;
    acquisition.sticks_per_frame = 3;
    acquisition.samples_per_stick = 5;
    acquisition.volumes = 3;
    return {{}, acquisition};
  }
  /// Without the bytes of one packet.
  Bytes without(std::size_t packet) const {
    Bytes bytes = sent_;
    const auto begin = std::ptrdiff_t(packet == 0 ? 0 : packets_.at(packet - 1).end);
    bytes.erase(bytes.begin() + begin, bytes.begin() + std::ptrdiff_t(packets_.at(packet).end));
    return bytes;
  }
  hw::RecordingContents inspect(const Bytes& bytes) const {
    std::ofstream(file("r.wbst"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::ptrdiff_t(bytes.size()));
    return hw::inspect_recording(file("r.wbst"));
  }

  Scenario scenario_;
  RecordingOracle oracle_;
  Bytes sent_;
  std::vector<FoundPacket> packets_;
};

TEST_F(OracleOfARecording, FindsEachPacketOfTheProbe) {
  ASSERT_EQ(packets_.size(), 3U * (1 + 6 + 1));
  EXPECT_EQ(packets_.back().end, sent_.size());
  Bytes cut(sent_.begin(), sent_.end() - 1);
  EXPECT_EQ(oracle_.find(cut).size(), packets_.size() - 1);
  cut[packets_[2].end + 70] ^= std::byte{1};
  EXPECT_EQ(oracle_.find(cut).size(), packets_.size() - 2);
}

TEST_F(OracleOfARecording, AcceptsWhatIsRight) {
  EXPECT_NO_THROW(oracle_.check_kept(sent_, sent_, false, 0));
  EXPECT_NO_THROW(oracle_.check_inspection(sent_, inspect(sent_)));
  EXPECT_EQ(oracle_.check_salvage(sent_, sent_, inspect(sent_), sent_), 18U);
  EXPECT_EQ(oracle_.check_salvage(without(3), without(3), inspect(without(3)), without(3)), 17U);
}

TEST_F(OracleOfARecording, RefusesARecorderThatDropsAPacketOrAByte) {
  for (const bool killed : {false, true}) {
    EXPECT_THROW(oracle_.check_kept(sent_, without(5), killed, 0), RuleViolation);
    EXPECT_THROW(oracle_.check_kept(sent_, std::span(sent_).first(sent_.size() - 1), killed, 0),
                 RuleViolation);
  }
  const auto first_volume = std::span(sent_).first(packets_[7].end);
  EXPECT_THROW(oracle_.check_kept(sent_, first_volume, false, 0), RuleViolation);
  EXPECT_THROW(oracle_.check_kept(sent_, first_volume, false, 2), RuleViolation);
  EXPECT_NO_THROW(oracle_.check_kept(sent_, first_volume, false, 1));
}

TEST_F(OracleOfARecording, RefusesAnotherAccount) {
  hw::RecordingProgress progress;
  progress.account = {.emitted = 18, .delivered = 18};
  EXPECT_NO_THROW(oracle_.check_account(sent_, progress));
  progress.account = {.emitted = 17, .delivered = 17};
  EXPECT_THROW(oracle_.check_account(sent_, progress), RuleViolation);
}

TEST_F(OracleOfARecording, RefusesAnInspectionThatOverlooksAPacket) {
  for (const std::size_t packet : {0U, 3U, 7U}) {
    EXPECT_THROW(oracle_.check_inspection(sent_, inspect(without(packet))), RuleViolation);
  }
  EXPECT_THROW(oracle_.check_inspection(sent_, {}), RuleViolation);
}

TEST_F(OracleOfARecording, RefusesASalvageThatLosesChangesOrRepeatsAStick) {
  const auto check = [&](const Bytes& salvaged, const Bytes& again) {
    oracle_.check_salvage(sent_, salvaged, inspect(salvaged), again);
  };
  EXPECT_THROW(check(without(3), without(3)), RuleViolation);
  EXPECT_THROW(check(sent_, without(3)), RuleViolation) << "salvaged again, it is another";
  EXPECT_THROW(check({}, {}), std::exception);
  Bytes changed = sent_;
  changed[packets_[2].end + 70] ^= std::byte{1};
  EXPECT_THROW(check(changed, changed), RuleViolation);
  Bytes repeated = sent_;
  repeated.insert(repeated.end(), sent_.begin(), sent_.end());
  EXPECT_THROW(check(repeated, repeated), RuleViolation);
}

}  // namespace
}  // namespace wobblebench::bench
