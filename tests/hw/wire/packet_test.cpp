#include "hw/wire/packet.h"
#include "hw/wire/decoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "hw/wire/crc32c.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

std::vector<Packet> decode(const Bytes& stream) {
  Decoder decoder;
  decoder.feed(stream);
  std::vector<Packet> packets;
  while (auto packet = decoder.next()) packets.push_back(std::move(*packet));
  EXPECT_EQ(decoder.damage().bytes_skipped, 0U);
  EXPECT_EQ(decoder.pending_bytes(), 0U);
  return packets;
}

Bytes encoded(const Packet& packet) {
  Bytes bytes;
  if (const auto* stick = std::get_if<StickPacket>(&packet)) encode(stick->stick, bytes);
  if (const auto* end = std::get_if<VolumeEndPacket>(&packet)) encode(*end, bytes);
  if (const auto* plan = std::get_if<ConfigurationPacket>(&packet)) encode(*plan, bytes);
  return bytes;
}

std::uint64_t unsigned_at(const Bytes& bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) {
    value = value << 8 | std::to_integer<std::uint64_t>(bytes.at(offset + i));
  }
  return value;
}

void set_unsigned(Bytes& bytes, std::size_t offset, std::size_t size, std::uint64_t value) {
  for (std::size_t i = 0; i < size; ++i) bytes.at(offset + i) = std::byte(value >> (8 * i) & 0xFF);
}

/// Updates the CRC after fields were changed.
void reseal(Bytes& packet) {
  const auto all = std::span<const std::byte>(packet);
  set_unsigned(packet, 60, 4, crc32c(all.subspan(64), crc32c(all.first(60))));
}

/// Sets every described field to a value of its own.
struct Perturb {
  double share = 0.11;
  void real(std::string_view, double& value, double unit, double min, double max) {
    value = (min + (max - min) * (share += 0.02)) * unit;
  }
  void integer(std::string_view, int& value, int min, int max) {
    value = min + static_cast<int>((max - min) * (share += 0.02));
  }
  template <class Enum>
  void choice(std::string_view,
              Enum& value,
              std::initializer_list<std::pair<std::string_view, Enum>> choices) {
    value = (choices.end() - 1)->second;
  }
};

TEST(Wire, ConfigurationCarriesEveryOption) {
  ConfigurationPacket packet;
  packet.sequence = 0x0123456789ABCDEF;
  packet.volume = 0xFEDCBA98;
  packet.time = DeviceTime(DeviceDuration(-5));
  packet.source = StreamOrigin::hardware;
  Perturb perturb;
  describe(packet.probe, perturb);
  describe(packet.acquisition, perturb);
  describe(packet.display_scale, perturb);
  packet.subject = {.phantom = 0x89ABCDEF, .placement = 1, .motion = 0xFFFFFFFF};
  packet.knows_times = false;
  const auto packets = decode(encoded(packet));
  ASSERT_EQ(packets.size(), 1U);
  const auto& decoded = std::get<ConfigurationPacket>(packets[0]);
  EXPECT_EQ(decoded.sequence, packet.sequence);
  EXPECT_EQ(decoded.volume, packet.volume);
  EXPECT_EQ(decoded.time, packet.time);
  EXPECT_EQ(decoded.source, packet.source);
  EXPECT_TRUE(decoded.probe == packet.probe);
  EXPECT_TRUE(decoded.acquisition == with_one_zone(packet.acquisition));
  EXPECT_TRUE(decoded.subject == packet.subject);
  EXPECT_TRUE(decoded.subject.stated());
  EXPECT_TRUE(decoded.display_scale == packet.display_scale);
  EXPECT_TRUE(decoded.display_scale.stated());
  EXPECT_FALSE(decoded.knows_times);
}

