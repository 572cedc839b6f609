// CRC-32C (Castagnoli), as in iSCSI: RFC 3720, appendix B.4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace wobblebench::hw {

/// CRC of `bytes` appended to bytes whose CRC is `before` (0: none). Uses the SSE4.2 instruction
/// where the processor has it. "123456789" gives 0xE3069283.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// The same in portable code, eight bytes a step (slicing-by-8).
std::uint32_t crc32c_by_table(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace wobblebench::hw
