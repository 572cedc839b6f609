// A program that answers a line with a line, in a process of its own.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.h"

namespace wobblebench::bench {

/// The renderers of other programs that this process may start, by their names: a scene or a plan
/// names one, and the command line alone says which command that is, as a file of somebody else
/// must not start programs. `definitions`: "NAME=COMMAND" each. Throws UserError "--renderer = …".
void define_renderers(const std::vector<std::string>& definitions);
/// The command of a name; null: it is not defined.
const std::string* defined_renderer(const std::string& name);
/// The same. Throws UserError "render.program = NAME: …" for one that is not defined.
const std::string& renderer_command(const std::string& name);
/// Throws UserError for a definition that nobody has asked for since.
void refuse_unused_renderers();

/// Started with `sh -c`, in a process group of its own and with a folder of its own, which is
/// removed with it, also where this process ends before. All errors are std::runtime_error
/// "render.program = NAME: …".
class RendererProcess {
 public:
  RendererProcess(std::string name, const std::string& command);
  /// Closes the program's stdin, waits shortly for its end, and then ends it.
  ~RendererProcess();
  RendererProcess(const RendererProcess&) = delete;
  RendererProcess& operator=(const RendererProcess&) = delete;

  /// Where files are exchanged.
  const std::filesystem::path& folder() const { return folder_; }

  /// Writes a line to the program's stdin and waits for one on its stdout, without its end. Throws
  /// where the program has ended, or does not answer within the time; then it is of no more use.
  std::string ask(const std::string& line, std::chrono::duration<double> within);

 private:
  using Clock = std::chrono::steady_clock;

  [[noreturn]] void fail(const std::string& what) const;
  void start(const std::string& command);
  void send(const std::string& line);
  /// False where the program has closed its stdout.
  bool read_more(Clock::time_point until);
  std::string ending();

  std::string name_;
  std::filesystem::path folder_;
  pid_t process_ = -1;
  FileDescriptor input_;   ///< a socket: writing to a program that has ended is no signal
  FileDescriptor output_;  ///< of the program
  std::string unread_;
};

}  // namespace wobblebench::bench
