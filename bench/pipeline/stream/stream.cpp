#include "bench/pipeline/stream/stream.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/user_error.h"
#include "bench/pipeline/stream/stream_queues.h"

namespace wobblebench::bench {

namespace {

constexpr std::chrono::milliseconds kAskEvery{20};
constexpr std::chrono::milliseconds kIdleEvery{5};

/// Spans that one thread reports.
class Spans {
 public:
  void add(StreamSpan span) {
    if (spans_.size() < kMostSpans) spans_.push_back(span);
  }
  void move_to(std::vector<StreamSpan>& all) {
    all.insert(all.end(), spans_.begin(), spans_.end());
    spans_.clear();
  }

 private:
  std::vector<StreamSpan> spans_;
};

/// The threads of one stream, and what they share.
class Running {
 public:
  Running(const StreamSource& source,
          StreamRenderer& renderer,
          const StreamOptions& options,
          const PictureSink& sink,
          const std::function<bool()>& stopped)
      : board_(source.board),
        plan_(source.plan),
        renderer_(renderer),
        mid_volume_(options.mid_volume),
        tap_(options.frames),
        sink_(sink),
        stopped_(stopped),
        frames_(options.queue),
        pictures_(options.queue.policy),
        reader_(source, frames_, options.volumes, options.keep_volume) {}

  StreamResult run();

 private:
  void read();
  void watch(const std::stop_token& done);
  void render();
  void take_frame(StreamFrame frame);
  void add_acquisition(const StreamFrame& frame);
  void render_picture(const StreamFrame& newest);
  void drop(const PictureTimes& times, hw::HostTime ready);
  void write();
  void end(std::exception_ptr failure);
  void collect();

  hw::Board& board_;
  const hw::AcquisitionPlan& plan_;
  StreamRenderer& renderer_;
  const bool mid_volume_;
  const FrameTap& tap_;
  const PictureSink& sink_;
  const std::function<bool()>& stopped_;
  VolumeQueue frames_;
  PictureQueue pictures_;
  FrameReader reader_;

  StreamResult result_;              ///< of the calling thread until the others have ended
  PictureTimes current_;             ///< the picture under way
  std::uint64_t volume_sticks_ = 0;  ///< of the volume under way
  int volume_frames_ = 0;

