// Reads NumPy's .npz files; npz_file.h writes them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/exchange/files/npy.h"

namespace wobblebench::bench {

/// The arrays of an .npz file by their names, stored or deflated, in the file's order. Throws as
/// read_npy().
std::vector<std::pair<std::string, NumpyArray>> read_npz(std::string_view bytes);

}  // namespace wobblebench::bench
