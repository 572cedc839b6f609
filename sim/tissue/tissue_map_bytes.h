// A tissue map as bytes, for a cache.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

/// Raised by whoever changes the form of the bytes, or what a map holds.
inline constexpr int kTissueMapBytesVersion = 1;

[[nodiscard]] std::string to_bytes(const TissueMap& map);

/// The same map to the bit, of a phantom with so many surfaces and materials. Throws DamagedBytes
/// for bytes that would have it read beyond its arrays; a wrong value that is possible is not
/// found.
[[nodiscard]] std::shared_ptr<const TissueMap> tissue_map_from_bytes(std::string_view bytes,
                                                                     std::size_t surfaces,
                                                                     std::size_t materials);

}  // namespace wobblebench::sim
