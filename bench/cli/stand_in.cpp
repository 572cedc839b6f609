// Emulates the card's driver: a device node for programs that expect one.
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/progress.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/pipeline/stick_sources.h"
#include "hw/emulator/xdma_emulator.h"

namespace wobblebench::bench {

namespace {

struct StandInArguments {
  std::filesystem::path folder;  ///< where the node is mounted
  SceneArguments scene;
  CacheArguments cache;
  std::string board = "sim";
};

/// Blocks SIGINT and SIGTERM in this thread and those that it starts, and waits for one.
class InterruptSignals {
 public:
  InterruptSignals() {
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

int emulate_card(const StandInArguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  const BoardArguments board = parse_board(arguments.board);
  if (!std::filesystem::is_directory(arguments.folder)) {
    throw UserError("FOLDER = " + arguments.folder.string() + ": must be a folder that is there");
  }
  if (!hw::XdmaEmulator::can_mount()) {
    throw std::runtime_error("stand-in: FUSE cannot be mounted: " +
                             hw::XdmaEmulator::mount_error());
  }
  const MakeSticks sticks = is_simulated(board)
                                ? simulated_sticks(simulated_scan(
                                      scene, open_phantom_cache(arguments.cache.most_megabytes())))
                                : MakeSticks{};
  Progress progress;
  // Opened once and closed, so that a link that cannot be opened fails here and not at the first
  // read.
  progress.step("open", [&] { open_board_link(board, sticks); });
  warn_of_scan(scene, is_simulated(board), progress);
  const InterruptSignals signals;
  const hw::XdmaEmulator card(arguments.folder, [&] { return open_board_link(board, sticks); });
  std::cout << "stand-in    " << card.path().string() << ", until Ctrl-C" << std::endl;
  signals.wait();
  return 0;
}

}  // namespace

Command add_stand_in_command(CLI::App& app) {
  const auto arguments = std::make_shared<StandInArguments>();
  CLI::App& command = add_subcommand(
      app, "stand-in", "A node that behaves like the card's driver, until Ctrl-C (needs FUSE)");
  add_required_path(command, "FOLDER", arguments->folder, "Where xdma0_c2h_0 appears");
  add_path(command, "SCENE", arguments->scene.file, "TOML file, for --board sim");
  add_list(command, "--set", arguments->scene.settings, "Override one option: section.key=value");
  add_cache_options(command, arguments->cache);
  add_board_option(command, arguments->board);
  return {&command, [arguments] { return emulate_card(*arguments); }};
}

}  // namespace wobblebench::bench
