#include "bench/exchange/program/renderer_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/number_text.h"
#include "base/start_program.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 10'000;

struct Defined {
  std::string command;
  bool asked = false;  ///< for the command
};
std::map<std::string, Defined>& commands() {
  static std::map<std::string, Defined> all;
  return all;
}

fs::path make_folder() {
  std::string path = (fs::temp_directory_path() / "wobblebench-renderer-XXXXXX").string();
  if (::mkdtemp(path.data()) == nullptr) {
    throw std::runtime_error(path + ": cannot be made: " + std::strerror(errno));
  }
  return path;
}

/// Both ends are closed in other programs that this process starts.
std::array<FileDescriptor, 2> socket_pair() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::runtime_error(std::string("no socket for a program: ") + std::strerror(errno));
  }
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

/// Runs the command and, when that and its stdin have ended, removes the folder: stdin ends with
/// this process, however that ends. stdout is closed first, so that the end of the command is seen.
constexpr const char* kScript =
    R"((eval "$1"); code=$?; exec >&-; cat >/dev/null; rm -rf -- "$2"; exit $code)";

/// The shell tells a signal that ended its command as 128 + the signal's number.
std::string text_of_end(int status) {
  constexpr int kNotFound = 127, kSignal = 128;
  const int code = WIFSIGNALED(status) ? kSignal + WTERMSIG(status) : WEXITSTATUS(status);
  if (code == kNotFound) return "its command was not found (exit code 127)";
  const std::string how = code > kSignal ? "was ended by signal " + std::to_string(code - kSignal)
                                         : "ended with exit code " + std::to_string(code);
  return how + " before it answered";
}

}  // namespace

void define_renderers(const std::vector<std::string>& definitions) {
  for (const std::string& definition : definitions) {
    const auto equals = definition.find('=');
    const std::string name = definition.substr(0, equals);
    const bool named = !name.empty() && std::ranges::all_of(name, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             c == '_' || c == '-';
    });
    if (equals == std::string::npos || !named || equals + 1 == definition.size()) {
      throw UserError("--renderer = " + definition +
                      ": must be NAME=COMMAND, with a name of letters, digits, _ and -");
    }
    commands()[name] = {definition.substr(equals + 1)};
  }
}

const std::string* defined_renderer(const std::string& name) {
  const auto found = commands().find(name);
  if (found == commands().end()) return nullptr;
  found->second.asked = true;
  return &found->second.command;
}

const std::string& renderer_command(const std::string& name) {
  if (const std::string* command = defined_renderer(name)) return *command;
  throw UserError("render.program = " + name +
                  ": is not defined; the command line must say which program that is: --renderer " +
                  name + "='COMMAND'");
}

void refuse_unused_renderers() {
  for (const auto& [name, defined] : commands()) {
    if (defined.asked) continue;
    throw UserError("--renderer " + name + "=" + defined.command +
                    ": without effect: nothing sets render.program = " + name);
  }
}

RendererProcess::RendererProcess(std::string name, const std::string& command)
    : name_(std::move(name)), folder_(make_folder()) {
  start(command);
}

void RendererProcess::start(const std::string& command) {
  auto [mine, its_input] = socket_pair();
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail(std::string("no pipe: ") + std::strerror(errno));
  output_ = FileDescriptor(ends[0]);
  const FileDescriptor its_output(ends[1]);
  // The shell takes the word behind its script for its name.
  const int error = start_program(process_,
                                  {"/bin/sh", "-c", kScript, "sh", command, folder_.string()},
                                  {its_input.get(), its_output.get(), STDERR_FILENO},
                                  Session::own);
  if (error != 0) fail(std::string("cannot be started: ") + std::strerror(error));
  input_ = std::move(mine);
}

RendererProcess::~RendererProcess() {
  input_.close();
  using namespace std::chrono_literals;
  const auto until = Clock::now() + 2s;
  int status = 0;
  while (process_ > 0 && Clock::now() < until) {
    if (::waitpid(process_, &status, WNOHANG) != 0) process_ = -1;
    if (process_ > 0) std::this_thread::sleep_for(10ms);
  }
  if (process_ > 0) {
    ::kill(-process_, SIGKILL);
    ::waitpid(process_, &status, 0);
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void RendererProcess::fail(const std::string& what) const {
  throw std::runtime_error("render.program = " + name_ + ": " + what);
}

/// How the program ended, once its stdout is closed.
std::string RendererProcess::ending() {
  using namespace std::chrono_literals;
  input_.close();
  int status = 0;
  for (int i = 0; i < 200; ++i) {
    if (::waitpid(process_, &status, WNOHANG) == process_) {
      process_ = -1;
      return text_of_end(status);
    }
    std::this_thread::sleep_for(10ms);
  }
  return "closed its stdout before it answered";
}

void RendererProcess::send(const std::string& line) {
  std::string_view left = line;
  while (!left.empty()) {
    const ssize_t sent = ::send(input_.get(), left.data(), left.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail(ending());
    left.remove_prefix(static_cast<std::size_t>(sent));
  }
}

bool RendererProcess::read_more(Clock::time_point until) {
  const auto left =
      std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
  pollfd waiting{output_.get(), POLLIN, 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(std::clamp<long>(left, 0, INT_MAX)));
  if (ready < 0 && errno == EINTR) return true;
  if (ready <= 0) {
    ::kill(-process_, SIGKILL);
    fail("gave no answer in time (render.program_timeout_s)");
  }
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(output_.get(), bytes.data(), bytes.size());
  if (count > 0) unread_.append(bytes.data(), static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && errno == EINTR);
}

std::string RendererProcess::ask(const std::string& line, std::chrono::duration<double> within) {
  const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(within);
  send(line + "\n");
  while (unread_.find('\n') == std::string::npos) {
    if (unread_.size() > kLongestLine) fail("answered with more than a line");
    if (!read_more(until)) fail(ending());
  }
  const auto end = unread_.find('\n');
  std::string answer = unread_.substr(0, end);
  unread_.erase(0, end + 1);
  if (!answer.empty() && answer.back() == '\r') answer.pop_back();
  return answer;
}

}  // namespace wobblebench::bench
