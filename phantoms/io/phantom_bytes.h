// A phantom as bytes, for a cache.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// Raised by whoever changes the form of the bytes, or what a phantom is.
inline constexpr int kPhantomBytesVersion = 6;

/// nullopt where a grid is not such as this program's shapes: its inactive values plus or minus the
/// background, its voxels cubic and moved at most, without metadata but its name.
[[nodiscard]] std::optional<std::string> to_bytes(const Phantom& phantom);

/// The same phantom to the bit. Throws DamagedBytes for bytes that no phantom has; a wrong value
/// that is possible is not found.
[[nodiscard]] Phantom phantom_from_bytes(std::string_view bytes);

}  // namespace wobblebench::phantoms
