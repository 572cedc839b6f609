// The state that the live page sets and the pipeline follows.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/command/common_options.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// The scene of the command line's file with these settings, as `live` takes it. Throws UserError.
Scene load_live_scene(const std::filesystem::path& file, const std::vector<std::string>& settings);

/// A scene that pictures are made by; never changed.
struct LiveState {
  std::uint64_t serial = 0;           ///< of the change that led to it
  std::vector<std::string> settings;  ///< over the scene file: of the command line, then the page's
  Scene given;                        ///< as file and settings say
  ResolvedScene scene;
};

/// A scene whose stream is asked for.
struct WantedScene {
  Scene given;
  std::vector<std::string> settings;  ///< as LiveState has them
};

/// What the pipeline is asked to do.
struct LiveOrders {
  std::uint64_t interrupts = 0;  ///< changes that end the stream under way
  bool is_playing = true;
  bool is_step = false;  ///< one volume, then pause
  std::string faults;    ///< as --board takes them
};

/// Shared by the server's thread, which sets, and the pipeline, which follows. Settings of the
/// renderer take effect with the next picture; those of the scan, and mid_volume, with a new
/// stream, which adopt() or revert() answers. Every function may be called from any thread.
class LivePanel {
 public:
  /// `with_scan`: the scan can be set, as that of a simulated probe. Throws as load_scene().
  LivePanel(SceneArguments arguments, bool with_scan, std::string faults);

  /// Puts "section.key=value" over those that are set. Throws UserError with the line that the
  /// command line would print; then nothing has changed. Returns the serial of the change.
  std::uint64_t set(const std::vector<std::string>& settings);
  /// Takes settings of the page back; empty: all of them.
  std::uint64_t reset(const std::vector<std::string>& keys);
  /// Throws UserError, InvalidOption for faults that --board would refuse.
  void set_faults(const std::string& faults);
  void play(bool is_playing);
  void step();
  /// Asks for the last volume's picture by the settings at the start.
  void compare();
  /// How often that was asked for.
  std::uint64_t comparisons() const;
  /// The renderer's settings at the start; nullopt before the first adopt().
  std::optional<render::RenderOptions> start_options() const;

  LiveOrders orders() const;
  std::uint64_t interrupts() const;
  /// Waits until there are other orders, or another state than of this serial, or for this time.
  void wait(const LiveOrders& known, std::uint64_t serial, std::chrono::milliseconds time) const;

  /// The scene of the stream that is wanted; its state is not there yet.
  WantedScene wanted() const;
  bool is_scan_wanted() const;
  /// A stream of it is there.
  void adopt(const WantedScene& wanted, const ResolvedScene& scene);
  /// What these settings want cannot be: those of an earlier state are back, but for what was set
  /// since they were taken.
  void revert(const std::shared_ptr<const LiveState>& to,
              const std::vector<std::string>& refused,
              const std::string& why);
  /// What is done: "preparing" a stream, "playing" it.
  void set_stage(const std::string& stage);
  /// Nothing is played: "paused", unless the stream has "ended".
  void rest();
  /// The stream is "paused" or has "ended"; it is played on if orders have changed meanwhile.
  void end_stage(const LiveOrders& known, const std::string& stage, const std::string& why = "");

  /// Null before the first adopt().
  std::shared_ptr<const LiveState> state() const;
  const SceneArguments& arguments() const { return arguments_; }
  bool with_scan() const { return with_scan_; }
  /// For the page: what is played, "waiting" where no page is open, its scene's values, those at
  /// the start, what was refused last.
  nlohmann::ordered_json status() const;
  /// Waits until the status is not of this version, or for this time. Returns its version.
  std::uint64_t wait_for_status(std::uint64_t version, std::chrono::milliseconds time) const;

 private:
  using Settings = std::vector<std::string>;
  std::uint64_t take(const std::function<void(Settings& page)>& edit, const std::string& why = "");
  std::vector<std::string> all_settings(const std::vector<std::string>& page) const;
  void interrupt();
  void note_change();

  const SceneArguments arguments_;
  const bool with_scan_;
  const SceneSource load_;    ///< the file as it was at the start
  std::mutex changing_;       ///< for one change of settings after the other
  mutable std::mutex mutex_;  ///< of what follows; held shortly, as no scene is made meanwhile
  mutable std::condition_variable changed_;
  LiveOrders orders_;
  std::vector<std::string> page_settings_;
  Scene given_;  ///< by the file and all settings
  std::uint64_t serial_ = 0;
  bool is_scan_wanted_ = true;
  std::shared_ptr<const LiveState> state_;
  std::uint64_t comparisons_ = 0;
  std::string stage_ = "preparing", why_;
  std::uint64_t version_ = 0;   ///< of all that status() tells
  std::optional<Scene> start_;  ///< of the first stream, with what its file left open
};

}  // namespace wobblebench::bench
