// The IQ samples of a simulated recording, on disk, as NumPy reads them.
#pragma once

#include <array>
#include <atomic>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <shared_mutex>
#include <span>
#include <string>

#include "base/file.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/iq_sink.h"

namespace wobblebench::bench {

/// volumes x frames x lines x IQ samples. Frames are numbered as on the wire: by their plane in the
/// fan, whatever the order of acquisition.
using IqShape = std::array<std::uint64_t, 4>;
IqShape iq_shape(const hw::AcquisitionPlan& plan, std::uint64_t volumes);

/// An array in NumPy's format, complex64, in C order. Each stick is written in its place when it
/// comes, so that none is held.
class IqFile {
 public:
  /// Throws std::runtime_error "PATH: cannot be written: reason", as all functions.
  IqFile(std::filesystem::path path, const hw::AcquisitionPlan& plan);

  /// On any thread. What comes after finish() is ignored: volumes that were computed ahead.
  void write(const hw::StickIndex& index, std::span<const std::complex<float>> iq);

  /// Cuts the array to its first `volumes`, all of which were written.
  void finish(std::uint64_t volumes);

 private:
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  [[noreturn]] void fail(int error_number);

  std::filesystem::path path_;
  FileDescriptor file_;
  hw::AcquisitionPlan plan_;
  std::shared_mutex writing_;  ///< exclusive: finish()
  bool finished_ = false;
  std::atomic<int> error_number_ = 0;  ///< of the first failure
};

}  // namespace wobblebench::bench
