// Emulates a card by a FIFO, where FUSE cannot be mounted. It has reads of any size, pauses and an
// end; not the rules of the driver, which xdma_emulator.h has.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <stop_token>
#include <thread>

#include "hw/link/link.h"

namespace wobblebench::hw {

class FifoEmulator {
 public:
  /// Makes FOLDER/xdma0_c2h_0, and writes `source` into it once, for the first reader. The FIFO
  /// ends with the source. Throws std::system_error.
  FifoEmulator(const std::filesystem::path& folder, std::unique_ptr<Link> source);
  /// Unplugs, and removes the FIFO.
  ~FifoEmulator();
  FifoEmulator(const FifoEmulator&) = delete;
  FifoEmulator& operator=(const FifoEmulator&) = delete;

  std::filesystem::path path() const { return path_; }

  /// Closes the writer's end for good: the reader's stream ends, possibly inside a packet. May be
  /// called from any thread.
  void unplug() { thread_.request_stop(); }

 private:
  void feed(const std::stop_token& unplugged);

  const std::filesystem::path path_;
  const std::unique_ptr<Link> source_;
  std::jthread thread_;  ///< a stop request unplugs
};

}  // namespace wobblebench::hw
