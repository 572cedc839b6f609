// A FUSE file system of one file, the node of a card: what the kernel asks, and what is answered.
#pragma once

struct fuse_lowlevel_ops;

namespace wobblebench::hw {

/// The file's name, as the driver calls its first stream from the card.
inline constexpr char kNodeName[] = "xdma0_c2h_0";

/// The user data of the session is an XdmaCard. Answers on any number of threads.
const fuse_lowlevel_ops& fuse_node_operations();

}  // namespace wobblebench::hw