TEST(Wire, ADynamicRangeMayBeKnownAlone) {
  ConfigurationPacket packet;
  packet.display_scale = {.dynamic_range_db = 45, .range_alone = true};
  const auto packets = decode(encoded(packet));
  ASSERT_EQ(packets.size(), 1U);
  const auto& decoded = std::get<ConfigurationPacket>(packets[0]);
  EXPECT_TRUE(decoded.display_scale == packet.display_scale);
  EXPECT_FALSE(decoded.display_scale.stated());
  EXPECT_TRUE(decoded.display_scale.knows_range());
  EXPECT_TRUE(decoded.knows_times);
}

/// As written before there was a display scale.
TEST(Wire, ConfigurationsOf160BytesAreReadAndStateNoScale) {
  ConfigurationPacket packet;
  packet.sequence = 24;
  packet.volume = 2;
  packet.subject = {.phantom = 1, .placement = 2, .motion = 3};
  packet.display_scale = {.full_scale_db = -15, .dynamic_range_db = 60, .tgc_db_per_cm_mhz = 0.3};
  Bytes stream = without_display_scale(encoded(packet));
  encode(packet, stream);
  const auto packets = decode(stream);
  ASSERT_EQ(packets.size(), 2U);
  const auto& decoded = std::get<ConfigurationPacket>(packets[0]);
  EXPECT_EQ(decoded.sequence, 24U);
  EXPECT_TRUE(decoded.acquisition == with_one_zone(packet.acquisition));
  EXPECT_TRUE(decoded.subject == packet.subject);
  EXPECT_FALSE(decoded.display_scale.stated());
  EXPECT_TRUE(std::get<ConfigurationPacket>(packets[1]).display_scale == packet.display_scale);
}

TEST(Wire, ConfigurationsOfOtherLengthsAreDamage) {
  for (const std::size_t length : {152U, 168U, 176U, 192U}) {
    Bytes bytes = encoded(ConfigurationPacket{});
    bytes.resize(64 + length);
    set_unsigned(bytes, 8, 4, length);
    reseal(bytes);
    Decoder decoder;
    decoder.feed(bytes);
    decoder.finish();
    EXPECT_FALSE(decoder.next()) << length;
    EXPECT_EQ(decoder.damage().regions, 1U) << length;
  }
}

/// As written before there was a subject, and by hardware.
TEST(Wire, ConfigurationWithoutASubjectDoesNotStateOne) {
  const Bytes bytes = encoded(ConfigurationPacket{});
  for (std::size_t offset = 148; offset < 160; offset += 4) {
    EXPECT_EQ(unsigned_at(bytes, 64 + offset, 4), 0U);
  }
  const auto packets = decode(bytes);
  EXPECT_FALSE(std::get<ConfigurationPacket>(packets.at(0)).subject.stated());
}

TEST(Wire, StickKeepsEveryBitOfItsSamples) {
  for (std::size_t samples = 1; samples <= 9; ++samples) {
    Stick stick;
    stick.sequence = std::numeric_limits<std::uint64_t>::max() - 1;
    stick.index = {7, 8, 9};
    stick.time = DeviceTime(DeviceDuration::max());
    stick.motor_angle_rad = -0.25;
    stick.sweep_direction = -1;
    stick.scale = SampleScale::linear_envelope;
    stick.samples.assign(samples, std::numeric_limits<float>::quiet_NaN());
    stick.samples[0] = -std::numeric_limits<float>::denorm_min();
    const auto packets = decode(encoded(StickPacket{stick}));
    ASSERT_EQ(packets.size(), 1U);
    const Stick& decoded = std::get<StickPacket>(packets[0]).stick;
    EXPECT_EQ(decoded.sequence, stick.sequence);
    EXPECT_EQ(decoded.index.volume, 7U);
    EXPECT_EQ(decoded.index.frame, 8U);
    EXPECT_EQ(decoded.index.line, 9U);
    EXPECT_EQ(decoded.time, stick.time);
    EXPECT_EQ(decoded.motor_angle_rad, -0.25);
    EXPECT_EQ(decoded.sweep_direction, -1);
    EXPECT_EQ(decoded.scale, stick.scale);
    ASSERT_EQ(decoded.samples.size(), samples);
    for (std::size_t i = 0; i < samples; ++i) {
      EXPECT_EQ(std::bit_cast<std::uint32_t>(decoded.samples[i]),
                std::bit_cast<std::uint32_t>(stick.samples[i]));
    }
  }
}

