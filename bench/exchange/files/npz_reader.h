// Reads NumPy's .npz files; npz_file.h writes them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bench/exchange/files/npy.h"

namespace wobblebench::bench {

/// An array of an .npz file, whose content is a part of the file's bytes.
struct NpzEntry {
  std::string name;
  std::uint16_t method = 0;
  std::uint32_t crc = 0;
  std::uint64_t stored = 0, size = 0, offset = 0;
  std::string_view content = {};
};

/// In the file's order. Throws as read_npy(), also where entries overlap: a small file could claim
/// any size.
std::vector<NpzEntry> npz_entries(std::string_view bytes);

/// Stored or deflated; its head is checked before memory is taken for the rest. Throws as
/// read_npy().
NumpyArray read_npz(const NpzEntry& entry, const CheckShape& check);

}  // namespace wobblebench::bench
