// Reads the bytes of a recording, its packets, and the extent of damage between them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/file.h"
#include "hw/recording/recording.h"
#include "hw/wire/decoder.h"
#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {

/// An open recording: a regular file that starts, apart from damage, with a readable packet. Not
/// thread-safe.
class RecordingFile {
 public:
  /// Throws LinkOpenError.
  explicit RecordingFile(const std::filesystem::path& path);

  /// Reads from `offset`; returns fewer bytes than the buffer has only at the end of the file.
  /// Throws std::runtime_error "PATH: cannot be read: reason".
  std::size_t read(std::uint64_t offset, std::span<std::byte> buffer) const;

  std::uint64_t bytes() const { return bytes_; }
  /// Size of a buffer for sequential reading: 64 KiB, or just above the file's size.
  std::size_t chunk_bytes() const { return std::min<std::uint64_t>(bytes_ + 1, 65536); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t bytes_ = 0;
};

struct RecordedPacket {
  std::span<const std::byte> bytes;  ///< the whole packet; valid until the next is read
  std::uint64_t offset = 0;          ///< in the file
  std::uint64_t damage_before = 0;   ///< bytes before it that belong to no packet
  std::optional<Packet> packet;      ///< none: of an unknown kind
};

/// Reads a file front to back. Not thread-safe.
class RecordingReader {
 public:
  /// Reads as if the file ended at offset `to`. `from`: offset of a packet's first byte. `file`
  /// must outlive this.
  explicit RecordingReader(const RecordingFile& file,
                           std::uint64_t from = 0,
                           std::uint64_t to = std::numeric_limits<std::uint64_t>::max())
      : file_(file), chunk_(file.chunk_bytes()), to_(to), start_(from), read_(from), end_(from) {}

  /// The next packet; none at the end. Throws UnsupportedWireVersion, and as RecordingFile::read().
  [[nodiscard]] std::optional<RecordedPacket> next();

  /// Bytes after the last packet that belong to none; valid once next() returned none.
  std::uint64_t damage_at_end() const { return read_ - end_; }
  /// File offset of the packet that next() came to last, also where it threw.
  std::uint64_t offset() const { return offset_; }
  /// File offset of the end of the last packet that it returned.
  std::uint64_t end() const { return end_; }
  const WireDamage& damage() const { return framer_.damage(); }

 private:
  std::optional<PacketFrame> next_frame();

  const RecordingFile& file_;
  PacketFramer framer_;
  std::vector<std::byte> chunk_;
  std::uint64_t to_;
  std::uint64_t start_;  ///< file offset of the first byte read
  std::uint64_t read_;   ///< file offset of the next byte to read
  std::uint64_t end_;    ///< file offset of the end of the last packet
  std::uint64_t offset_ = 0;
  bool finished_ = false;
};

/// Calls take() for each packet that follows, until one from which on nothing can be interpreted,
/// and returns that place. `take` may throw UnreadableStream, as StreamAudit does.
template <class Take>
std::optional<UnreadablePlace> for_each_packet(RecordingReader& reader, Take&& take) {
  try {
    while (const auto recorded = reader.next()) take(*recorded);
  } catch (const UnreadableStream& error) {
    return UnreadablePlace{reader.offset(), error.what()};
  }
  return {};
}

}  // namespace wobblebench::hw
