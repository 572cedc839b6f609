// The unsigned integer that has as many bytes as a number, for its bits in another byte order.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobblebench {

template <std::size_t size>
struct UnsignedOf;
template <>
struct UnsignedOf<1> {
  using type = std::uint8_t;
};
template <>
struct UnsignedOf<2> {
  using type = std::uint16_t;
};
template <>
struct UnsignedOf<4> {
  using type = std::uint32_t;
};
template <>
struct UnsignedOf<8> {
  using type = std::uint64_t;
};

}  // namespace wobblebench
