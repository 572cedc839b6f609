#include "phantoms/import/confine.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace wobblebench::phantoms {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

#if defined(__x86_64__) || defined(__aarch64__)
/// Calls that reading, computing and ending take. None of them makes a file, a socket or a process.
constexpr std::uint32_t kAllowed[] = {
    __NR_read,
    __NR_readv,
    __NR_pread64,
    __NR_write,
    __NR_writev,
    __NR_lseek,
    __NR_close,
    __NR_fstat,
    __NR_newfstatat,
    __NR_statx,
    __NR_faccessat,
    __NR_readlinkat,
    __NR_getcwd,
    __NR_fcntl,
    __NR_flock,
    __NR_fadvise64,
    __NR_ftruncate,
    __NR_mmap,
    __NR_munmap,
    __NR_mprotect,
    __NR_mremap,
    __NR_madvise,
    __NR_brk,
    __NR_futex,
    __NR_rt_sigaction,
    __NR_rt_sigprocmask,
    __NR_rt_sigreturn,
    __NR_sigaltstack,
    __NR_sched_yield,
    __NR_sched_getaffinity,
    __NR_getrandom,
    __NR_uname,
    __NR_sysinfo,
    __NR_getpid,
    __NR_gettid,
    __NR_getuid,
    __NR_geteuid,
    __NR_clock_gettime,
    __NR_clock_nanosleep,
    __NR_nanosleep,
    __NR_gettimeofday,
    __NR_getrusage,
    __NR_set_robust_list,
    __NR_rseq,
    __NR_restart_syscall,
    __NR_exit,
    __NR_exit_group,
#if defined(__x86_64__)
    __NR_stat,
    __NR_lstat,
    __NR_access,
    __NR_readlink,
    __NR_time,
    __NR_poll,
#endif
};

constexpr std::uint32_t offset_of_argument(int index) {  // its low half
  return static_cast<std::uint32_t>(offsetof(seccomp_data, args) + sizeof(std::uint64_t) * index);
}

/// A program of the kernel's packet filter: each statement ends in an answer, or goes on.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
    answer(SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
  }
  void allow(std::uint32_t call) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    answer(SECCOMP_RET_ALLOW);
  }
  /// Allows the call where a test of one of its arguments gives `holds`.
  void allow_if(std::uint32_t call, int argument, int test, std::uint32_t value, bool holds) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4);
    load(offset_of_argument(argument));
    add(static_cast<std::uint16_t>(BPF_JMP | test | BPF_K), value, holds ? 0 : 1, holds ? 1 : 0);
    answer(SECCOMP_RET_ALLOW);
    answer(SECCOMP_RET_ERRNO | EACCES);
  }
  /// "Not there": the C library then takes an older call, if there is one.
  bool install() {
    answer(SECCOMP_RET_ERRNO | ENOSYS);
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  void add(std::uint16_t code, std::uint32_t value, std::uint8_t yes, std::uint8_t no) {
    code_.push_back({code, yes, no, value});
  }
  void load(std::size_t offset) {
    add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset), 0, 0);
  }
  void answer(std::uint32_t value) { add(BPF_RET | BPF_K, value, 0, 0); }

  std::vector<sock_filter> code_;
};

bool install_filter() {
  constexpr std::uint32_t kWriting = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
  Filter filter;
  for (const std::uint32_t call : kAllowed) filter.allow(call);
#if defined(__x86_64__)
  filter.allow_if(__NR_open, 1, BPF_JSET, kWriting, false);
#endif
  filter.allow_if(__NR_openat, 2, BPF_JSET, kWriting, false);
  filter.allow_if(__NR_clone, 0, BPF_JSET, CLONE_THREAD, true);
  // As abort() does.
  filter.allow_if(__NR_tgkill, 0, BPF_JEQ, static_cast<std::uint32_t>(::getpid()), true);
  return filter.install();
}
#else
bool install_filter() {
  return false;
}
#endif

}  // namespace

bool die_with(pid_t parent) {
  return ::prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && ::getppid() == parent;
}

bool give_up_system_calls() {
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && install_filter();
}

}  // namespace wobblebench::phantoms
