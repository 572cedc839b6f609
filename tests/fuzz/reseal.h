// Gives most mutated packets a valid CRC, so that a fuzzer reaches the code behind the check.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

#include "hw/wire/layout.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace wobblebench::fuzz {

/// Writes the CRC of the packet whose magic is at `at`, if the packet is whole.
inline void seal(std::span<std::byte> bytes, std::size_t at) {
  using namespace hw;
  const auto packet = bytes.subspan(at);
  if (packet.size() < kWireHeaderBytes) return;
  const std::uint64_t size = kWireHeaderBytes + std::uint64_t{wire_layout::get<std::uint32_t>(
                                                    packet, wire_layout::kPayloadBytesOffset)};
  if (size > packet.size()) return;
  const auto whole = packet.first(static_cast<std::size_t>(size));
  wire_layout::put(whole.data() + wire_layout::kCrcOffset, wire_layout::packet_crc(whole));
}

/// Mutates as libFuzzer does, then seals most packets, chosen by the seed.
inline std::size_t mutate_and_seal(std::uint8_t* data,
                                   std::size_t size,
                                   std::size_t max_size,
                                   unsigned seed) {
  size = LLVMFuzzerMutate(data, size, max_size);
  const auto bytes = std::as_writable_bytes(std::span(data, size));
  // memmem, because an instrumented search of every byte costs as much as decoding.
  const auto magic = [&](std::size_t from) {
    return static_cast<std::byte*>(
        ::memmem(bytes.data() + from, size - from, hw::kWireMagic.data(), hw::kWireMagic.size()));
  };
  for (std::byte* found = magic(0); found != nullptr;) {
    const auto at = static_cast<std::size_t>(found - bytes.data());
    seed = seed * 1664525 + 1013904223;
    if (seed >> 30 != 0) seal(bytes, at);
    found = magic(at + 1);
  }
  return size;
}

}  // namespace wobblebench::fuzz
