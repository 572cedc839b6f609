// What the samples of a stream are of, as far as it decides the truth about them.
#pragma once

#include <cstdint>

namespace wobblebench::hw {

/// CRC-32C of the settings of a simulated subject, and of an imported file's bytes. All 0: the
/// stream does not say.
struct SubjectHash {
  std::uint32_t phantom = 0;
  std::uint32_t placement = 0;  ///< in the probe frame
  std::uint32_t motion = 0;

  bool stated() const { return *this != SubjectHash(); }
  friend bool operator==(const SubjectHash&, const SubjectHash&) = default;
};

}  // namespace wobblebench::hw
