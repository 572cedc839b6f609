#include "bench/studies/board_speed/board_speed.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <semaphore>
#include <stdexcept>
#include <stop_token>
#include <thread>

#include "base/duration.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/stick_sources.h"
#include "hw/board/board.h"
#include "hw/recording/file_link.h"
#include "hw/recording/recorder.h"
#include "hw/wire/crc32c.h"
#include "hw/wire/decoder.h"

namespace wobblebench::bench {

namespace {

using Clock = std::chrono::steady_clock;

hw::AcquisitionPlan paper_plan(int volumes) {
  hw::AcquisitionOptions acquisition;
  acquisition.volumes = volumes;
  return {{}, acquisition};
}

/// A recording of noise; the destructor removes its file.
class TemporaryRecording {
 public:
  explicit TemporaryRecording(int volumes)
      : path_(std::filesystem::temp_directory_path() /
              ("wobblebench-" + std::to_string(::getpid()) + ".wbst")) {
    sim::SimLink link(synthetic_sticks(paper_plan(volumes), 1));
    RecordingSink sink(path_);
    hw::Recorder recorder(link, [&](auto bytes) { sink.write(bytes); });
    static_cast<void>(recorder.run([] { return false; }));
    sink.finish(sink.bytes());
  }
  ~TemporaryRecording() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryRecording(const TemporaryRecording&) = delete;
  TemporaryRecording& operator=(const TemporaryRecording&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Restricts this thread, and those that it starts, to one processor while it lives.
class OneCore {
 public:
  OneCore() {
    ::sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      if (!CPU_ISSET(cpu, &before_)) continue;
      CPU_SET(cpu, &one);
      break;
    }
    ::sched_setaffinity(0, sizeof one, &one);
  }
  ~OneCore() { ::sched_setaffinity(0, sizeof before_, &before_); }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;

 private:
  cpu_set_t before_;
};

constexpr std::size_t kPiece = 65536;

/// Calls body(bytes) for each piece of the file.
void for_each_piece(const std::filesystem::path& path,
                    const std::function<void(std::span<const std::byte>)>& body) {
  hw::FileLink link(path);
  std::vector<std::byte> piece(kPiece);
  for (;;) {
    const hw::ReadResult result = link.read(piece, hw::HostTime::max());
    if (result.status != hw::ReadStatus::ok) return;
    body(std::span(piece).first(result.bytes));
  }
}

void read_alone(const std::filesystem::path& path) {
  for_each_piece(path, [](auto) {});
}

void read_and_check(const std::filesystem::path& path) {
  std::uint32_t crc = 0;
  for_each_piece(path, [&](auto bytes) { crc = hw::crc32c(bytes, crc); });
  if (crc == 1) throw std::logic_error("unlikely");
}

void read_and_decode(const std::filesystem::path& path) {
  hw::Decoder decoder;
  for_each_piece(path, [&](auto bytes) {
    decoder.feed(bytes);
    while (decoder.next()) {
    }
  });
}

void through_the_board(const std::filesystem::path& path) {
  hw::Board board(std::make_unique<hw::FileLink>(path));
  board.start();
  for (;;) {
    const hw::Event event = board.next(hw::HostTime::max());
    if (std::holds_alternative<hw::EndOfStream>(event)) break;
    if (std::holds_alternative<hw::DeviceLost>(event)) throw std::runtime_error("device lost");
  }
  if (board.account().lost.total() > 0) throw std::logic_error("a file loses sticks");
}

}  // namespace

Throughput measure_throughput(int volumes, int repeats, const PartDone& done) {
  const TemporaryRecording recording(volumes);
  const OneCore one_core;
  Throughput throughput{.bytes = std::filesystem::file_size(recording.path()),
                        .sticks = static_cast<std::uint64_t>(volumes) *
                                  static_cast<std::uint64_t>(paper_plan(1).sticks_per_volume()),
                        .repeats = repeats};
  throughput.stream_mb_s =
      static_cast<double>(throughput.bytes) / 1e6 /
      (static_cast<double>(throughput.sticks) * paper_plan(1).stick_period_s());
  struct Stage {
    const char* name;
    void (*run)(const std::filesystem::path&);
    std::vector<double> mb_s = {};
  };
  std::vector<Stage> stages = {{"read the file", read_alone},
                               {"… and compute its CRC", read_and_check},
                               {"… and decode every packet", read_and_decode},
                               {"file, decoder, ring, program", through_the_board}};
  PartCount parts(stages.size() * (static_cast<std::size_t>(repeats) + 1), done);
  for (int repeat = -1; repeat < repeats; ++repeat) {
    for (Stage& stage : stages) {
      const auto start = Clock::now();
      stage.run(recording.path());
      const double mb_s =
          static_cast<double>(throughput.bytes) / 1e3 / to_milliseconds(Clock::now() - start);
      if (repeat >= 0) stage.mb_s.push_back(mb_s);
      parts.finish_one();
    }
  }
  for (Stage& stage : stages) throughput.stages.push_back({stage.name, spread_of(stage.mb_s)});
  return throughput;
}

CancelTimes measure_cancels(int cancels, int load_threads, const PartDone& done) {
  std::vector<std::jthread> load;
  for (int i = 0; i < load_threads; ++i) {
    load.emplace_back([](const std::stop_token& stop) {
      for (std::uint64_t count = 0; !stop.stop_requested(); ++count) {
      }
    });
  }
  hw::Board board(std::make_unique<sim::SimLink>(synthetic_sticks(paper_plan(1000), 1),
                                                 sim::SimLinkOptions{.pace = hw::Pace::realtime}),
                  {.ring_slots = 64});
  std::counting_semaphore<2> go(0), woken(0);
  Clock::time_point woken_at;
  std::jthread waiter([&] {
    for (int i = 0; i < cancels; ++i) {
      go.acquire();
      while (!std::holds_alternative<hw::Cancelled>(board.next(hw::HostTime::max()))) {
      }
      woken_at = Clock::now();
      woken.release();
    }
  });
  std::vector<double> ms;
  PartCount parts(static_cast<std::size_t>(cancels), done);
  for (int i = 0; i < cancels; ++i) {
    board.start();
    go.release();
    // Up to a third of a millisecond, so that cancel() is called at every phase of the wait.
    std::this_thread::sleep_for(std::chrono::microseconds(i * 37 % 333));
    const auto cancelled_at = Clock::now();
    board.cancel();
    woken.acquire();
    ms.push_back(to_milliseconds(woken_at - cancelled_at));
    board.stop();
    parts.finish_one();
  }
  waiter.join();
  return {cancels,
          load_threads,
          quantile(ms, 0.5),
          quantile(ms, 0.99),
          quantile(ms, 0.999),
          *std::max_element(ms.begin(), ms.end())};
}

}  // namespace wobblebench::bench