TEST(Wire, HeaderOffsetsAreThoseOfTheSpecification) {
  Stick stick;
  stick.sequence = 0x1122334455667788;
  stick.index = {0xA1A2A3A4, 0xB1B2B3B4, 0xC1C2C3C4};
  stick.time = DeviceTime(DeviceDuration(0x0102030405060708));
  stick.motor_angle_rad = 1.0;
  stick.sweep_direction = -1;
  stick.scale = SampleScale::linear_envelope;
  stick.samples = {0.5F, 0.25F, 0.125F};
  const Bytes bytes = encoded(StickPacket{stick});
  ASSERT_EQ(bytes.size(), 80U);
  EXPECT_EQ(std::memcmp(bytes.data(), "WBST", 4), 0);
  EXPECT_EQ(unsigned_at(bytes, 4, 2), 1U);
  EXPECT_EQ(unsigned_at(bytes, 6, 2), 2U);
  EXPECT_EQ(unsigned_at(bytes, 8, 4), 16U);
  EXPECT_EQ(unsigned_at(bytes, 12, 4), kFlagLinearEnvelope);
  EXPECT_EQ(unsigned_at(bytes, 16, 8), stick.sequence);
  EXPECT_EQ(unsigned_at(bytes, 24, 4), stick.index.volume);
  EXPECT_EQ(unsigned_at(bytes, 28, 4), stick.index.frame);
  EXPECT_EQ(unsigned_at(bytes, 32, 4), stick.index.line);
  EXPECT_EQ(unsigned_at(bytes, 36, 4), 0xFFFFFFFFU);
  EXPECT_EQ(unsigned_at(bytes, 40, 8), 0x0102030405060708U);
  EXPECT_EQ(unsigned_at(bytes, 48, 8), 0x3FF0000000000000U);
  EXPECT_EQ(unsigned_at(bytes, 56, 4), 3U);
  EXPECT_EQ(unsigned_at(bytes, 64, 4), 0x3F000000U);
  EXPECT_EQ(unsigned_at(bytes, 68, 4), 0x3E800000U);
  EXPECT_EQ(unsigned_at(bytes, 72, 4), 0x3E000000U);
  EXPECT_EQ(unsigned_at(bytes, 76, 4), 0U) << "padding";
  Bytes resealed = bytes;
  reseal(resealed);
  EXPECT_EQ(resealed, bytes);
}

TEST(Wire, ConfigurationOffsetsAreThoseOfTheSpecification) {
  ConfigurationPacket packet;
  packet.probe.f_number = 2.0;
  packet.probe.elevation_focus_m = 0.06;
  packet.probe.transmit_focus_m = 0.08;
  packet.probe.pitch_m = 0.0005;
  packet.probe.elements = 96;
  packet.acquisition.fly_back_s = 0.025;
  packet.acquisition.motor = MotorMode::fly_back;
  packet.display_scale = {.full_scale_db = -15, .dynamic_range_db = 60, .tgc_db_per_cm_mhz = 0.3};
  const Bytes bytes = encoded(packet);
  ASSERT_EQ(bytes.size(), 64U + 184U);
  const auto real = [&](std::size_t offset) {
    return std::bit_cast<double>(unsigned_at(bytes, 64 + offset, 8));
  };
  const double reals[] = {0.04,
                          0.027,
                          3.5e6,
                          0.6,
                          2.0,
                          0.08,
                          0.0005,
                          0.0135,
                          0.06,
                          0.16,
                          77 * kDegree,
                          61 * kDegree,
                          1540,
                          0,
                          0.025};
  for (std::size_t i = 0; i < std::size(reals); ++i) EXPECT_DOUBLE_EQ(real(8 * i), reals[i]) << i;
  const std::uint64_t integers[] = {96, 64, 512, 37, 1, 3, 1, 0, 0, 0};
  for (std::size_t i = 0; i < std::size(integers); ++i) {
    EXPECT_EQ(unsigned_at(bytes, 184 + 4 * i, 4), integers[i]) << i;
  }
  const double scale[] = {-15, 60, 0.3};
  for (std::size_t i = 0; i < std::size(scale); ++i) EXPECT_EQ(real(160 + 8 * i), scale[i]) << i;
}

