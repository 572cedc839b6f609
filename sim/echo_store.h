// Echoes that are kept between runs.
#pragma once

#include <complex>
#include <functional>
#include <span>

namespace wobblebench::sim {

/// Where the noiseless IQ samples of one volume are kept, of a scan whose volumes repeat. Both
/// functions, or none.
struct EchoStore {
  /// Fills all of them and returns true, or changes nothing.
  std::function<bool(std::span<std::complex<float>> echoes)> load;
  std::function<void(std::span<const std::complex<float>> echoes)> keep;
};

}  // namespace wobblebench::sim
