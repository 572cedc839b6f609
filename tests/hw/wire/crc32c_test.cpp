#include "hw/wire/crc32c.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

Bytes bytes_of(std::string_view text) {
  Bytes bytes;
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

void expect_crc(const Bytes& bytes, std::uint32_t crc) {
  EXPECT_EQ(crc32c(bytes), crc);
  EXPECT_EQ(crc32c_by_table(bytes), crc);
}

TEST(Crc32c, CheckValue) {
  expect_crc(bytes_of("123456789"), 0xE3069283);
}

TEST(Crc32c, Rfc3720) {
  expect_crc(Bytes(32, std::byte{0}), 0x8A9136AA);
  expect_crc(Bytes(32, std::byte{0xFF}), 0x62A8AB43);
  Bytes up, down;
  for (int i = 0; i < 32; ++i) {
    up.push_back(static_cast<std::byte>(i));
    down.push_back(static_cast<std::byte>(31 - i));
  }
  expect_crc(up, 0x46DD794E);
  expect_crc(down, 0x113FDB5C);
  // An iSCSI READ(10) command.
  Bytes command(48, std::byte{0});
  command[0] = std::byte{0x01};
  command[1] = std::byte{0xC0};
  command[16] = std::byte{0x14};
  command[22] = std::byte{0x04};
  command[27] = std::byte{0x14};
  command[31] = std::byte{0x18};
  command[32] = std::byte{0x28};
  command[40] = std::byte{0x02};
  expect_crc(command, 0xD9963A56);
}

TEST(Crc32c, EmptyIsZero) {
  expect_crc({}, 0);
}

TEST(Crc32c, BothVariantsAgreeAtEveryLengthAlignmentAndCut) {
  Bytes bytes;
  for (std::uint64_t i = 0; i < 300; ++i) bytes.push_back(static_cast<std::byte>(hash(1, i)));
  for (std::size_t start = 0; start < 9; ++start) {
    for (std::size_t size = 0; size + start <= 100; ++size) {
      const auto part = std::span(bytes).subspan(start, size);
      const std::uint32_t whole = crc32c_by_table(part);
      EXPECT_EQ(crc32c(part), whole);
      const std::size_t cut = size / 3;
      EXPECT_EQ(crc32c(part.subspan(cut), crc32c(part.first(cut))), whole);
      EXPECT_EQ(crc32c_by_table(part.subspan(cut), crc32c_by_table(part.first(cut))), whole);
    }
  }
}

}  // namespace
}  // namespace wobblebench::hw