TEST(Wire, RejectsSticksOfImpossibleLength) {
  Bytes out;
  Stick stick;
  EXPECT_THROW(encode(stick, out), std::length_error);
  stick.samples.resize(4097);
  EXPECT_THROW(encode(stick, out), std::length_error);
  EXPECT_TRUE(out.empty());
}

TEST(Wire, ChunksOfAnySizeGiveTheSamePackets) {
  const AcquisitionPlan plan = small_plan(3);
  for (const WireCrc crc : {WireCrc::crc32c, WireCrc::none}) {
    const Bytes stream = stream_of(plan, crc);
    const auto expected = decode(stream);
    ASSERT_EQ(expected.size(), 3U * 14U);
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const std::uint64_t longest = seed == 0 ? 1 : 1 + hash(seed, 0) % 300;
      Decoder decoder;
      std::size_t count = 0, fed = 0;
      for (std::uint64_t chunk = 1; fed < stream.size(); ++chunk) {
        const auto size =
            std::min<std::size_t>(1 + hash(seed, chunk) % longest, stream.size() - fed);
        decoder.feed(std::span(stream).subspan(fed, size));
        fed += size;
        while (auto packet = decoder.next()) {
          ASSERT_LT(count, expected.size());
          ASSERT_EQ(encoded(*packet), encoded(expected[count++]));
        }
      }
      ASSERT_EQ(count, expected.size());
      ASSERT_EQ(decoder.damage().regions, 0U);
    }
  }
}

TEST(Wire, LaterVersionIsReportedAndNotDamage) {
  const AcquisitionPlan plan = small_plan();
  Bytes packet = encoded(StickPacket{test_stick(plan, 0)});
  set_unsigned(packet, 4, 2, 7);
  reseal(packet);
  Decoder decoder;
  decoder.feed(packet);
  for (int i = 0; i < 2; ++i) {
    try {
      static_cast<void>(decoder.next());
      FAIL();
    } catch (const UnsupportedWireVersion& error) {
      EXPECT_EQ(error.version(), 7);
      EXPECT_STREQ(error.what(), "wire format version 7: this program reads version 1");
    }
  }
}

TEST(Wire, DamagedVersionIsDamage) {
  const AcquisitionPlan plan = small_plan();
  for (const std::uint64_t version : {0U, 2U, 0x8001U}) {
    Bytes stream = encoded(StickPacket{test_stick(plan, 0)});
    set_unsigned(stream, 4, 2, version);
    encode(test_stick(plan, 1), stream);
    Decoder decoder;
    decoder.feed(stream);
    const auto packet = decoder.next();
    ASSERT_TRUE(packet);
    EXPECT_EQ(std::get<StickPacket>(*packet).stick.sequence, 1U);
    EXPECT_EQ(decoder.damage().regions, 1U);
  }
}

TEST(Wire, UnknownKindIsSkipped) {
  const AcquisitionPlan plan = small_plan();
  Bytes stream = encoded(StickPacket{test_stick(plan, 0)});
  set_unsigned(stream, 6, 2, 99);
  reseal(stream);
  encode(test_stick(plan, 1), stream);
  const auto packets = decode(stream);
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(std::get<StickPacket>(packets[0]).stick.sequence, 1U);
}

