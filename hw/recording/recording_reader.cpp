#include "hw/recording/recording_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "hw/link/link.h"
#include "hw/wire/decoder.h"

namespace wobblebench::hw {

namespace {

[[noreturn]] void refuse(OpenFault fault,
                         const std::filesystem::path& path,
                         const std::string& what) {
  throw LinkOpenError(fault, path.string() + ": " + what + "; must be a recording");
}

OpenFault fault_of(int reason) {
  if (reason == ENOENT || reason == ENOTDIR) return OpenFault::missing;
  if (reason == EACCES || reason == EPERM) return OpenFault::not_permitted;
  return OpenFault::gone;
}

/// Skips damage at the start.
void check_first_packet(const RecordingFile& recording) {
  Decoder decoder;
  std::vector<std::byte> chunk(recording.chunk_bytes());
  for (std::uint64_t offset = 0; offset < recording.bytes();) {
    const std::size_t count = recording.read(offset, chunk);
    if (count == 0) break;
    decoder.feed(std::span(chunk).first(count));
    offset += count;
    if (offset >= recording.bytes()) decoder.finish();
    try {
      if (decoder.next()) return;
    } catch (const UnsupportedWireVersion& version) {
      throw LinkOpenError(OpenFault::later_version,
                          recording.path().string() + ": " + version.what());
    }
  }
  if (decoder.wrong_checksums() == 0) {
    refuse(OpenFault::foreign, recording.path(), "holds no packet of the wire format");
  }
  throw LinkOpenError(OpenFault::foreign,
                      recording.path().string() + ": the checksums of all its packets (" +
                          std::to_string(decoder.wrong_checksums()) +
                          ") are wrong; must be CRC-32C (docs/wire_format.md)");
}

}  // namespace

RecordingFile::RecordingFile(const std::filesystem::path& path) : path_(path) {
  // Does not wait for the writer of a FIFO, which is refused below.
  file_ = FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file_.is_open()) refuse(fault_of(errno), path, std::strerror(errno));
  struct stat status {};
  if (::fstat(file_.get(), &status) != 0) refuse(OpenFault::gone, path, std::strerror(errno));
  if (S_ISDIR(status.st_mode)) refuse(OpenFault::wrong_kind, path, "is a folder");
  if (!S_ISREG(status.st_mode)) {
    refuse(OpenFault::wrong_kind, path, "is no file (a device or FIFO is opened with xdma=)");
  }
  if (status.st_size == 0) refuse(OpenFault::empty, path, "is empty");
  bytes_ = static_cast<std::uint64_t>(status.st_size);
  check_first_packet(*this);
}

std::size_t RecordingFile::read(std::uint64_t offset, std::span<std::byte> buffer) const {
  std::size_t done = 0;
  while (done < buffer.size()) {
    const ssize_t count = ::pread(
        file_.get(), buffer.data() + done, buffer.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      throw std::runtime_error(path_.string() + ": cannot be read: " + std::strerror(errno));
    }
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

std::optional<PacketFrame> RecordingReader::next_frame() {
  for (;;) {
    if (auto frame = framer_.next()) return frame;
    if (finished_) return {};
    const auto wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(chunk_.size(), to_ - read_));
    const std::size_t count = file_.read(read_, std::span(chunk_).first(wanted));
    read_ += count;
    framer_.feed(std::span(chunk_).first(count));
    finished_ = count < wanted || read_ == to_;
    if (finished_) framer_.finish();
  }
}

std::optional<RecordedPacket> RecordingReader::next() {
  while (const auto frame = next_frame()) {
    RecordedPacket recorded{.bytes = frame->bytes, .offset = start_ + frame->offset};
    offset_ = recorded.offset;
    if (packet_version(frame->bytes) != kWireVersion) {
      throw UnsupportedWireVersion(packet_version(frame->bytes));
    }
    if (is_known_kind(frame->bytes)) {
      recorded.packet = parse_packet(frame->bytes);
      if (!recorded.packet) {
        framer_.reject_last();
        continue;
      }
    }
    recorded.damage_before = recorded.offset - end_;
    end_ = recorded.offset + recorded.bytes.size();
    return recorded;
  }
  return {};
}

}  // namespace wobblebench::hw
