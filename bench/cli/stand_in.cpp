// A node that behaves like the card's driver, for programs that expect one.
#include <csignal>
#include <iostream>

#include "bench/cli/commands.h"
#include "bench/cli/user_error.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/simulated_sticks.h"
#include "hw/emulator/xdma_emulator.h"

namespace wobblebench::bench {

namespace {

/// Blocks SIGINT and SIGTERM in this thread and those that it starts, and waits for one.
class UntilInterrupted {
 public:
  UntilInterrupted() {
    ::sigemptyset(&signals_);
    ::sigaddset(&signals_, SIGINT);
    ::sigaddset(&signals_, SIGTERM);
    ::pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  void wait() const {
    int signal = 0;
    ::sigwait(&signals_, &signal);
  }

 private:
  sigset_t signals_;
};

}  // namespace

int stand_in_command(const CommandArguments& arguments) {
  const Scene scene = load_scene(arguments.scene, arguments.settings);
  const BoardArguments board = parse_board(arguments.board);
  if (!std::filesystem::is_directory(arguments.folder)) {
    throw UserError("FOLDER = " + arguments.folder.string() + ": must be a folder that is there");
  }
  if (!hw::XdmaEmulator::can_mount()) {
    throw std::runtime_error("stand-in: FUSE cannot be mounted: " +
                             hw::XdmaEmulator::mount_error());
  }
  const MakeSticks sticks = is_simulated(board) ? simulated_sticks(scene) : MakeSticks{};
  // What cannot be opened is said now, not to the first reader.
  open_board_link(board, sticks);
  const UntilInterrupted until;
  const hw::XdmaEmulator card(arguments.folder, [&] { return open_board_link(board, sticks); });
  std::cout << "stand-in    " << card.path().string() << ", until Ctrl-C" << std::endl;
  until.wait();
  return 0;
}

}  // namespace wobblebench::bench
