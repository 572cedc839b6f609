// A link over bytes in memory, for tests.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "hw/link/link.h"

namespace wobblebench::hw {

struct MemoryLinkOptions {
  bool waits_for_reader = true;
  /// Seed of the sizes of the chunks that reads return; 0: whole reads.
  std::uint64_t chunk_seed = 0;
  /// Status after the last byte: end_of_stream, lost, or timeout (an idle link).
  ReadStatus ending = ReadStatus::end_of_stream;
};

class MemoryLink : public Link {
 public:
  explicit MemoryLink(std::vector<std::byte> bytes, const MemoryLinkOptions& options = {});

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  LinkCapabilities capabilities() const override;

  /// Appends bytes to the stream. May be called from any thread.
  void append(const std::vector<std::byte>& bytes);

 private:
  const MemoryLinkOptions options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::byte> bytes_;
  std::size_t read_ = 0;
  std::uint64_t chunk_ = 0;
  bool cancelled_ = false;
  bool closed_ = false;
};

}  // namespace wobblebench::hw
