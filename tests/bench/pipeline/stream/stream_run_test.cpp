// The three threads together, with a renderer that takes as long as a test wants.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "bench/pipeline/stream/stream.h"
#include "hw/link/fault_link.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"

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

void add_frames(StreamRenderer& renderer,
                const hw::AcquisitionPlan& plan,
                std::uint32_t volume,
                int frames) {
  hw::PolarVolume made(plan, volume);
  for (int i = 0; i < plan.sticks_per_volume(); ++i) {
    const auto sequence = plan.first_sequence(volume) + static_cast<std::uint64_t>(i);
    made.place(hw::test_stick(plan, sequence));
  }
  for (int frame = 0; frame < frames; ++frame) renderer.add_frame(frame, made.frame(frame));
}

/// Of a volume's first frames and, where those are not all, the other frames of the one before.
float sum_of(const hw::AcquisitionPlan& plan, std::uint32_t volume, int frames) {
  SummingRenderer expected(plan, milliseconds(0));
  if (volume > 0) add_frames(expected, plan, volume - 1, plan.acquisition().frames_per_volume);
  add_frames(expected, plan, volume, frames);
  return expected.render().depth_m.at(0, 0);
}

/// Sends the next frame of four small volumes when it has been given the one before and none waits,
/// so that there is time for a picture behind each.
class FrameByFrame : public SummingRenderer {
 public:
  FrameByFrame(const hw::AcquisitionPlan& plan, hw::MemoryLink& link)
      : SummingRenderer(plan, milliseconds(0)), plan_(plan), link_(link) {}

  double add_frame(int frame, const hw::PolarFrame& samples) override {
    ++added_;
    return SummingRenderer::add_frame(frame, samples);
  }
  void idle() override {
    if (sent_ > added_ || sent_ == 12) return;
    // A volume begins with its configuration.
    const auto begin_of = [&](std::uint64_t frame) {
      const auto index = hw::packet_index(plan_, 4 * frame) - (frame % 3 == 0);
      return packets_.begin() + static_cast<std::ptrdiff_t>(index);
    };
    link_.append(hw::join({begin_of(sent_), begin_of(sent_ + 1)}));
    ++sent_;
  }

 private:
  const hw::AcquisitionPlan& plan_;
  hw::MemoryLink& link_;
  const std::vector<hw::Bytes> packets_ = hw::packets_of(plan_);
  std::uint64_t sent_ = 0, added_ = 0;
};

StreamSource source_of(hw::Board& board, const hw::AcquisitionPlan& plan) {
  return {
      .board = board, .plan = plan, .name = "test", .configuration = {}, .dynamic_range_db = {}};
}

struct Setting {
  StreamPolicy policy = StreamPolicy::every;
  milliseconds rendering{0}, writing{0};
  std::string faults;
  std::uint64_t volumes = 0;
};

struct Streamed {
  StreamResult result;
  std::vector<std::uint32_t> volumes;  ///< of the pictures, in the sink's order
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
    streamed.volumes.push_back(shown.times.volume);
    if (setting.faults.empty()) {
      EXPECT_EQ(shown.picture.depth_m.at(0, 0), sum_of(plan, shown.times.volume, 3));
    }
  };
  const StreamOptions options{.queue = {.policy = setting.policy}, .volumes = setting.volumes};
  streamed.result =
      run_stream(source_of(board, plan), renderer, options, sink, [] { return false; });
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
  using Lost = hw::BoardAccount::Lost;
  for (const auto& [faults, cause] :
       std::map<std::string, std::uint64_t Lost::*>{{"drop:0.05", &Lost::link},
                                                    {"corrupt:0.05", &Lost::corrupt},
                                                    {"duplicate:0.1", nullptr},
                                                    {"reorder:0.05", &Lost::out_of_order},
                                                    {"truncate:0.05", &Lost::corrupt},
                                                    {"stall:0.01+stall_ms:30", nullptr},
                                                    {"unplug@100", nullptr}}) {
    // Seven volumes of 14 packets, a configuration and one stick.
    const bool is_unplugged = faults == "unplug@100";
    for (const auto policy : {StreamPolicy::every, StreamPolicy::newest}) {
      SCOPED_TRACE(faults);
      const Streamed got = stream(plan, {.policy = policy, .faults = faults});
      EXPECT_EQ(got.result.failure.empty(), !is_unplugged) << got.result.failure;
      const hw::BoardAccount& account = got.result.account;
      EXPECT_EQ(account.emitted, is_unplugged ? 85u : 360u);
      EXPECT_EQ(account.lost.total() > 0, cause != nullptr);
      EXPECT_TRUE(cause == nullptr || account.lost.*cause > 0);
      EXPECT_EQ(account.duplicates > 0, faults == "duplicate:0.1");
      ASSERT_FALSE(got.volumes.empty());
      EXPECT_EQ(got.volumes.back(), is_unplugged ? 7u : 29u);
      EXPECT_TRUE(policy == StreamPolicy::newest || got.volumes.size() == got.volumes.back() + 1);
    }
  }
}

