#include "phantoms/io/import_process.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <system_error>

#include "base/file.h"
#include "base/start_program.h"
#include "phantoms/io/message.h"

namespace wobblebench::phantoms {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "wobblebench-import";

/// Beside the running program, as both are installed; then where this library's build put it.
fs::path import_program() {
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::string searched;
  for (const fs::path& folder :
       {own, fs::path(WOBBLEBENCH_INSTALLED_PROGRAMS), fs::path(WOBBLEBENCH_BUILT_PROGRAMS)}) {
    fs::path program = folder / kProgram;
    if (!folder.empty() && ::access(program.c_str(), X_OK) == 0) return program;
    searched += (searched.empty() ? "" : ", ") + folder.string();
  }
  throw ImportUnavailable(std::string("the program ") + kProgram +
                          ", which reads .vdb files, meshes and HDF5, is not in " + searched);
}

const char* name_of(ImportFormat format) {
  switch (format) {
    case ImportFormat::vdb:
      return "vdb";
    case ImportFormat::mesh:
      return "mesh";
    case ImportFormat::hdf5:
      return "hdf5";
    case ImportFormat::zea:
      return "zea";
  }
  throw std::logic_error("ImportFormat: no such format");
}

/// Starts the program and returns its status as waitpid() gives it.
int run_import(ImportFormat format, const fs::path& path, int message) {
  const fs::path program = import_program();
  // Parsers and the allocator print before they abort; the one line is ours.
  pid_t child = 0;
  const int failed =
      start_program(child,
                    {program.string(), name_of(format), path.string(), std::to_string(::getpid())},
                    {-1, -1, -1, message},
                    Session::shared);
  if (failed != 0) {
    throw ImportUnavailable(program.string() + ": cannot be started: " + std::strerror(failed));
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno == EINTR) continue;
    throw ImportUnavailable(program.string() + ": its end cannot be seen: " + std::strerror(errno));
  }
  return status;
}

/// Why there is no message. Throws ImportUnavailable where that says nothing of the file.
std::string ending(int status, const fs::path& path) {
  if (!WIFSIGNALED(status)) return "is damaged: reading it failed";
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU) {
    std::error_code ignored;
    return "is damaged: reading it took more than " +
           std::to_string(most_import_seconds(fs::file_size(path, ignored))) + " s";
  }
  // Of the machine, and not of the file: nobody may take it down as a bad one.
  const char* const stopped = signal == SIGKILL   ? "its reader was killed, as for want of memory"
                              : signal == SIGALRM ? "reading it took too long"
                                                  : nullptr;
  if (stopped != nullptr)
    throw ImportUnavailable(path.string() + ": could not be tried: " + stopped);
  return std::string("is damaged: reading it ended in signal ") + std::to_string(signal) + " (" +
         ::strsignal(signal) + ")";
}

std::string_view mapped(int file) {
  struct stat info {};
  if (::fstat(file, &info) != 0 || info.st_size == 0) return {};
  const auto size = static_cast<std::size_t>(info.st_size);
  void* const data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  return {static_cast<const char*>(data), size};
}

}  // namespace

ImportedBytes::ImportedBytes(ImportFormat format, const fs::path& path) {
  // A parser may take a read that fails for the end of the file, and what it has for the whole.
  read_pieces(path, [](std::string_view) {});
  const FileDescriptor file(::memfd_create("wobblebench-import", MFD_CLOEXEC));
  if (!file.is_open()) throw ImportUnavailable(std::string("memory file: ") + std::strerror(errno));
  const int status = run_import(format, path, file.get());
  constexpr std::size_t kWord = sizeof(std::uint32_t);
  mapped_ = mapped(file.get());
  try {
    if (status != 0 || mapped_.size() < 2 * kWord)
      throw std::invalid_argument(ending(status, path));
    MessageReader first(mapped_), last(mapped_.substr(mapped_.size() - kWord));
    const auto kind = first.get<std::uint32_t>();
    if (last.get<std::uint32_t>() != kMessageEnd) throw std::invalid_argument(ending(status, path));
    if (kind == kImportRefusal) throw std::invalid_argument(first.text());
    message_ = mapped_.substr(kWord, mapped_.size() - 2 * kWord);
  } catch (...) {
    ::munmap(const_cast<char*>(mapped_.data()), mapped_.size());
    throw;
  }
}

ImportedBytes::~ImportedBytes() {
  if (!mapped_.empty()) ::munmap(const_cast<char*>(mapped_.data()), mapped_.size());
}

}  // namespace wobblebench::phantoms
