// A FUSE file system of one file, the device node of an emulated card.
#pragma once

struct fuse_lowlevel_ops;

namespace wobblebench::hw {

/// Name of the file: the driver's name of its first card-to-host stream.
inline constexpr char kNodeName[] = "xdma0_c2h_0";

/// Request handlers; may run on any number of threads. The session's user data is an XdmaCard.
const fuse_lowlevel_ops& fuse_node_operations();

}  // namespace wobblebench::hw
