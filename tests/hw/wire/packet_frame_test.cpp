#include "hw/wire/decoder.h"

#include <gtest/gtest.h>

#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

TEST(PacketFramer, FramesDoNotDependOnPieceSizes) {
  const auto packets = packets_of(small_plan());
  const Bytes stream = join(packets);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{64}, stream.size()}) {
    PacketFramer framer;
    std::size_t frames = 0;
    std::uint64_t offset = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      framer.feed(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      while (const auto frame = framer.next()) {
        ASSERT_LT(frames, packets.size());
        EXPECT_EQ(Bytes(frame->bytes.begin(), frame->bytes.end()), packets[frames]);
        EXPECT_EQ(frame->offset, offset);
        offset += packets[frames++].size();
      }
    }
    EXPECT_EQ(frames, packets.size());
    EXPECT_EQ(framer.damage().regions, 0U);
  }
}

TEST(PacketFramer, OffsetsIncludeDamage) {
  const auto packets = packets_of(small_plan());
  Bytes stream(10, std::byte{7});
  stream.insert(stream.end(), packets[0].begin(), packets[0].end());
  PacketFramer framer;
  framer.feed(stream);
  const auto frame = framer.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->offset, 10U);
  EXPECT_EQ(framer.damage().regions, 1U);
  EXPECT_EQ(framer.damage().bytes_skipped, 10U);
}

TEST(PacketFramer, RejectedFrameIsDamage) {
  const auto packets = packets_of(small_plan());
  PacketFramer framer;
  framer.feed(join(packets));
  ASSERT_TRUE(framer.next());
  framer.reject_last();
  EXPECT_EQ(framer.damage().regions, 1U);
  EXPECT_EQ(framer.damage().bytes_skipped, packets[0].size());
  ASSERT_TRUE(framer.next());
  framer.reject_last();
  EXPECT_EQ(framer.damage().regions, 1U) << "one region: no accepted packet between them";
}

TEST(PacketStamp, IsReadAndRewrittenWithItsCrc) {
  const AcquisitionPlan plan = small_plan();
  for (const WireCrc crc : {WireCrc::crc32c, WireCrc::none}) {
    Bytes packet;
    encode(test_stick(plan, 5), packet, crc);
    EXPECT_EQ(packet_stamp(packet).sequence, 5U);
    EXPECT_EQ(packet_stamp(packet).time, plan.stick_time(5));
    const PacketStamp stamp{.sequence = 77, .volume = 6, .time = DeviceTime(DeviceDuration(123))};
    restamp(packet, stamp);
    Decoder decoder;
    decoder.feed(packet);
    const auto decoded = decoder.next();
    ASSERT_TRUE(decoded);
    const Stick& stick = std::get<StickPacket>(*decoded).stick;
    EXPECT_EQ(stick.sequence, 77U);
    EXPECT_EQ(stick.index.volume, 6U);
    EXPECT_EQ(stick.time, stamp.time);
    EXPECT_EQ(stick.samples, test_stick(plan, 5).samples);
    EXPECT_EQ(stick.checked, crc == WireCrc::crc32c);
  }
}

}  // namespace
}  // namespace wobblebench::hw
