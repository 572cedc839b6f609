// The most memory that a piece of work holds, measured in a process of its own.
#pragma once

#include <functional>
#include <string>

namespace wobblebench::bench {

/// Runs `body` in a copy of this process and returns the largest resident size that the copy had,
/// in bytes (getrusage). Must be called before this process starts a thread: a copy has only the
/// one that asked for it. Throws std::logic_error if it has others, std::runtime_error if the body
/// fails.
double peak_memory_bytes(const std::function<void()>& body);

}  // namespace wobblebench::bench