  VolumeCount written_;  ///< of the writing thread, as what follows
  double write_ms_ = 0;
  std::deque<PictureTimes> records_;
  Spans render_spans_, write_spans_;

  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any changed_;
  std::exception_ptr failure_;
};

/// The first failure ends all threads.
void Running::end(std::exception_ptr failure) {
  {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
  }
  board_.cancel();
  frames_.stop();
  pictures_.close();
}

void Running::read() {
  try {
    reader_.run();
    board_.cancel();  // more sticks would only be counted
  } catch (const UserError&) {
    end(std::current_exception());
  } catch (const std::bad_alloc&) {
    end(std::current_exception());
  } catch (const std::exception& error) {
    // What came before it is shown.
    result_.failure = error.what();
    frames_.close();
  }
}

void Running::watch(const std::stop_token& done) {
  std::unique_lock lock(mutex_);
  while (!done.stop_requested()) {
    changed_.wait_for(lock, done, kAskEvery, [] { return false; });
    if (!stopped_()) continue;
    lock.unlock();
    end({});
    return;
  }
}

void Running::render() {
  auto asked = hw::HostClock::now();
  for (;;) {
    while (!frames_.wait_for(kIdleEvery)) renderer_.idle();
    auto frame = frames_.pop();
    if (!frame) return;
    const auto popped = hw::HostClock::now();
    current_.waited_ms += to_milliseconds(popped - asked);
    take_frame(std::move(*frame));
    asked = hw::HostClock::now();
    result_.renderer_busy_ms += to_milliseconds(asked - popped);
  }
}

void Running::take_frame(StreamFrame frame) {
  const auto begin = current_.taken = hw::HostClock::now();
  if (volume_frames_ == 0) {
    current_.begun = begin;
    current_.first = frame.first;
    renderer_.begin_volume(frame.volume);
  }
  add_acquisition(frame);
  if (tap_) tap_(frame);
  ++volume_frames_;
  volume_sticks_ += static_cast<std::uint64_t>(frame.sticks);
  current_.pass_1_ms = renderer_.add_frame(frame.frame, frame.samples);
  current_.update_ms += current_.pass_1_ms;
  frame.samples = {};
  const auto uploaded = hw::HostClock::now();
  render_spans_.add({StreamSpan::Kind::frame_uploaded, frame.volume, frame.frame, begin, uploaded});
  if (frame.ends_volume || (mid_volume_ && frames_.empty())) render_picture(frame);
  if (!frame.ends_volume) return;
  volume_sticks_ = 0;
  volume_frames_ = 0;
}

void Running::add_acquisition(const StreamFrame& frame) {
  const auto add = [&](StreamSpan::Kind kind, hw::HostTime begin, hw::HostTime end) {
    render_spans_.add({kind, frame.volume, frame.frame, begin, end});
  };
  if (frame.sticks == 0) return;
  add(StreamSpan::Kind::frame_acquired, frame.first.acquired, frame.last.placed);
  add(StreamSpan::Kind::stick_acquired, frame.first.acquired, frame.first.placed);
  if (frame.sticks == 1) return;
  add(StreamSpan::Kind::stick_acquired, frame.last.acquired, frame.last.placed);
}

void Running::render_picture(const StreamFrame& newest) {
  const int lines = plan_.acquisition().sticks_per_frame;
  current_.volume = newest.volume;
  current_.whole = newest.ends_volume;
  current_.sticks = static_cast<int>(volume_sticks_);
  current_.lost = volume_frames_ * lines - current_.sticks;
  current_.last = newest.last;
  current_.complete = newest.complete;
  current_.uploaded = hw::HostClock::now();
  ShownPicture shown{.times = {}, .picture = renderer_.render()};
  shown.waiting_volumes = frames_.volumes();
  shown.superseded = frames_.statistics().superseded.volumes;
  current_.ready = current_.written = hw::HostClock::now();
  current_.passes = shown.picture.passes;
  render_spans_.add({StreamSpan::Kind::picture_rendered,
                     newest.volume,
                     newest.frame,
                     current_.uploaded,
                     current_.ready});
  ++result_.pictures;
  shown.times = current_;
  current_ = PictureTimes{};
  current_.first = shown.times.first;
  current_.begun = shown.times.begun;
  const hw::HostTime ready = shown.times.ready;
  const auto dropped = pictures_.push(std::move(shown));
  if (dropped && dropped->times.whole) drop(dropped->times, ready);
}

/// The picture that was `ready` just now is dropped at the end alone, an earlier one for it.
void Running::drop(const PictureTimes& times, hw::HostTime ready) {
  const auto sticks = static_cast<std::uint64_t>(times.sticks);
  if (times.ready == ready) {
    result_.left_sticks += sticks;
    return;
  }
  ++result_.superseded_pictures.volumes;
  result_.superseded_pictures.sticks += sticks;
}

void Running::write() {
  try {
    while (auto shown = pictures_.pop()) {
      const auto begin = hw::HostClock::now();
      sink_(*shown);
      shown->times.written = hw::HostClock::now();
      write_ms_ += to_milliseconds(shown->times.written - begin);
      write_spans_.add(
          {StreamSpan::Kind::picture_written, shown->times.volume, 0, begin, shown->times.written});
      if (shown->times.whole) {
        ++written_.volumes;
        written_.sticks += static_cast<std::uint64_t>(shown->times.sticks);
      }
      records_.push_back(std::move(shown->times));
      if (records_.size() > kMostRecords) records_.pop_front();
    }
  } catch (...) {
    end(std::current_exception());
  }
}

void Running::collect() {
  result_.reader = reader_.statistics();
  result_.kept = std::move(reader_.kept());
  result_.queue = frames_.statistics();
  result_.shown = written_;
  result_.sink_busy_ms = write_ms_;
  result_.records = std::move(records_);
  render_spans_.move_to(result_.spans);
  write_spans_.move_to(result_.spans);
}

StreamResult Running::run() {
  result_.begin = hw::HostClock::now();
  board_.start();
  {
    std::jthread watcher([this](const std::stop_token& done) { watch(done); });
    std::jthread reader([this] { read(); });
    std::jthread writer([this] { write(); });
    try {
      render();
    } catch (...) {
      end(std::current_exception());
    }
    pictures_.close();
    board_.cancel();
  }
  result_.end = hw::HostClock::now();
  frames_.stop();  // counts what is left of a volume that did not end
  board_.stop();
  result_.account = board_.account();
  result_.damage = board_.damage();
  result_.link = board_.capabilities();
  if (failure_) std::rethrow_exception(failure_);
  collect();
  if (!result_.balanced()) throw std::logic_error("stream: sticks are not accounted for");
  return std::move(result_);
}

}  // namespace

StreamResult run_stream(const StreamSource& source,
                        StreamRenderer& renderer,
                        const StreamOptions& options,
                        const PictureSink& sink,
                        const std::function<bool()>& stopped) {
  Running running(source, renderer, options, sink, stopped);
  return running.run();
}

StreamResult stream_one_volume(const StreamSource& source,
                               StreamRenderer& renderer,
                               const PictureSink& sink) {
  const auto deadline = hw::HostClock::now() + kVolumeTimeout;
  StreamResult result =
      run_stream(source,
                 renderer,
                 {.queue = {.policy = StreamPolicy::every}, .volumes = 1, .keep_volume = true},
                 sink,
                 [&] { return hw::HostClock::now() > deadline; });
  if (!result.kept) throw nothing_came(source.name, "volume", result.reader.ending);
  return result;
}

}  // namespace wobblebench::bench
