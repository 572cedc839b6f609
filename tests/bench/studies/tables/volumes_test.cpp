// From a recording to the volumes of the tables' rows.
#include "bench/studies/tables/volumes.h"

#include <gtest/gtest.h>

#include "bench/pipeline/outside_link.h"
#include "bench/studies/tables/paper.h"
#include "tests/bench/studies/tables/recording.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing::recorded_plan;
using testing::recording_of;
using testing_support::ScratchFolder;

TableVolumes volumes_of(const std::string& board) {
  return recorded_volumes(open_outside_link(parse_outside_board(board)), board);
}

/// What the recording is refused with; the folder's name left out.
std::string refusal(const std::string& bytes) {
  const ScratchFolder folder;
  const std::string path = folder.write("a.wbst", bytes).string();
  const std::string what = refusal_of<UserError>([&] { volumes_of("file=" + path); });
  return what.empty()
             ? what
             : what.substr(0, what.find(path)) + what.substr(what.rfind(path) + path.size());
}

TEST(TableVolumes, OneForEachNumberOfFramesFromTheMiddleOfTheRecorded) {
  const ScratchFolder folder;
  const auto path = folder.write("a.wbst", recording_of(recorded_plan()));
  const TableVolumes volumes = volumes_of("file=" + path.string());
  EXPECT_EQ(volumes.board, "recording");
  EXPECT_TRUE(holds(volumes.note, "middle frames"));
  ASSERT_EQ(volumes.by_frames.size(), frame_counts().size());
  const hw::PolarVolume& whole = volumes.by_frames.at(37);
  for (const int frames : frame_counts()) {
    const hw::PolarVolume& volume = volumes.by_frames.at(frames);
    const int first = (37 - frames) / 2;
    EXPECT_EQ(volume.plan().acquisition().frames_per_volume, frames);
    EXPECT_EQ(volume.missing_sticks(), 0);
    EXPECT_NEAR(volume.plan().phi_step_rad(), whole.plan().phi_step_rad(), 1e-12);
    for (const int frame : {0, frames - 1}) {
      EXPECT_EQ(volume.frame(frame).samples, whole.frame(first + frame).samples);
      EXPECT_NEAR(
          volume.plan().frame_phi_rad(frame), whole.plan().frame_phi_rad(first + frame), 1e-12);
    }
  }
}

TEST(TableVolumes, MissingSticksStayMissing) {
  hw::PolarVolume volume(recorded_plan());
  volume.place(hw::test_stick(recorded_plan(), 5 * 8 + 3));
  EXPECT_EQ(middle_frames(volume, 27).missing_sticks(), 27 * 8 - 1);
  EXPECT_EQ(middle_frames(volume, 27).frame(0).arrived.at(3), 1);
  EXPECT_THROW(middle_frames(volume, 38), std::out_of_range);
}

TEST(TableVolumes, TooFewFramesAreRefused) {
  EXPECT_EQ(refusal(recording_of(recorded_plan(9))),
            "--board = file=: has 9 frames a volume; the tables need 37");
}

TEST(TableVolumes, ACutVolumeIsRefused) {
  const std::string bytes = recording_of(recorded_plan());
  EXPECT_EQ(refusal(bytes.substr(0, bytes.size() / 2))
                .find("--board = file=: the stream is cut short: 1"),
            0u)
      << refusal(bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(refusal(bytes.substr(0, 400)),
            "--board file=: no volume came; the stream is cut short");
}

TEST(TableVolumes, AVolumeBeforeTheCutIsTaken) {
  const std::string bytes = recording_of(recorded_plan(37, 2));
  EXPECT_EQ(refusal(bytes.substr(0, bytes.size() - 1000)), "");
}

TEST(TableVolumes, WhatIsNoRecordingIsRefused) {
  EXPECT_TRUE(holds(refusal(std::string(5000, 'x')), "--board = file="));
  EXPECT_TRUE(holds(refusal(""), "--board = file="));
}

}  // namespace
}  // namespace wobblebench::bench
