// Peak memory of a function, measured in a forked process.
#pragma once

#include <functional>
#include <string>

namespace wobblebench::bench {

/// Runs `body` in a fork of this process and returns the peak resident size of that, in bytes
/// (getrusage). Must be called before this process works on other threads, which a fork does not
/// have. (Threads that libraries start idle when loaded, as OpenVDB's logging does, are not
/// needed.) Throws UserError for what the user gave (bench/scene/late_refusal.h), and
/// std::runtime_error for every other failure of the body.
double peak_memory_bytes(const std::function<void()>& body);

}  // namespace wobblebench::bench
