// The three threads together, with a renderer that takes as long as a test wants.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "bench/pipeline/stream/stream.h"
#include "hw/link/fault_link.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::bench {
namespace {

using std::chrono::milliseconds;

/// A picture's depth is the sum of the samples of the volume that it shows.
class SummingRenderer : public StreamRenderer {
 public:
  SummingRenderer(const hw::AcquisitionPlan& plan, milliseconds takes)
      : takes_(takes), sums_(static_cast<std::size_t>(plan.acquisition().frames_per_volume)) {}

  double add_frame(int frame, const hw::PolarFrame& samples) override {
    float& sum = sums_.at(static_cast<std::size_t>(frame)) = 0;
    for (const float sample : samples.samples) sum += sample;
    return 0;
  }
  render::Picture render() override {
    std::this_thread::sleep_for(takes_);
    render::Picture picture;
    picture.depth_m = Image<float>(1, 1, 0);
    for (const float sum : sums_) picture.depth_m.at(0, 0) += sum;
    return picture;
  }

 private:
  milliseconds takes_;
  std::vector<float> sums_;
};

float sum_of(const hw::AcquisitionPlan& plan, std::uint32_t volume) {
  SummingRenderer expected(plan, milliseconds(0));
  hw::PolarVolume made(plan, volume);
  for (int i = 0; i < plan.sticks_per_volume(); ++i) {
    const auto sequence = plan.first_sequence(volume) + static_cast<std::uint64_t>(i);
    made.place(hw::test_stick(plan, sequence));
  }
  for (int frame = 0; frame < plan.acquisition().frames_per_volume; ++frame) {
    expected.add_frame(frame, made.frame(frame));
  }
  return expected.render().depth_m.at(0, 0);
}

struct Setting {
  StreamPolicy policy = StreamPolicy::every;
  milliseconds rendering{0}, writing{0};
  std::string faults;
  bool mid_volume = false;
  std::uint64_t volumes = 0;
};

struct Streamed {
  StreamResult result;
  std::vector<std::uint32_t> volumes;  ///< of whole pictures, in the sink's order
};

Streamed stream(const hw::AcquisitionPlan& plan, const Setting& setting) {
  std::unique_ptr<hw::Link> link = std::make_unique<hw::MemoryLink>(hw::stream_of(plan));
  if (!setting.faults.empty()) {
    link = std::make_unique<hw::FaultLink>(std::move(link), hw::parse_faults(setting.faults));
  }
  hw::Board board(std::move(link));
  SummingRenderer renderer(plan, setting.rendering);
  Streamed streamed;
  const PictureSink sink = [&](const ShownPicture& shown) {
    std::this_thread::sleep_for(setting.writing);
    if (!shown.times.whole) return;
    streamed.volumes.push_back(shown.times.volume);
    if (setting.faults.empty()) {
      EXPECT_EQ(shown.picture.depth_m.at(0, 0), sum_of(plan, shown.times.volume));
    }
  };
  const StreamOptions options{.queue = {.policy = setting.policy},
                              .volumes = setting.volumes,
                              .mid_volume = setting.mid_volume};
  streamed.result = run_stream(board, plan, renderer, options, "test", sink, [] { return false; });
  EXPECT_TRUE(streamed.result.balanced());
  EXPECT_TRUE(streamed.result.account.balanced());
  return streamed;
}

TEST(Stream, EveryShowsEachVolumeHoweverSlowTheRendererOrTheSink) {
  const auto plan = hw::small_plan(12);
  for (const Setting& setting :
       {Setting{}, Setting{.rendering = milliseconds(10)}, Setting{.writing = milliseconds(10)}}) {
    const Streamed got = stream(plan, setting);
    ASSERT_EQ(got.volumes.size(), 12u);
    for (std::uint32_t volume = 0; volume < 12; ++volume) EXPECT_EQ(got.volumes[volume], volume);
    EXPECT_EQ(got.result.shown.sticks, got.result.account.delivered);
    EXPECT_LE(got.result.queue.most_volumes, 2);
  }
}

TEST(Stream, NewestDropsWhatIsOvertakenAndEndsWithTheLast) {
  const auto plan = hw::small_plan(40, hw::MotorMode::alternating);
  for (const Setting& setting :
       {Setting{.policy = StreamPolicy::newest, .rendering = milliseconds(20)},
        Setting{.policy = StreamPolicy::newest, .writing = milliseconds(20)}}) {
    const Streamed got = stream(plan, setting);
    EXPECT_LT(got.volumes.size(), 40u);
    EXPECT_EQ(got.volumes.back(), 39u);
    EXPECT_TRUE(std::ranges::is_sorted(got.volumes));
    EXPECT_EQ(got.result.shown.volumes + got.result.queue.superseded.volumes +
                  got.result.superseded_pictures.volumes,
              40u);
  }
}

TEST(Stream, FaultsAreCountedAndBlockNothing) {
  const auto plan = hw::small_plan(30);
  for (const std::string faults : {"drop:0.05",
                                   "corrupt:0.05",
                                   "duplicate:0.1",
                                   "reorder:0.05",
                                   "truncate:0.05",
                                   "stall:0.01+stall_ms:30",
                                   "unplug@100"}) {
    for (const auto policy : {StreamPolicy::every, StreamPolicy::newest}) {
      SCOPED_TRACE(faults);
      const Streamed got = stream(plan, {.policy = policy, .faults = faults});
      EXPECT_EQ(got.result.failure.empty(), faults != "unplug@100") << got.result.failure;
    }
  }
}

TEST(Stream, MidVolumePicturesComeBetweenWholeOnes) {
  const auto plan = hw::small_plan(10);
  const Streamed got = stream(plan, {.mid_volume = true});
  EXPECT_EQ(got.volumes.size(), 10u);
  EXPECT_GE(got.result.pictures, 10u);
  EXPECT_EQ(got.result.records.size(), got.result.pictures);
}

TEST(Stream, EndsAfterAsManyVolumesAsAskedFor) {
  const Streamed got = stream(hw::small_plan(10), {.volumes = 4});
  EXPECT_EQ(got.volumes, (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

TEST(Stream, StopsWithinASecondAtAnyMoment) {
  const auto plan = hw::small_plan(50);
  for (int after_ms = 0; after_ms < 60; after_ms += 3) {
    // An idle link: without the stop the stream would wait for ever.
    hw::Board board(std::make_unique<hw::MemoryLink>(
        hw::stream_of(plan), hw::MemoryLinkOptions{.ending = hw::ReadStatus::timeout}));
    SummingRenderer renderer(plan, milliseconds(5));
    const auto start = hw::HostClock::now();
    const auto stopped = [&] { return hw::HostClock::now() - start > milliseconds(after_ms); };
    const auto policy = after_ms % 2 == 0 ? StreamPolicy::every : StreamPolicy::newest;
    const StreamResult got = run_stream(
        board, plan, renderer, {.queue = {.policy = policy}}, "test", [](const auto&) {}, stopped);
    EXPECT_TRUE(got.balanced());
    EXPECT_LT(hw::HostClock::now() - start, milliseconds(after_ms) + std::chrono::seconds(1));
  }
}

/// What came before is shown, and the sticks are accounted for.
TEST(Stream, AnAcquisitionThatChangesInAVolumeEndsIt) {
  const auto plan = hw::small_plan(2);
  auto packets = hw::packets_of(plan);
  hw::AcquisitionOptions deeper = plan.acquisition();
  deeper.depth_m *= 2;
  const auto change = hw::packets_of({plan.probe(), deeper}).front();
  packets.insert(packets.begin() + static_cast<std::ptrdiff_t>(hw::packet_index(plan, 18)), change);
  hw::Board board(std::make_unique<hw::MemoryLink>(hw::join(packets)));
  SummingRenderer renderer(plan, milliseconds(0));
  const StreamResult got = run_stream(
      board,
      plan,
      renderer,
      {.queue = {.policy = StreamPolicy::every}},
      "test",
      [](const auto&) {},
      [] { return false; });
  EXPECT_NE(got.failure.find("changes"), std::string::npos) << got.failure;
  EXPECT_EQ(got.shown.volumes, 1u);
  EXPECT_TRUE(got.balanced());
}

TEST(Stream, AFailingSinkEndsItWithItsMessage) {
  const auto plan = hw::small_plan(50);
  for (const auto policy : {StreamPolicy::every, StreamPolicy::newest}) {
    hw::Board board(std::make_unique<hw::MemoryLink>(hw::stream_of(plan)));
    SummingRenderer renderer(plan, milliseconds(1));
    const PictureSink sink = [](const ShownPicture&) { throw std::runtime_error("disk full"); };
    EXPECT_THROW(run_stream(board,
                            plan,
                            renderer,
                            {.queue = {.policy = policy}},
                            "test",
                            sink,
                            [] { return false; }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace wobblebench::bench
