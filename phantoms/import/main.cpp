// wobblebench-import FORMAT FILE PARENT: reads a .vdb, a mesh or an HDF5 file for the program of
// this process number, and writes what it holds as a message to descriptor 3. A process of its own,
// with limits: a damaged file may make OpenVDB, Assimp or libhdf5 write where they must not.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>

#include "phantoms/import/confine.h"
#include "phantoms/import/parsers.h"

namespace wobblebench::phantoms {
namespace {

/// The soft limit, which ends the process in a signal that says why; the hard one lies above it.
void limit(__rlimit_resource resource, rlim_t most) {
  rlimit now{};
  ::getrlimit(resource, &now);
  now.rlim_max = std::min(most + 1, now.rlim_max);
  now.rlim_cur = std::min(most, now.rlim_max);
  ::setrlimit(resource, &now);
}

void limit_resources(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto bytes = std::filesystem::file_size(path, ignored);
  ::prctl(PR_SET_DUMPABLE, 0);
  limit(RLIMIT_CORE, 0);
  const unsigned long seconds = most_import_seconds(ignored ? 0 : bytes);
  limit(RLIMIT_CPU, seconds);
  // What it reads may wait for ever: a FIFO that the file names, or a disk of the network.
  ::alarm(static_cast<unsigned>(kWallPerProcessorTime * seconds));
  limit(RLIMIT_FSIZE, static_cast<rlim_t>(kMostImportBytes));
#if !defined(__SANITIZE_ADDRESS__) && !defined(WOBBLEBENCH_SANITIZED)
  limit(RLIMIT_AS, static_cast<rlim_t>(kMostImportBytes));  // a sanitizer's shadow takes terabytes
#endif
}

void confine() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(WOBBLEBENCH_SANITIZED)  // their reports take more
  if (give_up_system_calls()) return;
  throw std::invalid_argument(
      "cannot be read safely: this system has no seccomp filters, which keep a reader from writing "
      "files and from the network");
#endif
}

void write_message(const std::string& format, const std::filesystem::path& path, FILE* file) {
  MessageWriter out(file);
  out.put(kImportResult);
  if (format == "vdb") {
    write_vdb_message(path, out);
  } else if (format == "zea") {
#if defined(WOBBLEBENCH_HDF5)
    write_zea_message(path, out);
#else
    throw std::invalid_argument("this build does not read HDF5, which needs libhdf5-dev");
#endif
  } else if (format == "hdf5") {
#if defined(WOBBLEBENCH_HDF5)
    write_hdf5_message(path, out);
#else
    throw std::invalid_argument(
        "this build does not read HDF5, which needs libhdf5-dev; a .csv of the same columns will "
        "do");
#endif
  } else {
    write_mesh_message(path, out);
  }
  out.end();
}

void write_refusal(const std::string& reason, FILE* file) {
  // What was written of a result is dropped.
  std::fflush(file);
  if (::ftruncate(::fileno(file), 0) != 0) ::_exit(1);
  std::rewind(file);
  MessageWriter out(file);
  out.put(kImportRefusal);
  out.text(reason);
  out.end();
}

}  // namespace
}  // namespace wobblebench::phantoms

#if defined(WOBBLEBENCH_SANITIZED)
// A finding ends this program by a signal, as the crash would without the sanitizer.
extern "C" const char* __asan_default_options() {
  return "abort_on_error=1:detect_leaks=0";
}
#endif

int main(int argc, char** argv) {
  using namespace wobblebench::phantoms;
  FILE* const file = argc == 4 ? ::fdopen(kImportDescriptor, "w") : nullptr;
  if (file == nullptr) {
    std::fputs("wobblebench-import: is started by wobblebench, to read a file for it\n", stderr);
    return 2;
  }
  if (!die_with(static_cast<pid_t>(std::strtol(argv[3], nullptr, 10)))) return 1;
  limit_resources(argv[2]);
  try {
    try {
      confine();
      write_message(argv[1], argv[2], file);
    } catch (const std::bad_alloc&) {
      write_refusal("would take more memory than reading a file may", file);
    } catch (const std::exception& error) {
      write_refusal(error.what(), file);
    }
  } catch (const std::exception&) {
    ::_exit(1);
  }
  ::_exit(0);  // a heap that the file damaged is not tidied up
}
