#include "bench/output/removals.h"

#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

struct Noted {
  const char* path;
  bool folder;
};

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

// State of the signal handler, which has no other way to get it: it may only read plain memory and
// call unlink(2) and rmdir(2). `count` publishes the entries.
constexpr std::size_t kMost = 256;
std::array<Noted, kMost> noted;
std::atomic<std::size_t> count = 0;
pthread_t owner;

void remove_noted() {
  for (std::size_t i = count.load(); i-- > 0;) {
    noted[i].folder ? ::rmdir(noted[i].path) : ::unlink(noted[i].path);
  }
}

/// A signal may be delivered to any thread.
void on_signal(int signal) {
  if (!::pthread_equal(::pthread_self(), owner)) {
    ::pthread_kill(owner, signal);
    return;
  }
  remove_noted();
  ::_exit(128 + signal);
}

}  // namespace

Removals::Removals() {
  owner = ::pthread_self();
  for (const int signal : kSignals) {
    const auto before = std::signal(signal, on_signal);
    // Under nohup(1) the program is to live on.
    if (signal == SIGHUP && before == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

Removals::~Removals() {
  remove_noted();
  count.store(0);
}

void Removals::note(const std::filesystem::path& path, bool folder) {
  const std::size_t index = count.load();
  if (index == kMost) throw std::runtime_error(path.string() + ": too many files");
  paths_.push_back(path);
  noted[index] = {paths_.back().c_str(), folder};
  count.store(index + 1);
}

BlockedSignals::BlockedSignals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  for (const int signal : kSignals) ::sigaddset(&signals, signal);
  ::pthread_sigmask(SIG_BLOCK, &signals, &before_);
}

BlockedSignals::~BlockedSignals() {
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace wobblebench::bench
