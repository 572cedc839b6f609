#include "bench/command/stop_signals.h"

#include <csignal>
#include <initializer_list>

namespace wobblebench::bench {

namespace {

/// Set by a signal handler, which can reach nothing but a global variable.
volatile std::sig_atomic_t requested = 0;

void on_signal(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void stop_in_order() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, on_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

bool stop_requested() {
  return requested != 0;
}

}  // namespace wobblebench::bench
