// The pipeline of `stream`, whose pictures go to the viewers of a page.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "bench/cache/phantom_cache.h"
#include "bench/live/history.h"
#include "bench/live/live_renderer.h"
#include "bench/live/messages.h"
#include "bench/live/newest.h"
#include "bench/live/panel.h"
#include "bench/live/server/live_server.h"
#include "bench/output/progress.h"
#include "bench/pipeline/acquire.h"

namespace wobblebench::bench {

/// All streams of the command together.
struct LiveAccount {
  hw::BoardAccount sticks;
  std::uint64_t volumes = 0, pictures = 0, superseded = 0;
};

/// Follows the panel: one stream after the other, and pictures of the last volume between them.
/// Used by the thread that owns the context, but for shown() and refresh().
class LivePipeline {
 public:
  /// All must outlive it.
  LivePipeline(BoardArguments board,
               const hw::BoardOptions& options,
               render::GlContext& context,
               PhantomCache& cache,
               Progress& progress,
               LivePanel& panel);
  ~LivePipeline();
  LivePipeline(const LivePipeline&) = delete;
  LivePipeline& operator=(const LivePipeline&) = delete;

  /// The panel's first scene: throws what cannot be rendered or connected.
  void prepare();
  /// Until stop_requested().
  void run(LiveServer& server);

  /// The newest picture; null: none yet.
  SharedPicture shown() const;
  /// Sends the newest picture, and what is made of it, to viewers who have not got it.
  void refresh();
  /// Sends of a kept volume its picture, maps or planes. Throws UserError for another `of`.
  void show_past(std::uint64_t number, const std::string& of);
  const LiveHistory& history() const { return history_; }
  const LiveAccount& account() const { return account_; }

 private:
  using Worker = NewestWorker<SharedPicture>;
  struct PastRequest {
    std::uint64_t number = 0;
    std::string of;
  };
  using PastWorker = NewestWorker<PastRequest>;
  struct Stream;
  void connect(const WantedScene& wanted);
  bool try_to_connect();
  void reconnect();
  void play(const LiveOrders& orders);
  StreamResult run_one(const LiveOrders& orders);
  void show(SharedPicture picture);
  void start_analysis();
  void stop_analysis();
  template <class Stopped>
  void stop(std::unique_ptr<Stopped>& worker);
  void publish(Channel channel, const std::function<LiveMessage()>& make) const;
  void encode(const LivePicture& picture);
  void show_compared(const LivePicture& shown, const render::Picture& start) const;
  LiveMessage past(const PastRequest& request, LiveTruth& truth) const;
  bool is_watched();
  void analyse(const LivePicture& picture, LiveTruth& truth);
  BoardArguments board_arguments(std::uint32_t first_volume) const;
  std::uint32_t next_volume() const;
  void add(const StreamResult& result);

  const BoardArguments arguments_;
  const hw::BoardOptions options_;
  render::GlContext& context_;
  PhantomCache& cache_;
  Progress& progress_;
  LivePanel& panel_;
  LiveServer* server_ = nullptr;
  std::unique_ptr<Stream> stream_;
  LiveAccount account_;
  LiveHistory history_;
  hw::HostTime watched_ = hw::HostClock::now();  ///< a page was open
  bool was_watched_ = true;
  bool has_space_ = false;    ///< the stream's space was sent; used by the analysis alone
  mutable std::mutex mutex_;  ///< of what follows, but for the workers' threads
  SharedPicture shown_;
  std::unique_ptr<Worker> encoder_, analysis_;
  std::unique_ptr<PastWorker> past_;
};

}  // namespace wobblebench::bench
