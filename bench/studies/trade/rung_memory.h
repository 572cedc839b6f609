// The most memory that a piece of work holds, measured in a process of its own.
#pragma once

#include <functional>
#include <string>

namespace wobblebench::bench {

/// Runs `body` in a copy of this process and returns the largest resident size that the copy had,
/// in bytes (getrusage). Must be called before this process does any work on other threads: a
/// copy has only the one that asked for it. (Idle ones that libraries start when they are loaded,
/// as OpenVDB's logging does, are not missed.) Throws std::runtime_error if the body fails.
double peak_memory_bytes(const std::function<void()>& body);

}  // namespace wobblebench::bench
