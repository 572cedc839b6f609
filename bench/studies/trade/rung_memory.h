// Peak memory of a function, measured in a forked process.
#pragma once

#include <functional>
#include <string>

namespace wobblebench::bench {

/// Runs `body` in a fork of this process and returns the peak resident size of that, in bytes
/// (getrusage). Must be called before this process works on other threads, which a fork does not
/// have. (Threads that libraries start idle when loaded, as OpenVDB's logging does, are not
/// needed.) Throws std::runtime_error if the body fails.
double peak_memory_bytes(const std::function<void()>& body);

}  // namespace wobblebench::bench
