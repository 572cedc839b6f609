// A disk that is full, for this process.
#pragma once

#include <sys/resource.h>

#include <csignal>

namespace wobblebench::testing_support {

/// While it lives no file may grow beyond `bytes`: writing more fails.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : on_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, on_signal_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  void (*on_signal_)(int);
  rlimit before_{};
};

}  // namespace wobblebench::testing_support
