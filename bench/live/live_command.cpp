// The stream as a page that a browser shows: pictures as they come, every setting, the truth.
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include "base/duration.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/board_checks/fault_simulation/scenario.h"
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
  std::string listen;              ///< empty: loopback
  std::vector<std::string> names;  ///< of proxies
  int port = 8642;
  int ring = hw::BoardOptions{}.ring_slots;
  std::uint64_t replay = 0;  ///< seed of a rehearsal; 0: none
  bool open = false;
};

constexpr std::chrono::milliseconds kStatusEvery{30};
constexpr std::size_t kMostWarnings = 20;
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
  if (!arguments.listen.empty()) options.address = arguments.listen;
  for (const std::string& name : arguments.names) {
    if (name.empty() || name.find_first_of(":/?# ") != std::string::npos) {
      throw UserError("--name = " + name + ": must be a host's name alone, as bench.example.org");
    }
    options.names.push_back(lower_case(name));
  }
  if (!arguments.listen.empty() || !options.names.empty()) options.token = new_token();
  return options;
}

/// Those of this machine at which a server at 0.0.0.0 or :: can be reached from others, then the
/// loopback's.
std::vector<std::string> addresses_of_machine(bool with_v6) {
  std::vector<std::string> addresses;
  ifaddrs* all = nullptr;
  static_cast<void>(::getifaddrs(&all));
  for (const ifaddrs* at = all; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr || (at->ifa_flags & IFF_LOOPBACK) != 0) continue;
    const bool is_v6 = at->ifa_addr->sa_family == AF_INET6;
    if (is_v6 ? !with_v6 : at->ifa_addr->sa_family != AF_INET) continue;
    std::array<char, NI_MAXHOST> text{};
    const socklen_t size = is_v6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
    if (::getnameinfo(at->ifa_addr, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) !=
        0) {
      continue;
    }
    // A link's own address needs the name of the link on the other machine.
    if (std::string_view(text.data()).find('%') == std::string_view::npos) {
      addresses.emplace_back(text.data());
    }
  }
  ::freeifaddrs(all);
  addresses.emplace_back("127.0.0.1");
  return addresses;
}

/// What opens the page: the server's own addresses, then those behind the names, whose scheme and
/// port the proxy decides.
std::vector<std::string> page_addresses(const ServerOptions& options, int port) {
  const std::string query = options.token.empty() ? "/" : "/?token=" + options.token;
  const bool is_any = options.address == "0.0.0.0" || options.address == "::";
  std::vector<std::string> addresses;
  for (const std::string& host :
       is_any ? addresses_of_machine(options.address == "::") : std::vector{options.address}) {
    const bool is_v6 = host.find(':') != std::string::npos;
    addresses.push_back((is_v6 ? "http://[" : "http://") + host + (is_v6 ? "]:" : ":") +
                        std::to_string(port) + query);
  }
  for (const std::string& name : options.names) addresses.push_back(name + query);
  return addresses;
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

/// The newest that were given, each once.
std::vector<std::string> newest_warnings(Progress& progress) {
  std::vector<std::string> newest;
  const std::vector<std::string> all = progress.warnings();
  for (auto warning = all.rbegin(); warning != all.rend() && newest.size() < kMostWarnings;
       ++warning) {
    if (std::ranges::find(newest, *warning) == newest.end()) newest.push_back(*warning);
  }
  return newest;
}

/// Sends each new status, some 30 times a second at most.
std::jthread send_status(const LivePanel& panel, Progress& progress, LiveServer& server) {
  return std::jthread([&](const std::stop_token& done) {
    std::uint64_t version = 0;
    std::vector<std::string> warnings;
    while (!done.stop_requested()) {
      const std::uint64_t newest = panel.wait_for_status(version, std::chrono::milliseconds(200));
      std::vector<std::string> now = newest_warnings(progress);
      if (newest == version && now == warnings) continue;
      version = newest;
      warnings = std::move(now);
      nlohmann::ordered_json status = panel.status();
      status["warnings"] = warnings;
      server.publish(Channel::status, {std::make_shared<const std::string>(status.dump()), true});
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

std::string text_of(const hw::FaultPlan& plan) {
  std::ostringstream text;
  for (const hw::Fault& fault : plan.faults) {
    text << hw::to_string(fault.kind) << (fault.at ? "@" : ":");
    fault.at ? text << *fault.at : text << fault.rate;
    text << "+";
  }
  text << "seed:" << plan.seed << "+delay_ms:" << to_milliseconds(plan.delay)
       << "+stall_ms:" << to_milliseconds(plan.stall);
  return text.str();
}

/// Those that `rehearse` injects with this seed; its probe, card and schedule are too small for a
/// picture.
std::string faults_of_rehearsal(std::uint64_t seed) {
  const hw::FaultPlan faults = draw_scenario(seed).faults;
  if (!faults.faults.empty()) return text_of(faults);
  throw UserError("--replay = " + std::to_string(seed) +
                  ": this rehearsal has no faults; three of ten have none");
}

/// The faults at the start, which the page may change.
std::string faults_of(const Arguments& arguments, const BoardArguments& board) {
  const auto found = board.link.settings.find("faults");
  const bool has_faults = found != board.link.settings.end();
  if (arguments.replay == 0) return has_faults ? found->second : "";
  if (has_faults) {
    throw UserError("--replay = " + std::to_string(arguments.replay) +
                    ": --board has faults, too; give one of them");
  }
  return faults_of_rehearsal(arguments.replay);
}

int live(const Arguments& arguments) {
  const BoardArguments board = parse_board(arguments.board);
  LivePanel panel(arguments.scene, is_simulated(board), faults_of(arguments, board));
  check_memory_of_run(panel.wanted().given, available_memory_bytes());
  const auto context = render::make_context(arguments.gl);
  Progress progress;
  warn_of_software(*context, arguments.gl, progress);
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  LivePipeline pipeline(board, {.ring_slots = arguments.ring}, *context, cache, progress, panel);
  LiveRequests requests(panel, pipeline, arguments.board, context->renderer_string());
  const ServerOptions options = server_options(arguments);
  const auto server =
      make_live_server(options,
                       {.asset = live_asset,
                        .take = [&](const std::string& text) { return requests.take(text); },
                        .channels_changed = [&] { pipeline.refresh(); }});
  // Until here an interrupt ends the command at once, as there is nothing to keep.
  pipeline.prepare();
  stop_in_order();
  const auto addresses = page_addresses(options, server->port());
  for (const std::string& address : addresses) std::printf("%s\n", address.c_str());
  std::fflush(stdout);
  if (arguments.open) progress.warn(open_address(addresses.front()));
  {
    const std::jthread guard = end_in_time();
    const std::jthread status = send_status(panel, progress, *server);
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
  add_list(command,
           "--name",
           arguments->names,
           "Also through a proxy: the host's name that the browser shows; the page's address then "
           "holds a token (repeatable)");
  add_integer(
      command, "--ring", arguments->ring, "Sticks that the board holds", 1, hw::kMaxRingSlots);
  add_seed(command,
           "--replay",
           arguments->replay,
           "Inject the faults that `rehearse` draws from this seed; 0: none");
  add_flag(command, "--open", arguments->open, "Show the page in the browser");
  return {&command, [arguments] { return live(*arguments); }};
}

}  // namespace wobblebench::bench
