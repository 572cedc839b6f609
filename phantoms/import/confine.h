// What a process that reads files of others gives up before it opens one.
#pragma once

#include <sys/types.h>

namespace wobblebench::phantoms {

/// The process is killed when `parent` ends. Returns false if that has happened already.
[[nodiscard]] bool die_with(pid_t parent);

/// From here on the process starts no program, gains no privileges, opens no network connection and
/// no file to write to, and changes no file but through descriptors that are open: other system
/// calls fail (a seccomp filter). Returns false where the system has no such filter.
[[nodiscard]] bool give_up_system_calls();

}  // namespace wobblebench::phantoms
