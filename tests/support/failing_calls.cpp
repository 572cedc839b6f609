// Preloaded into a program (LD_PRELOAD): makes one of its system calls or allocations fail, or
// kills it there. WOBBLEBENCH_FAIL=KIND:N:fail|kill names the Nth call of a kind after main()
// begins: open, write, rename, sync, link or allocate; `any` is each of these but allocate, and
// what else changes files. When that call is reached, the file WOBBLEBENCH_FAIL_REACHED is made.
// WOBBLEBENCH_FLOCK_ERRNO=NUMBER: every flock(2) fails so, as on a file system without it.
// WOBBLEBENCH_NO_THREADS=1: no thread can be started, from before main() on.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

std::atomic<bool> in_main = false;
std::atomic<long> calls = 0;
char kind_wanted[16] = "";
long wanted = 0;
bool kills = false;

void read_settings() {
  const char* text = std::getenv("WOBBLEBENCH_FAIL");
  const char* colon = text == nullptr ? nullptr : std::strchr(text, ':');
  if (colon == nullptr || colon - text >= static_cast<long>(sizeof kind_wanted)) return;
  std::memcpy(kind_wanted, text, static_cast<std::size_t>(colon - text));
  wanted = std::atol(colon + 1);
  kills = std::strstr(colon, ":kill") != nullptr;
}

/// True if this call is the one to fail.
bool is_reached(const char* kind, bool changes_files = true) {
  if (!in_main) return false;
  const bool any = changes_files && std::strcmp(kind_wanted, "any") == 0;
  if ((!any && std::strcmp(kind, kind_wanted) != 0) || ++calls != wanted) return false;
  const long file = ::syscall(
      SYS_openat, AT_FDCWD, std::getenv("WOBBLEBENCH_FAIL_REACHED"), O_CREAT | O_WRONLY, 0644);
  ::syscall(SYS_close, file);
  if (kills) ::raise(SIGKILL);
  return true;
}

/// The function of that name that the program would have called.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

int fail(int reason) {
  errno = reason;
  return -1;
}

int (*real_main)(int, char**, char**) = nullptr;

int run_main(int argc, char** argv, char** environment) {
  read_settings();
  in_main = true;
  return real_main(argc, argv, environment);
}

int open_file(const char* name, const char* path, int flags, mode_t mode) {
  static auto* const real = next<int(const char*, int, ...)>(name);
  return is_reached("open", (flags & O_CREAT) != 0) ? fail(EIO) : real(path, flags, mode);
}

mode_t mode_of(int flags, std::va_list arguments) {
  return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**),
                      int argc,
                      char** argv,
                      void (*init)(),
                      void (*fini)(),
                      void (*rtld_fini)(),
                      void* stack_end) {
  real_main = main;
  return next<decltype(__libc_start_main)>("__libc_start_main")(
      run_main, argc, argv, init, fini, rtld_fini, stack_end);
}

int open(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_file("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_file("open64", path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  static auto* const real = next<int(int, const char*, int, ...)>("openat");
  return is_reached("open", (flags & O_CREAT) != 0) ? fail(EIO) : real(folder, path, flags, mode);
}

ssize_t write(int file, const void* bytes, size_t count) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  return file > STDERR_FILENO && is_reached("write") ? fail(ENOSPC) : real(file, bytes, count);
}

int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  return is_reached("rename") ? fail(EIO) : real(from, to);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  static auto* const real = next<int(int, const char*, int, const char*)>("renameat");
  return is_reached("rename") ? fail(EIO) : real(from_folder, from, to_folder, to);
}

int fsync(int file) {
  static auto* const real = next<int(int)>("fsync");
  return is_reached("sync") ? fail(EIO) : real(file);
}

int fdatasync(int file) {
  static auto* const real = next<int(int)>("fdatasync");
  return is_reached("sync") ? fail(EIO) : real(file);
}

int link(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("link");
  return is_reached("link") ? fail(EIO) : real(from, to);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  static auto* const real = next<int(int, const char*, int, const char*, int)>("linkat");
  return is_reached("link") ? fail(EIO) : real(from_folder, from, to_folder, to, flags);
}

int mkdir(const char* path, mode_t mode) noexcept {
  static auto* const real = next<int(const char*, mode_t)>("mkdir");
  return is_reached("mkdir") ? fail(EIO) : real(path, mode);
}

int mkdirat(int folder, const char* path, mode_t mode) noexcept {
  static auto* const real = next<int(int, const char*, mode_t)>("mkdirat");
  return is_reached("mkdir") ? fail(EIO) : real(folder, path, mode);
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  static auto* const real = next<int(int, const char*, int)>("unlinkat");
  return is_reached("unlink") ? fail(EIO) : real(folder, path, flags);
}

int unlink(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("unlink");
  return is_reached("unlink") ? fail(EIO) : real(path);
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"  // of the structure of the same name
int flock(int file, int operation) noexcept {
  static auto* const real = next<int(int, int)>("flock");
  const char* const reason = std::getenv("WOBBLEBENCH_FLOCK_ERRNO");
  return reason != nullptr ? fail(std::atoi(reason)) : real(file, operation);
}
#pragma GCC diagnostic pop

int pthread_create(pthread_t* thread,
                   const pthread_attr_t* attributes,
                   void* (*body)(void*),
                   void* argument) noexcept {
  static auto* const real = next<decltype(pthread_create)>("pthread_create");
  if (std::getenv("WOBBLEBENCH_NO_THREADS") != nullptr) return EAGAIN;
  return real(thread, attributes, body, argument);
}

int ftruncate64(int file, off64_t bytes) noexcept {
  static auto* const real = next<int(int, off64_t)>("ftruncate64");
  return is_reached("truncate") ? fail(EIO) : real(file, bytes);
}

int ftruncate(int file, off_t bytes) noexcept {
  return ftruncate64(file, bytes);
}

}  // extern "C"

void* operator new(std::size_t size) {
  void* const memory = is_reached("allocate", false) ? nullptr : std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
