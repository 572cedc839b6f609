// The stream as a page that a browser shows: pictures as they come, every setting, the truth.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/open_in_browser.h"
#include "bench/command/program.h"
#include "bench/command/software_renderer.h"
#include "bench/live/live_assets.h"
#include "bench/live/live_pipeline.h"
#include "bench/live/panel.h"
#include "bench/live/requests.h"
#include "bench/live/server/live_server.h"
#include "bench/scene/scene_cost.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  std::string board = "sim,pace=realtime";
  std::string gl = "auto";
  std::string listen;  ///< empty: loopback
  int port = 8642;
  int ring = hw::BoardOptions{}.ring_slots;
  bool open = false;
};

constexpr std::chrono::milliseconds kStatusEvery{30};
/// After a request to stop, the command ends by itself within this time or is ended.
constexpr std::chrono::milliseconds kStopWithin{800};

/// 128 bits, in hexadecimal digits.
std::string new_token() {
  std::random_device source;
  std::string token;
  for (int i = 0; i < 4; ++i) {
    std::array<char, 9> word{};
    static_cast<void>(std::snprintf(word.data(), word.size(), "%08x", source()));
    token += word.data();
  }
  return token;
}

ServerOptions server_options(const Arguments& arguments) {
  ServerOptions options{.port = arguments.port, .token = {}};
  if (arguments.listen.empty()) return options;
  options.address = arguments.listen;
  options.token = new_token();
  return options;
}

std::string page_address(const ServerOptions& options, int port) {
  const bool is_v6 = options.address.find(':') != std::string::npos;
  std::string address = is_v6 ? "http://[" : "http://";
  address.append(options.address).append(is_v6 ? "]:" : ":").append(std::to_string(port));
  address.append("/");
  if (!options.token.empty()) address.append("?token=").append(options.token);
  return address;
}

/// Ends the program where something that cannot be interrupted, a phantom that is built say, goes
/// on after a request to stop. There is nothing to keep.
std::jthread end_in_time() {
  return std::jthread([](const std::stop_token& done) {
    while (!done.stop_requested() && !stop_requested()) std::this_thread::sleep_for(kStatusEvery);
    const auto end = std::chrono::steady_clock::now() + kStopWithin;
    while (!done.stop_requested()) {
      if (std::chrono::steady_clock::now() > end) std::_Exit(kDone);
      std::this_thread::sleep_for(kStatusEvery);
    }
  });
}

/// Sends each new status, some 30 times a second at most.
std::jthread send_status(const LivePanel& panel, LiveServer& server) {
  return std::jthread([&](const std::stop_token& done) {
    std::uint64_t version = 0;
    while (!done.stop_requested()) {
      const std::uint64_t newest = panel.wait_for_status(version, std::chrono::milliseconds(200));
      if (newest == version) continue;
      version = newest;
      server.publish(Channel::status,
                     {std::make_shared<const std::string>(panel.status().dump()), true});
      std::this_thread::sleep_for(kStatusEvery);
    }
  });
}

void print_account(const LiveAccount& account) {
  std::printf("%llu volumes, %llu pictures, %llu volumes superseded; %llu sticks, %llu lost\n",
              static_cast<unsigned long long>(account.volumes),
              static_cast<unsigned long long>(account.pictures),
              static_cast<unsigned long long>(account.superseded),
              static_cast<unsigned long long>(account.sticks.emitted),
              static_cast<unsigned long long>(account.sticks.lost.total()));
}

/// The faults of --board, which the page may change.
std::string faults_of(const BoardArguments& board) {
  const auto found = board.link.settings.find("faults");
  return found == board.link.settings.end() ? "" : found->second;
}

int live(const Arguments& arguments) {
  const BoardArguments board = parse_board(arguments.board);
  LivePanel panel(arguments.scene, is_simulated(board), faults_of(board));
  check_memory_of_run(panel.wanted().given, available_memory_bytes());
  const auto context = render::make_context(arguments.gl);
  Progress progress;
  warn_of_software(*context, arguments.gl, progress);
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  LivePipeline pipeline(board, {.ring_slots = arguments.ring}, *context, cache, progress, panel);
  LiveRequests requests(panel, pipeline, arguments.board, context->renderer_string());
  const ServerOptions options = server_options(arguments);
  const auto server = make_live_server(
      options,
      {.asset = live_asset, .take = [&](const std::string& text) { return requests.take(text); }});
  // Until here an interrupt ends the command at once, as there is nothing to keep.
  pipeline.prepare();
  stop_in_order();
  const std::string address = page_address(options, server->port());
  std::printf("%s\n", address.c_str());
  std::fflush(stdout);
  if (arguments.open) progress.warn(open_address(address));
  {
    const std::jthread guard = end_in_time();
    const std::jthread status = send_status(panel, *server);
    pipeline.run(*server);
  }
  print_account(pipeline.account());
  return kDone;
}

}  // namespace

Command add_live_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "live", "The stream as a page for a browser: settings, truth and error while it runs");
  add_scene_options(command, arguments->scene);
  add_cache_options(command, arguments->cache);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  add_integer(command, "--port", arguments->port, "Of the page; 0: any that is free", 0, 65535);
  add_text(
      command,
      "--listen",
      arguments->listen,
      "Also other machines: the IP address to serve at; the page's address then holds a token. "
      "Without it this machine alone, at 127.0.0.1");
  add_integer(
      command, "--ring", arguments->ring, "Sticks that the board holds", 1, hw::kMaxRingSlots);
  add_flag(command, "--open", arguments->open, "Show the page in the browser");
  return {&command, [arguments] { return live(*arguments); }};
}

}  // namespace wobblebench::bench
