// The simulator's bytes: what arrives is what the plan says, and the same for a seed on any run.
#include "sim/sim_link.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hw/volume_assembly.h"
#include "hw/wire.h"

namespace wobblebench::sim {
namespace {

hw::AcquisitionPlan small_plan(int volumes = 1, hw::MotorMode motor = hw::MotorMode::stepped) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 16;
  acquisition.frames_per_volume = 9;
  acquisition.samples_per_stick = 128;
  acquisition.volumes = volumes;
  acquisition.motor = motor;
  return {{}, acquisition};
}

std::vector<std::byte> all_bytes(const hw::AcquisitionPlan& plan,
                                 const SimulationOptions& options) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  SimLink link({phantom, {glm::dmat3(1.0), phantom.suggested_position_m()}, plan, options});
  std::vector<std::byte> bytes, chunk(777);
  for (;;) {
    const auto result = link.read(chunk, hw::HostTime::max());
    if (result.status != hw::ReadStatus::ok) return bytes;
    bytes.insert(
        bytes.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(result.bytes));
  }
}

TEST(SimLink, BytesDoNotDependOnThreadsOrRuns) {
  for (const Rung rung : {Rung::geometry, Rung::field}) {
    SimulationOptions options;
    options.fidelity = rung;
    options.threads = 1;
    const auto one = all_bytes(small_plan(), options);
    EXPECT_EQ(one, all_bytes(small_plan(), options)) << "a second run differs";
    options.threads = 2;
    EXPECT_EQ(one, all_bytes(small_plan(), options)) << "two threads differ from one";
    options.threads = 4;
    EXPECT_EQ(one, all_bytes(small_plan(), options)) << "four threads differ from one";
  }
}

TEST(SimLink, AnotherSeedIsAnotherSpeckle) {
  SimulationOptions a, b;
  b.seed = a.seed + 1;
  EXPECT_NE(all_bytes(small_plan(), a), all_bytes(small_plan(), b));
}

TEST(SimLink, EveryStickCarriesItsOwnTimeAndAngle) {
  const auto plan = small_plan(2, hw::MotorMode::continuous);
  hw::Decoder decoder;
  decoder.feed(all_bytes(plan, {}));
  std::uint64_t sticks = 0, configurations = 0, ends = 0;
  while (const auto packet = decoder.next()) {
    configurations += std::holds_alternative<hw::ConfigurationPacket>(*packet);
    ends += std::holds_alternative<hw::VolumeEndPacket>(*packet);
    const auto* found = std::get_if<hw::StickPacket>(&*packet);
    if (!found) continue;
    const hw::Stick& stick = found->stick;
    ASSERT_EQ(stick.sequence, sticks);
    EXPECT_EQ(stick.time, plan.stick_time(sticks));
    EXPECT_EQ(stick.motor_angle_rad, plan.motor_angle_rad(stick.index));
    for (float sample : stick.samples) ASSERT_TRUE(sample >= 0 && sample <= 1);
    ++sticks;
  }
  EXPECT_EQ(sticks, 2u * 16 * 9);
  EXPECT_EQ(configurations, 2u);
  EXPECT_EQ(ends, 2u);
  EXPECT_EQ(decoder.damage().bytes_skipped, 0u);
}

TEST(SimLink, AStillPhantomKeepsItsSpeckleAndChangesItsNoise) {
  const auto plan = small_plan(2);
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  SimulationOptions options;
  options.noise_db = kSilent_db;
  const phantoms::Placement placement{glm::dmat3(1.0), phantom.suggested_position_m()};
  const ProbeSimulator silent(phantom, placement, plan, options);
  EXPECT_EQ(silent.volume(0), silent.volume(1));
  options.noise_db = -60;
  const ProbeSimulator noisy(phantom, placement, plan, options);
  EXPECT_NE(noisy.volume(0), noisy.volume(1));
}

TEST(SimLink, ArrivesWholeThroughTheBoard) {
  const auto plan = small_plan(3);
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  const ProbeSimulator simulator(
      phantom, {glm::dmat3(1.0), phantom.suggested_position_m()}, plan, {});
  hw::Board board(std::make_unique<SimLink>(simulator), {.ring_slots = 8});
  board.start();
  hw::VolumeAssembly assembly(board);
  for (std::uint32_t v = 0; v < 3; ++v) {
    const auto volume = assembly.next(hw::HostTime::max());
    ASSERT_TRUE(volume);
    EXPECT_EQ(volume->missing_sticks(), 0);
    VolumeSamples samples;
    for (const auto& frame : volume->frames()) {
      samples.insert(samples.end(), frame.samples.begin(), frame.samples.end());
    }
    EXPECT_EQ(samples, simulator.volume(v));
  }
  EXPECT_FALSE(assembly.next(hw::HostTime::max()));
  EXPECT_TRUE(assembly.ended());
  EXPECT_EQ(board.account().emitted, 3u * 16 * 9);
  EXPECT_EQ(board.account().delivered, 3u * 16 * 9);
  EXPECT_TRUE(board.account().balanced());
}

TEST(SimLink, CancelAndCloseEndReading) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  SimLink link({phantom, {glm::dmat3(1.0), phantom.suggested_position_m()}, small_plan(), {}});
  std::vector<std::byte> buffer(64);
  link.cancel();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::cancelled);
  link.resume();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::ok);
  link.close();
  EXPECT_EQ(link.read(buffer, hw::HostTime::max()).status, hw::ReadStatus::lost);
}

}  // namespace
}  // namespace wobblebench::sim
