// The file that a card's stream is read from: checked, then opened.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "base/file_descriptor.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

enum class XdmaNodeKind {
  card,      ///< a character device
  fifo,      ///< a named pipe
  stand_in,  ///< a file of a FUSE file system: what stands in for the driver
};

struct XdmaNode {
  FileDescriptor file;
  XdmaNodeKind kind = XdmaNodeKind::card;
  /// Bytes. Address and length of each transfer are multiples of it; a power of two.
  std::size_t alignment = 1;
};

/// Opens for reading; a FIFO without blocking. While another program has the node, tries again
/// until `busy_until`. Throws LinkOpenError.
XdmaNode open_xdma_node(const std::filesystem::path& path, bool end_of_packet, HostTime busy_until);

/// "No such device (ENODEV)".
std::string error_text(int error_number);

}  // namespace wobblebench::hw