TEST(Wire, HugeLengthIsDamageAtOnce) {
  const AcquisitionPlan plan = small_plan();
  for (const std::uint64_t length : {0xFFFFFFFFULL, 0xFFFFFFF8ULL, 65544ULL, 28ULL}) {
    Bytes stream = encoded(StickPacket{test_stick(plan, 0)});
    set_unsigned(stream, 8, 4, length);
    reseal(stream);
    encode(test_stick(plan, 1), stream);
    Decoder decoder;
    decoder.feed(stream);
    const auto packet = decoder.next();
    ASSERT_TRUE(packet) << length;
    EXPECT_EQ(std::get<StickPacket>(*packet).stick.sequence, 1U);
  }
}

TEST(Wire, UndefinedFieldValuesAreDamage) {
  const AcquisitionPlan plan = small_plan();
  const struct {
    std::size_t offset, size;
    std::uint64_t value;
  } cases[] = {{12, 4, 4},
               {16, 8, 0xFFFFFFFFFFFFFFFF},
               {36, 4, 0},
               {36, 4, 2},
               {48, 8, 0x7FF0000000000000},
               {56, 4, 3}};
  for (const auto& bad : cases) {
    Bytes stream = encoded(StickPacket{test_stick(plan, 0)});
    set_unsigned(stream, bad.offset, bad.size, bad.value);
    reseal(stream);
    Decoder decoder;
    decoder.feed(stream);
    decoder.finish();
    EXPECT_FALSE(decoder.next()) << bad.offset;
    EXPECT_EQ(decoder.damage().regions, 1U);
    EXPECT_EQ(decoder.damage().bytes_skipped, stream.size());
  }
  for (const std::size_t offset : {64 + 140, 64 + 144}) {
    Bytes stream = encoded(configuration_of(plan, 0));
    set_unsigned(stream, offset, 4, 5);
    reseal(stream);
    Decoder decoder;
    decoder.feed(stream);
    EXPECT_FALSE(decoder.next()) << offset;
    EXPECT_EQ(decoder.damage().regions, 1U);
  }
}

TEST(Wire, UncheckedPacketsAreAcceptedOnlyInSync) {
  const AcquisitionPlan plan = small_plan();
  Bytes stream(5, std::byte{'?'});
  encode(test_stick(plan, 0), stream, WireCrc::none);
  encode(configuration_of(plan, 0), stream);
  encode(test_stick(plan, 1), stream, WireCrc::none);
  Decoder decoder;
  decoder.feed(stream);
  const auto first = decoder.next();
  ASSERT_TRUE(first && std::holds_alternative<ConfigurationPacket>(*first));
  const auto second = decoder.next();
  ASSERT_TRUE(second && std::holds_alternative<StickPacket>(*second));
  EXPECT_EQ(std::get<StickPacket>(*second).stick.sequence, 1U);
}

TEST(Wire, UncheckedFlagNeedsAnEmptyCrc) {
  const AcquisitionPlan plan = small_plan();
  Bytes stream = encoded(StickPacket{test_stick(plan, 0)});
  stream[12] |= std::byte{kFlagCrcUnchecked};
  stream[70] ^= std::byte{0x10};
  Decoder decoder;
  decoder.feed(stream);
  decoder.finish();
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.damage().regions, 1U);
}

TEST(Wire, TruncatedLongPacketHidesNoPacketAtTheEnd) {
  const AcquisitionPlan plan = small_plan();
  Bytes stream = encoded(StickPacket{test_stick(plan, 0)});
  set_unsigned(stream, 8, 4, 4096 * 4);
  set_unsigned(stream, 56, 4, 4096);
  encode(test_stick(plan, 1), stream);
  Decoder decoder;
  decoder.feed(stream);
  EXPECT_FALSE(decoder.next());
  decoder.finish();
  const auto packet = decoder.next();
  ASSERT_TRUE(packet);
  EXPECT_EQ(std::get<StickPacket>(*packet).stick.sequence, 1U);
  EXPECT_EQ(decoder.pending_bytes(), 0U);
}

}  // namespace
}  // namespace wobblebench::hw
