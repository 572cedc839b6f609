// A FUSE file system of one file, the device node of an emulated card.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "base/file.h"

struct fuse_session;

namespace wobblebench::hw {

/// Name of the file: the driver's name of its first card-to-host stream.
inline constexpr char kNodeName[] = "xdma0_c2h_0";

class XdmaCard;

/// The mounted file system, and the threads that serve it.
class FuseSession {
 public:
  /// Mounts the node of `card` on `folder`. Throws std::runtime_error "FOLDER: reason".
  FuseSession(const std::filesystem::path& folder, XdmaCard& card);
  /// Answers the pending requests, and unmounts, even if files are open.
  ~FuseSession();
  FuseSession(const FuseSession&) = delete;
  FuseSession& operator=(const FuseSession&) = delete;

 private:
  void serve();

  fuse_session* session_;
  std::atomic<bool> stopping_ = false;
  FileDescriptor stop_;  ///< an eventfd, never read: wakes all threads once stopping_ is set
  std::vector<std::jthread> threads_;
};

}  // namespace wobblebench::hw
