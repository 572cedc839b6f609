// Lets a fuzzer through the CRC: mutated packets are given a right one now and then, so that what
// lies behind the check is reached.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "hw/wire_layout.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace wobblebench::fuzz {

/// Gives a right CRC to what looks like a packet at `at`; true if it does.
inline bool seal(std::span<std::byte> bytes, std::size_t at) {
  using namespace hw;
  const auto packet = bytes.subspan(at);
  if (packet.size() < kWireHeaderBytes) return false;
  if (!std::equal(kWireMagic.begin(), kWireMagic.end(), packet.begin())) return false;
  const std::uint64_t size = kWireHeaderBytes + std::uint64_t{wire_layout::get<std::uint32_t>(
                                                    packet, wire_layout::kPayloadBytesAt)};
  if (size > packet.size()) return false;
  const auto whole = packet.first(static_cast<std::size_t>(size));
  wire_layout::put(whole.data() + wire_layout::kCrcAt, wire_layout::packet_crc(whole));
  return true;
}

/// Mutates as libFuzzer does, then seals most packets; which, the seed says.
inline std::size_t mutate_and_seal(std::uint8_t* data,
                                   std::size_t size,
                                   std::size_t max_size,
                                   unsigned seed) {
  size = LLVMFuzzerMutate(data, size, max_size);
  const auto bytes = std::as_writable_bytes(std::span(data, size));
  for (std::size_t at = 0; at < size; ++at) {
    seed = seed * 1664525 + 1013904223;
    if (seed >> 30 != 0) seal(bytes, at);
  }
  return size;
}

}  // namespace wobblebench::fuzz
