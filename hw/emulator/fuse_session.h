// A mounted FUSE file system with threads that answer for it.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "base/file_descriptor.h"

struct fuse_session;

namespace wobblebench::hw {

class XdmaCard;

class FuseSession {
 public:
  /// Mounts the node of `card` on `folder`. Throws std::runtime_error: "FOLDER: why".
  FuseSession(const std::filesystem::path& folder, XdmaCard& card);
  /// Answers what was asked until now, and unmounts, whoever has files open.
  ~FuseSession();
  FuseSession(const FuseSession&) = delete;
  FuseSession& operator=(const FuseSession&) = delete;

 private:
  void serve();

  fuse_session* session_;
  std::atomic<bool> stopping_ = false;
  FileDescriptor stop_;  ///< an eventfd, never read: readable for all threads from the end on
  std::vector<std::thread> threads_;
};

}  // namespace wobblebench::hw
