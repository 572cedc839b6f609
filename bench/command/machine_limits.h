// What limits of the system would make of a program that does not expect them.
#pragma once

#include <string>

namespace wobblebench::bench {

/// To be called first in main(), before any thread.
///
/// A write beyond the limit of a file's size (RLIMIT_FSIZE) fails with EFBIG, as on a full disk,
/// and ends nothing. Where the address space is limited (RLIMIT_AS), OpenGL's drivers crash for
/// want of memory: the program ends with one line and exit code 1 then. Mesa maps its shader cache,
/// and a mapped file that the disk has no room for is a SIGBUS: where the cache's disk has less
/// than kLeastCacheRoom bytes left, shaders are compiled anew. A relative $XDG_CACHE_HOME is unset
/// (cache_home()). `program`: its name; must outlive
/// the program's run.
void expect_machine_limits(const char* program);

/// ": the address space is limited to 614 MB (ulimit -v)"; empty: it is not.
std::string address_space_limit();

/// Several times what Mesa's index of shaders takes.
inline constexpr unsigned long long kLeastCacheRoom = 32'000'000;

}  // namespace wobblebench::bench
