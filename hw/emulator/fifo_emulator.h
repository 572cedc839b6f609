// Stands in for a card where FUSE cannot be mounted: a FIFO that a source is written into. It shows
// pieces of any size, silence and an end; not the driver's rules (xdma_stand_in.h has those).
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <thread>

#include "hw/link/link.h"

namespace wobblebench::hw {

class FifoEmulator {
 public:
  /// Makes FOLDER/xdma0_c2h_0, and writes `source` into it once, for the first reader. The FIFO
  /// ends where the source does. Throws std::system_error.
  FifoEmulator(const std::filesystem::path& folder, std::unique_ptr<Link> source);
  /// Unplugs, and removes the FIFO.
  ~FifoEmulator();
  FifoEmulator(const FifoEmulator&) = delete;
  FifoEmulator& operator=(const FifoEmulator&) = delete;

  std::filesystem::path path() const { return path_; }

  /// Closes the writer's end for good: the reader's stream ends, maybe inside a packet. Any thread.
  void unplug() { unplugged_ = true; }

 private:
  void feed();
  bool write(int fifo, std::span<const std::byte> bytes) const;

  const std::filesystem::path path_;
  const std::unique_ptr<Link> source_;
  std::atomic<bool> unplugged_ = false;
  std::thread thread_;
};

}  // namespace wobblebench::hw
