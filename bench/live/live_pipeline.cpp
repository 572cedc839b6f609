#include "bench/live/live_pipeline.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <thread>
#include <utility>

#include "base/user_error.h"
#include "bench/command/program.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/live/space_message.h"
#include "bench/results/counts.h"

namespace wobblebench::bench {

namespace {

constexpr std::chrono::milliseconds kPausedWait{50};
/// Longer than a page takes to be loaded again.
constexpr std::chrono::seconds kUnwatched{10};

}  // namespace

/// A scan under way: its board, and the renderer of its plan.
struct LivePipeline::Stream {
  std::unique_ptr<BoardConnection> board;
  ResolvedScene scene;
  sim::TissueMapSource maps;
  std::optional<StreamSource> source;  ///< not run yet; none: to be connected again
  std::unique_ptr<LiveRenderer> renderer;
  std::string faults;
};

LivePipeline::LivePipeline(BoardArguments board,
                           const hw::BoardOptions& options,
                           render::GlContext& context,
                           PhantomCache& cache,
                           Progress& progress,
                           LivePanel& panel)
    : arguments_(std::move(board)),
      options_(options),
      context_(context),
      cache_(cache),
      progress_(progress),
      panel_(panel) {}

LivePipeline::~LivePipeline() = default;

BoardArguments LivePipeline::board_arguments(std::uint32_t first_volume) const {
  BoardArguments arguments = arguments_;
  const std::string faults = panel_.orders().faults;
  arguments.faults = faults.empty() ? hw::FaultPlan{} : hw::parse_faults(faults);
  if (is_simulated(arguments) && first_volume > 0) {
    arguments.link.settings["first_volume"] = std::to_string(first_volume);
  }
  return arguments;
}

void LivePipeline::prepare() {
  connect(panel_.wanted());
}

void LivePipeline::connect(const WantedScene& wanted) {
  const std::string faults = panel_.orders().faults;
  auto board = std::make_unique<BoardConnection>(board_arguments(0), options_);
  ResolvedScene scene = board->resolve(wanted.given, cache_, progress_);
  auto maps = kept_maps(cache_.tissue_maps());
  const StreamSource source =
      progress_.step("scene", [&] { return board->connect(scene, maps, cache_.echoes(scene)); });
  panel_.adopt(wanted, scene);
  auto renderer = progress_.step("shaders", [&] {
    return std::make_unique<LiveRenderer>(
        context_,
        panel_,
        [this](SharedPicture picture) { show(std::move(picture)); },
        [this](const LivePicture& shown, const render::Picture& start) {
          show_compared(shown, start);
        });
  });
  stream_ = std::make_unique<Stream>(Stream{.board = std::move(board),
                                            .scene = std::move(scene),
                                            .maps = std::move(maps),
                                            .source = source,
                                            .renderer = std::move(renderer),
                                            .faults = faults});
  // Of another scan.
  const std::lock_guard lock(mutex_);
  shown_.reset();
  history_.clear();
}

/// False: the scene that is wanted was refused, and the last one stays.
bool LivePipeline::try_to_connect() {
  const auto before = panel_.state();
  panel_.set_stage("preparing");
  stop_analysis();  // it uses the maps of the last phantom
  const WantedScene wanted = panel_.wanted();
  try {
    connect(wanted);
  } catch (const render::ContextLost&) {
    throw;
  } catch (const std::exception&) {
    panel_.revert(before, wanted.settings, refusal_of(std::current_exception()).line);
    cache_.phantom(before->given.phantom);
    start_analysis();
    return false;
  }
  start_analysis();
  return true;
}

/// The same scan from its next volume on; what is not simulated begins anew.
void LivePipeline::reconnect() {
  stop_analysis();
  Stream& stream = *stream_;
  stream.source.reset();
  stream.board.reset();  // a card is opened by one
  stream.faults = panel_.orders().faults;
  stream.board = std::make_unique<BoardConnection>(board_arguments(next_volume()), options_);
  if (!is_simulated(arguments_)) {
    stream.scene = stream.board->resolve(panel_.state()->given, cache_, progress_);
  }
  stream.source.emplace(stream.board->connect(stream.scene, stream.maps));
  start_analysis();
}

std::uint32_t LivePipeline::next_volume() const {
  const auto last = stream_->renderer->last_volume();
  if (!last) return 0;
  return (*last + 1) % static_cast<std::uint32_t>(hw::kMostVolumes);
}

void LivePipeline::run(LiveServer& server) {
  server_ = &server;
  // However this ends: the server, which they publish to, may be gone soon after.
  const std::shared_ptr<void> at_end(nullptr, [this](void*) {
    stop_analysis();
    stop(encoder_);
  });
  encoder_ = std::make_unique<Worker>([this](const SharedPicture& picture) { encode(*picture); });
  start_analysis();
  while (!stop_requested()) {
    // Taken first, so that a scan that is asked for while this one is prepared ends its stream.
    const LiveOrders orders = panel_.orders();
    if (panel_.is_scan_wanted() && !try_to_connect()) continue;
    if (!is_watched()) {
      panel_.set_stage("waiting");
      std::this_thread::sleep_for(kPausedWait);
    } else if (orders.is_playing) {
      play(orders);
    } else {
      panel_.rest();
      const std::uint64_t serial = panel_.state()->serial;
      stream_->renderer->idle();
      panel_.wait(orders, serial, kPausedWait);
    }
  }
}

void LivePipeline::play(const LiveOrders& orders) {
  try {
    if (!stream_->source || stream_->faults != orders.faults) reconnect();
    stream_->renderer->begin_stream();
    panel_.set_stage("playing");
    const StreamResult result = run_one(orders);
    add(result);
    if (!result.failure.empty()) return panel_.end_stage(orders, "ended", result.failure);
    progress_.warn(stream_->board->left_out());
    if (panel_.interrupts() != orders.interrupts || stop_requested() || !is_watched()) return;
    panel_.end_stage(orders, orders.is_step ? "paused" : "ended");
  } catch (const render::ContextLost&) {
    throw;
  } catch (const std::exception&) {
    panel_.end_stage(orders, "ended", refusal_of(std::current_exception()).line);
    if (!analysis_) start_analysis();  // reconnecting failed: the last volume is still shown
  }
}

StreamResult LivePipeline::run_one(const LiveOrders& orders) {
  const StreamSource source = *std::exchange(stream_->source, std::nullopt);
  const double sound_ms = source.knows_times()
                              ? to_milliseconds(stream_->scene.plan().volume_duration())
                              : std::nan("");
  const PictureSink sink = [&](const ShownPicture& shown) {
    const std::uint64_t pictures = ++account_.pictures;
    server_->publish(
        Channel::times,
        times_message(shown, pictures, source.board.account(), source.board.damage(), sound_ms));
  };
  const StreamOptions options{.queue = {},
                              .volumes = orders.is_step ? std::uint64_t{1} : std::uint64_t{0},
                              .mid_volume = panel_.state()->scene.render().pipeline.mid_volume,
                              .frames = [this](const StreamFrame& frame) {
                                publish(Channel::firing, [&] { return firing_message(frame); });
                              }};
  return run_stream(source, *stream_->renderer, options, sink, [&] {
    return stop_requested() || panel_.interrupts() != orders.interrupts || !is_watched();
  });
}

/// A page is open, or was a moment ago. Without one the stream waits.
bool LivePipeline::is_watched() {
  const hw::HostTime now = hw::HostClock::now();
  if (server_->viewers() > 0) watched_ = now;
  const bool is_watched = now - watched_ < kUnwatched;
  if (!is_watched && std::exchange(was_watched_, false)) {
    std::printf("no page is open: the stream waits for one\n");
    std::fflush(stdout);
  }
  was_watched_ = is_watched;
  return is_watched;
}

void LivePipeline::add(const StreamResult& result) {
  add_account(result.reader.account, account_.sticks);
  account_.volumes += result.reader.volumes;
  account_.superseded += result.queue.superseded.volumes + result.superseded_pictures.volumes;
}

void LivePipeline::show(SharedPicture picture) {
  const std::lock_guard lock(mutex_);
  if (picture->is_coarse) {
    if (encoder_) encoder_->give(std::move(picture));
    return;
  }
  shown_ = picture;
  if (encoder_) encoder_->give(picture);
  if (analysis_) analysis_->give(std::move(picture));
}

SharedPicture LivePipeline::shown() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

void LivePipeline::refresh() {
  if (auto picture = shown()) show(std::move(picture));
}

void LivePipeline::start_analysis() {
  const auto truth = std::make_shared<LiveTruth>(stream_->maps);
  auto worker = std::make_unique<Worker>(
      [this, truth](const SharedPicture& picture) { analyse(*picture, *truth); });
  has_space_ = false;
  const auto past_truth = std::make_shared<LiveTruth>(stream_->maps);
  auto past_worker = std::make_unique<PastWorker>([this, past_truth](const PastRequest& request) {
    publish(Channel::past, [&] { return past(request, *past_truth); });
  });
  const std::lock_guard lock(mutex_);
  analysis_ = std::move(worker);
  past_ = std::move(past_worker);
}

void LivePipeline::stop_analysis() {
  stop(analysis_);
  stop(past_);
}

template <class Stopped>
void LivePipeline::stop(std::unique_ptr<Stopped>& worker) {
  std::unique_ptr<Stopped> stopped;
  const std::lock_guard lock(mutex_);
  stopped.swap(worker);
}

void LivePipeline::publish(Channel channel, const std::function<LiveMessage()>& make) const {
  if (!server_->is_wanted(channel)) return;
  try {
    server_->publish(channel, make());
  } catch (const std::exception& error) {
    progress_.warn(error.what());
  }
}

void LivePipeline::encode(const LivePicture& picture) {
  publish(Channel::picture, [&] {
    LiveMessage message = picture_message(picture);
    const std::lock_guard lock(mutex_);
    if (shown_.get() == &picture) history_.add(picture, message);
    return message;
  });
}

void LivePipeline::show_compared(const LivePicture& shown, const render::Picture& start) const {
  publish(Channel::compared, [&] { return compared_message(shown, start); });
}

void LivePipeline::show_past(std::uint64_t number, const std::string& of) {
  if (of != "picture" && of != "maps" && of != "planes") {
    throw UserError("of = " + of + ": must be picture, maps or planes");
  }
  const std::lock_guard lock(mutex_);
  if (past_) past_->give({number, of});
}

LiveMessage LivePipeline::past(const PastRequest& request, LiveTruth& truth) const {
  const auto kept = history_.find(request.number);
  LiveMessage message;
  if (kept && request.of == "picture") message = kept->message;
  if (kept && request.of == "maps") message = maps_message(kept->unpacked(), truth);
  if (kept && request.of == "planes" && kept->frames) message = planes_message(kept->unpacked());
  return past_message(request.number, request.of, message);
}

void LivePipeline::analyse(const LivePicture& picture, LiveTruth& truth) {
  if (picture.frames) publish(Channel::planes, [&] { return planes_message(picture); });
  publish(Channel::maps, [&] { return maps_message(picture, truth); });
  if (has_space_ || !server_->is_wanted(Channel::space)) return;
  has_space_ = true;
  publish(Channel::space, [&] { return space_message(picture.state->scene); });
}

}  // namespace wobblebench::bench
