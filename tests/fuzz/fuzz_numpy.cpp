// Arrays of NumPy, .npy or .npz, of any bytes: read, or refused in one line.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "bench/exchange/files/npz_reader.h"

namespace bench = wobblebench::bench;

namespace {

/// What is large is refused before it is read, so that an input takes no longer than its
/// neighbours.
void check_shape(const bench::NumpyShape& shape) {
  constexpr std::uint64_t kMostAlong = 1024;
  std::uint64_t axes = 0;
  for (const std::uint64_t size : shape) {
    if (size > kMostAlong || ++axes > 2) throw std::invalid_argument("large");
  }
}

void check(const bench::NumpyArray& array) {
  std::uint64_t count = 1;
  for (const std::uint64_t size : array.shape) count *= size;
  if (count != array.values.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    if (!bytes.starts_with("PK")) check(bench::read_npy(bytes, check_shape));
    for (const auto& entry : bench::npz_entries(bytes)) check(bench::read_npz(entry, check_shape));
  } catch (const std::invalid_argument& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
