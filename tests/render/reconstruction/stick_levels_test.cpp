#include "render/reconstruction/stick_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "render/reconstruction/stick_edges.h"

namespace wobblebench::render {
namespace {

constexpr int kFanFrames = 37, kFanLines = 48;
const EchoLevels kTwoKinds{0.1, 0.7, true, 0};
constexpr double kEdge_m = 0.09;

hw::AcquisitionPlan fan() {
  hw::AcquisitionOptions scan;
  scan.frames_per_volume = kFanFrames;
  scan.sticks_per_frame = kFanLines;
  return {hw::ProbeOptions{}, scan};
}

/// Fluid of 0.1, and from 90 mm on the tissue of each line.
std::vector<std::vector<float>> fan_frames(const std::function<double(int line)>& tissue) {
  const hw::AcquisitionPlan scan = fan();
  std::vector<float> frame;
  for (int line = 0; line < kFanLines; ++line) {
    for (int k = 0; k < scan.acquisition().samples_per_stick; ++k) {
      const bool beyond = scan.sample_range_m(k) > kEdge_m;
      frame.push_back(static_cast<float>(beyond ? tissue(line) : 0.1));
    }
  }
  return std::vector<std::vector<float>>(kFanFrames, frame);
}

std::vector<double> stick_levels_of(const std::function<double(int line)>& tissue,
                                    const std::vector<double>& edges,
                                    const RenderOptions& options = {}) {
  const hw::AcquisitionPlan scan = fan();
  return find_stick_levels(
      scan, fan_frames(tissue), edges, kTwoKinds, hw::BeamWidths(scan), options);
}

const std::vector<double> kEdges(std::size_t{kFanFrames} * kFanLines, kEdge_m);

/// Of the default probe at 90 mm: 6 dB are for 2.4 mm.
double below_share(double db) {
  const hw::BeamWidth width = hw::beam_width(fan(), kEdge_m);
  return db * 2.4e-3 / std::max(width.lateral_m, width.elevation_m) / 60;
}

TEST(StickLevels, LieBelowTheTissueBehindTheEdge) {
  const auto levels =
      stick_levels_of([](int line) { return line < kFanLines / 2 ? 0.7 : 0.55; }, kEdges);
  const std::size_t middle = std::size_t{kFanFrames / 2} * kFanLines;
  EXPECT_NEAR(levels[middle + 2], 0.7 - below_share(6), 2e-3);
  EXPECT_NEAR(levels[middle + kFanLines - 3], 0.55 - below_share(6), 2e-3);
  EXPECT_LT(levels[middle + kFanLines / 2], levels[middle + kFanLines / 2 - 6]);
}

TEST(StickLevels, FollowDecibelsAndTheDisplay) {
  RenderOptions options;
  options.ray_casting.below_tissue_db = 3;
  const auto tissue = [](int) { return 0.7; };
  EXPECT_NEAR(stick_levels_of(tissue, kEdges, options).front(), 0.7 - below_share(3), 2e-3);
  options.reconstruction.display_range_db = 120;
  EXPECT_NEAR(stick_levels_of(tissue, kEdges, options).front(), 0.7 - below_share(3) / 2, 2e-3);
}

TEST(StickLevels, LieTheOptionsDecibelsBelowWhereNoBeamIsKnown) {
  hw::ProbeOptions unknown;
  unknown.elements = 0;
  unknown.element_height_m = 0;
  const hw::BeamWidths beam(hw::AcquisitionPlan(unknown, fan().acquisition()));
  const auto levels = find_stick_levels(
      fan(), fan_frames([](int) { return 0.7; }), kEdges, kTwoKinds, beam, RenderOptions());
  EXPECT_NEAR(levels.front(), 0.7 - 6.0 / 60, 2e-3);
}

TEST(StickLevels, AreNoHigherThanTissueAllowsAndNoLowerThanAShare) {
  // Bone echoes more than tissue; what hardly echoes is not taken for a surface of its own.
  EXPECT_NEAR(stick_levels_of([](int) { return 1.0; }, kEdges).front(), 0.7 - below_share(6), 2e-3);
  EXPECT_NEAR(stick_levels_of([](int) { return 0.2; }, kEdges).front(), 0.1 + 0.45 * 0.6, 2e-3);
}

TEST(StickLevels, AreHigherWhereTissueIsWhite) {
  const hw::AcquisitionPlan scan = fan();
  const auto level = [&](double white) {
    return find_stick_levels(scan,
                             fan_frames([](int) { return 0.2; }),
                             kEdges,
                             {0.1, 0.7, true, white},
                             hw::BeamWidths(scan),
                             {})
        .front();
  };
  EXPECT_NEAR(level(0.5), 0.1 + 0.78 * 0.6, 2e-3);
  EXPECT_NEAR(level(0.05), 0.1 + 0.5 * (0.45 + 0.78) * 0.6, 2e-3);
}

TEST(StickLevels, WithoutAnEdgeAreTheNeighboursAndWithoutAnyTheVolumes) {
  std::vector<double> edges = kEdges;
  edges[std::size_t{5} * kFanLines + 9] = kNoEdge;
  const auto tissue = [](int) { return 0.6; };
  EXPECT_NEAR(
      stick_levels_of(tissue, edges)[std::size_t{5} * kFanLines + 9], 0.6 - below_share(6), 2e-3);
  std::fill(edges.begin(), edges.end(), kNoEdge);
  EXPECT_NEAR(stick_levels_of(tissue, edges).front(), 0.1 + 0.72 * 0.6, 1e-9);
}

TEST(StickLevels, AreLowerWhereFramesLieFarApart) {
  hw::AcquisitionOptions scan = fan().acquisition();
  scan.frames_per_volume = 19;
  auto samples = fan_frames([](int) { return 0.7; });
  samples.resize(19);
  const hw::AcquisitionPlan sparse({}, scan);
  const std::vector<double> edges(std::size_t{19} * kFanLines, kEdge_m);
  const auto levels =
      find_stick_levels(sparse, samples, edges, kTwoKinds, hw::BeamWidths(sparse), RenderOptions());
  // The motor's axis lies 27 mm behind the face.
  const double apart_m = (27e-3 + kEdge_m) * 61 * kDegree / 18;
  EXPECT_NEAR(levels.front(), 0.7 - below_share(6) * std::pow(apart_m / 4e-3, 2), 2e-3);
}

TEST(StickLevels, AreReadInFrontOfAFallingEdge) {
  RenderOptions options;
  options.ray_casting.edge = EdgeSign::falling;
  const hw::AcquisitionPlan scan = fan();
  auto falling = fan_frames([](int) { return 0.6; });
  for (auto& frame : falling) {
    for (float& sample : frame) sample = 0.7f - sample;  // 0.6 in front, 0.1 behind
  }
  const auto levels =
      find_stick_levels(scan, falling, kEdges, kTwoKinds, hw::BeamWidths(scan), options);
  EXPECT_NEAR(levels.front(), 0.6 - below_share(6), 2e-3);
}

TEST(LevelSticks, MoveEachLevelToOneAndKeepFluidAndRange) {
  std::vector<std::vector<float>> samples(kFanFrames);
  for (auto& frame : samples) {
    for (int i = 0; i < kFanLines * fan().acquisition().samples_per_stick; ++i) {
      frame.push_back(std::array{0.1f, 0.4f, 0.0f, 0.9f}[static_cast<std::size_t>(i % 4)]);
    }
  }
  std::vector<double> levels(kEdges.size(), 0.4);
  levels.back() = 0.25;
  const auto levelled = level_sticks(fan(), samples, levels, kTwoKinds, 0.55);
  EXPECT_NEAR(levelled[0][0], 0.1, 1e-6);
  EXPECT_NEAR(levelled[0][1], 0.55, 1e-6);
  EXPECT_NEAR(levelled[0][2], 0.0, 1e-6);  // -0.05 without the limit
  EXPECT_NEAR(levelled[0][3], 1.0, 1e-6);
  EXPECT_NEAR(levelled.back().end()[-3], 0.1 + 3 * 0.3, 1e-6);  // the last stick's 0.4
}

}  // namespace
}  // namespace wobblebench::render
