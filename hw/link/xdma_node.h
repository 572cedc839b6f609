// Opens the device node of a card's stream, after checking its kind.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "base/file.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

enum class XdmaNodeKind {
  card,      ///< a character device
  fifo,      ///< a named pipe
  emulator,  ///< a file on a FUSE file system: the emulated driver
};

/// The alignment that suits every engine: a page.
inline constexpr std::size_t kPageBytes = 4096;

struct XdmaNode {
  FileDescriptor file;
  XdmaNodeKind kind = XdmaNodeKind::card;
  /// Of address and length of each transfer, bytes; a power of two.
  std::size_t alignment = 1;
};

/// Opens for reading; a FIFO without blocking. While another program has the node open, retries
/// until `busy_until`. Throws LinkOpenError.
XdmaNode open_xdma_node(const std::filesystem::path& path, bool end_of_packet, HostTime busy_until);

/// A call of the driver that ended without a result, and is to be made again: it was interrupted,
/// or timed out. Drivers before June 2026 answer a time-out with ERESTARTSYS, 512, one of the
/// kernel's own codes, which reach a program that no signal has interrupted.
bool is_to_be_repeated(int error_number);

/// Text of an errno: "No such device (ENODEV)".
std::string error_text(int error_number);

}  // namespace wobblebench::hw
