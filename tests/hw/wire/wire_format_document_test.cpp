// The example of docs/wire_format.md equals what this program writes and reads.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

/// The bytes of the lines "OFFSET  xx xx ..." in the document's code blocks marked hex.
Bytes example() {
  std::ifstream document(WOBBLEBENCH_DOCS "/wire_format.md");
  EXPECT_TRUE(document) << "no document";
  Bytes bytes;
  bool inside = false;
  for (std::string line; std::getline(document, line);) {
    if (line.starts_with("```")) {
      inside = line == "```hex";
    } else if (inside) {
      std::istringstream fields(line);
      std::string field;
      fields >> field;
      EXPECT_EQ(std::stoul(field, nullptr, 16), bytes.size());
      while (fields >> field) bytes.push_back(std::byte(std::stoul(field, nullptr, 16)));
    }
  }
  return bytes;
}

/// Explicit values, so that the document does not depend on the defaults.
AcquisitionPlan example_plan() {
  const ProbeOptions probe{.f_number = 2.0,
                           .transmit_focus_m = 80e-3,
                           .elements = 96,
                           .pitch_m = 0.5e-3,
                           .elevation_focus_m = 60e-3};
  AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 1;
  acquisition.samples_per_stick = 4;
  acquisition.frames_per_volume = 1;
  acquisition.fly_back_s = 50e-3;
  return {probe, acquisition};
}

ConfigurationPacket example_configuration(const AcquisitionPlan& plan) {
  ConfigurationPacket packet = configuration_of(plan, 0);
  packet.display_scale = {.full_scale_db = -15, .dynamic_range_db = 60, .tgc_db_per_cm_mhz = 0.3};
  return packet;
}

Stick example_stick(const AcquisitionPlan& plan) {
  Stick stick = test_stick(plan, 0);
  stick.samples = {0, 0.25F, 0.5F, 1};
  return stick;
}

TEST(WireFormatDocument, ExampleIsWritten) {
  const AcquisitionPlan plan = example_plan();
  Bytes written;
  encode(example_configuration(plan), written);
  encode(example_stick(plan), written);
  encode(volume_end_of(plan, 0), written);
  EXPECT_EQ(example(), written);
}

TEST(WireFormatDocument, ExampleIsRead) {
  const AcquisitionPlan plan = example_plan();
  Decoder decoder;
  decoder.feed(example());
  const auto configuration = decoder.next();
  ASSERT_TRUE(configuration && std::holds_alternative<ConfigurationPacket>(*configuration));
  const auto& read = std::get<ConfigurationPacket>(*configuration);
  EXPECT_TRUE(read.probe == plan.probe());
  EXPECT_TRUE(read.acquisition == plan.acquisition());
  EXPECT_EQ(read.source, StreamOrigin::simulated);
  EXPECT_TRUE(read.display_scale == example_configuration(plan).display_scale);
  const auto stick = decoder.next();
  ASSERT_TRUE(stick && std::holds_alternative<StickPacket>(*stick));
  EXPECT_EQ(std::get<StickPacket>(*stick).stick.samples, (std::vector<float>{0, 0.25F, 0.5F, 1}));
  const auto end = decoder.next();
  ASSERT_TRUE(end && std::holds_alternative<VolumeEndPacket>(*end));
  EXPECT_EQ(std::get<VolumeEndPacket>(*end).sequence, 1U);
  EXPECT_EQ(std::get<VolumeEndPacket>(*end).time.time_since_epoch().count(), 207792);
  EXPECT_EQ(decoder.damage().regions, 0U);
  EXPECT_EQ(decoder.pending_bytes(), 0U);
}

}  // namespace
}  // namespace wobblebench::hw
