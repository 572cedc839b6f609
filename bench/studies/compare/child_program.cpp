#include "bench/studies/compare/child_program.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "base/file.h"

namespace wobblebench::bench {

namespace {

constexpr int kNotStarted = 127;

FileDescriptor memory_file() {
  FileDescriptor file(::memfd_create("wobblebench-child", MFD_CLOEXEC));
  if (!file.is_open())
    throw std::runtime_error(std::string("memory file: ") + std::strerror(errno));
  return file;
}

std::string text_in(int file) {
  std::string text(static_cast<std::size_t>(::lseek(file, 0, SEEK_END)), '\0');
  const auto read = ::pread(file, text.data(), text.size(), 0);
  text.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
  return text;
}

/// In the child, after fork(): calls that are safe there alone.
[[noreturn]] void become(
    pid_t parent, const char* program, char* const* arguments, int output, int error) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(kNotStarted);  // that has ended meanwhile, unseen
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(output < 0 ? nothing : output, STDOUT_FILENO);
  ::dup2(error, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U, 0);  // also of libraries, which an exec() would keep
  ::execv(program, arguments);
  ::_exit(kNotStarted);
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.substr(text.find_last_of("\n\r") + 1);
}

/// `output`: for stdout; negative: dropped.
ChildEnd run(const std::filesystem::path& program,
             const std::vector<std::string>& arguments,
             int output) {
  std::string name = program.string();
  std::vector<std::string> words = arguments;
  std::vector<char*> pointers = {name.data()};
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const FileDescriptor errors = memory_file();
  const pid_t self = ::getpid(), child = ::fork();
  if (child < 0) throw std::runtime_error(name + ": cannot be started: " + std::strerror(errno));
  if (child == 0) become(self, name.c_str(), pointers.data(), output, errors.get());
  const int code = wait_for(child);
  if (code == kNotStarted) throw std::runtime_error(name + ": cannot be started");
  return {code, last_line(text_in(errors.get()))};
}

}  // namespace

ChildEnd run_child(const std::filesystem::path& program,
                   const std::vector<std::string>& arguments) {
  return run(program, arguments, -1);
}

std::string output_of_child(const std::filesystem::path& program,
                            const std::vector<std::string>& arguments) {
  const FileDescriptor output = memory_file();
  const ChildEnd end = run(program, arguments, output.get());
  if (end.exit_code != 0) throw std::runtime_error(program.string() + ": " + end.last_error);
  return text_in(output.get());
}

}  // namespace wobblebench::bench