TEST(Stream, MidVolumePicturesComeBetweenWholeOnes) {
  const auto plan = hw::small_plan(4);
  auto link = std::make_unique<hw::MemoryLink>(
      hw::Bytes{}, hw::MemoryLinkOptions{.ending = hw::ReadStatus::timeout});
  FrameByFrame renderer(plan, *link);
  hw::Board board(std::move(link));
  int pictures = 0;
  const PictureSink sink = [&](const ShownPicture& shown) {
    const int frames = 1 + pictures % 3;
    const auto volume = static_cast<std::uint32_t>(pictures++ / 3);
    EXPECT_EQ(shown.times.volume, volume);
    EXPECT_EQ(shown.times.sticks, 4 * frames);
    EXPECT_EQ(shown.times.whole, frames == 3);
    EXPECT_EQ(shown.picture.depth_m.at(0, 0), sum_of(plan, volume, frames));
  };
  const StreamOptions options{
      .queue = {.policy = StreamPolicy::every}, .volumes = 4, .mid_volume = true};
  const StreamResult got =
      run_stream(source_of(board, plan), renderer, options, sink, [] { return false; });
  EXPECT_EQ(pictures, 4 * 3);
  EXPECT_EQ(got.pictures, 4u * 3);
  EXPECT_EQ(got.records.size(), 4u * 3);
  EXPECT_EQ(got.shown.volumes, 4u);
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
        source_of(board, plan),
        renderer,
        {.queue = {.policy = policy}},
        [](const auto&) {},
        stopped);
    EXPECT_TRUE(got.balanced());
    EXPECT_LT(hw::HostClock::now() - start, milliseconds(after_ms) + std::chrono::seconds(1));
  }
}

/// What came before is shown, of the second volume too, and the sticks are accounted for.
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
      source_of(board, plan),
      renderer,
      {.queue = {.policy = StreamPolicy::every}},
      [](const auto&) {},
      [] { return false; });
  EXPECT_TRUE(holds(got.failure, "changes"));
  EXPECT_EQ(got.shown.volumes, 2u);
  EXPECT_EQ(got.shown.sticks, 18u);
  EXPECT_TRUE(got.balanced());
}

TEST(Stream, AFailingSinkEndsItWithItsMessage) {
  const auto plan = hw::small_plan(50);
  for (const auto policy : {StreamPolicy::every, StreamPolicy::newest}) {
    hw::Board board(std::make_unique<hw::MemoryLink>(hw::stream_of(plan)));
    SummingRenderer renderer(plan, milliseconds(1));
    const PictureSink sink = [](const ShownPicture&) { throw std::runtime_error("disk full"); };
    EXPECT_THROW(run_stream(source_of(board, plan),
                            renderer,
                            {.queue = {.policy = policy}},
                            sink,
                            [] { return false; }),
                 std::runtime_error);
  }
}

/// The way of the command `run` and of the studies: a board of its own for each stream.
StreamResult one_volume_of(const std::vector<hw::Bytes>& packets, const hw::AcquisitionPlan& plan) {
  hw::Board board(std::make_unique<hw::MemoryLink>(hw::join(packets)));
  NoRenderer none;
  return stream_one_volume(source_of(board, plan), none);
}

TEST(OneVolume, IsTheFirstWholeOneAndTellsWhetherTheStreamEnded) {
  const auto plan = hw::small_plan(3);
  const auto all = hw::packets_of(plan);
  const StreamResult whole = one_volume_of(all, plan);
  EXPECT_EQ(whole.kept->volume.volume_index(), 0u);
  EXPECT_EQ(whole.kept->volume.missing_sticks(), 0);
  EXPECT_EQ(whole.kept->samples.count,
            static_cast<std::uint64_t>(plan.sticks_per_volume()) *
                static_cast<std::uint64_t>(plan.acquisition().samples_per_stick));
  EXPECT_EQ(whole.reader.ending, "");

  auto packets = all;
  packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(hw::packet_index(plan, 0)));
  EXPECT_EQ(one_volume_of(packets, plan).kept->volume.volume_index(), 1u);
}

TEST(OneVolume, IsTheIncompleteOneWhereTheStreamEndsWithIt) {
  const auto plan = hw::small_plan(1);
  const auto all = hw::packets_of(plan);
  const int sticks = plan.sticks_per_volume();
  auto headless = all;
  headless.erase(headless.begin() + static_cast<std::ptrdiff_t>(hw::packet_index(plan, 0)));
  const StreamResult without_first = one_volume_of(headless, plan);
  EXPECT_EQ(without_first.kept->volume.missing_sticks(), 1);
  EXPECT_EQ(without_first.reader.ending, "the stream is over");
  EXPECT_EQ(without_first.shown.sticks, static_cast<std::uint64_t>(sticks - 1));

  // The configuration and three sticks.
  const StreamResult cut = one_volume_of({all.begin(), all.begin() + 4}, plan);
  EXPECT_EQ(cut.kept->volume.missing_sticks(), sticks - 3);
  EXPECT_EQ(cut.reader.ending, "the stream is cut short");

  EXPECT_EQ(refusal_of<NothingCame>([&] {
              one_volume_of({all.begin(), all.begin() + 1}, plan);
            }),
            "--board test: no volume came; the stream is over");
}

}  // namespace
}  // namespace wobblebench::bench
