#include "render/reconstruction/stick_edges.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wobblebench::render {
namespace {

constexpr int kFrames = 5, kLines = 6, kStickSamples = 512;

hw::AcquisitionPlan edge_plan() {
  hw::AcquisitionOptions scan;
  scan.frames_per_volume = kFrames;
  scan.sticks_per_frame = kLines;
  scan.samples_per_stick = kStickSamples;
  return {hw::ProbeOptions{}, scan};
}

/// Frames of 0.1 before and 0.9 behind an edge whose range rises by 1 mm a line.
struct Scan {
  std::vector<std::vector<float>> frames{
      kFrames, std::vector<float>(std::size_t{kLines} * kStickSamples, 0.1f)};
  std::vector<SampleSpan> spans{std::size_t{kFrames} * kLines, {10, kStickSamples}};

  static double edge_m(int line) { return 80e-3 + 1e-3 * line; }
  /// Sample k covers its spacing about (k + 1/2) spacings; the edge lies within one.
  void step(int frame, int line, double range_m, float beyond = 0.9f) {
    const double at = range_m / edge_plan().sample_spacing_m();
    for (int k = 0; k < kStickSamples; ++k) {
      const double share = std::clamp(k + 1 - at, 0.0, 1.0);
      float& sample = frames[static_cast<std::size_t>(frame)]
                            [static_cast<std::size_t>(line * kStickSamples + k)];
      sample = static_cast<float>(0.1 + share * (double{beyond} - 0.1));
    }
  }
  std::vector<double> edges(EdgeSign sign = EdgeSign::rising) const {
    return find_stick_edges(edge_plan(), frames, spans, {0.1, 0.9, true}, sign, 0.5);
  }
};

Scan tilted_plane() {
  Scan scan;
  for (int f = 0; f < kFrames; ++f) {
    for (int l = 0; l < kLines; ++l) scan.step(f, l, Scan::edge_m(l));
  }
  return scan;
}

TEST(StickEdges, LieWhereTheEchoRisesHalfway) {
  const auto edges = tilted_plane().edges();
  for (int i = 0; i < kFrames * kLines; ++i) {
    EXPECT_NEAR(edges[static_cast<std::size_t>(i)], Scan::edge_m(i % kLines), 5e-5);
  }
}

TEST(StickEdges, OfTheOtherSignFall) {
  Scan scan = tilted_plane();
  for (auto& frame : scan.frames) {
    for (float& sample : frame) sample = 1 - sample;
  }
  const auto edges = scan.edges(EdgeSign::falling);
  EXPECT_NEAR(edges[8], Scan::edge_m(2), 5e-5);
  for (const double edge_m : scan.edges(EdgeSign::rising)) EXPECT_TRUE(std::isnan(edge_m));
}

TEST(StickEdges, NeedSupport) {
  Scan scan = tilted_plane();
  scan.step(2, 3, 50e-3);  // far in front of its neighbours'
  const auto edges = scan.edges();
  EXPECT_TRUE(std::isnan(edges[2 * kLines + 3]));
  EXPECT_NEAR(edges[2 * kLines + 2], Scan::edge_m(2), 5e-5);
}

TEST(StickEdges, NeedThreeMillimetresBehindThem) {
  Scan scan = tilted_plane();
  const double spacing_m = edge_plan().sample_spacing_m();
  // A bright speck of 1.5 mm in front of all edges.
  for (auto& frame : scan.frames) {
    for (int l = 0; l < kLines; ++l) {
      for (int k = 0; k < static_cast<int>(1.5e-3 / spacing_m); ++k) {
        frame[static_cast<std::size_t>(l * kStickSamples + 200 + k)] = 0.9f;
      }
    }
  }
  EXPECT_NEAR(scan.edges()[8], Scan::edge_m(2), 5e-5);
}

TEST(StickEdges, LieInTheBox) {
  Scan scan = tilted_plane();
  for (SampleSpan& span : scan.spans) span = {10, 200};
  for (const double edge_m : scan.edges()) EXPECT_TRUE(std::isnan(edge_m));
}

TEST(StickEdges, OfOneKindOfEchoesAreNone) {
  const Scan scan = tilted_plane();
  const auto edges = find_stick_edges(
      edge_plan(), scan.frames, scan.spans, {0.1, 0.9, false}, EdgeSign::rising, 0.5);
  for (const double edge_m : edges) EXPECT_TRUE(std::isnan(edge_m));
}

TEST(SpansInBox, EndWhereTheStickLeavesIt) {
  // The middle stick of an odd number of frames and lines lies on the z axis.
  hw::AcquisitionOptions scan;
  scan.frames_per_volume = 3;
  scan.sticks_per_frame = 3;
  const hw::AcquisitionPlan three(hw::ProbeOptions{}, scan);
  const VolumeOfInterest box{{0, 0, 0.1}, {0.02, 0.02, 0.04}};
  const auto spans = spans_in_box(three, box);
  const double first_m = 0.08 - three.probe().radius_m, last_m = 0.12 - three.probe().radius_m;
  const SampleSpan middle = spans[4];
  EXPECT_GE(three.sample_range_m(middle.begin), first_m);
  EXPECT_LT(three.sample_range_m(middle.begin - 1), first_m);
  EXPECT_LT(three.sample_range_m(middle.end - 1), last_m);
  EXPECT_GE(three.sample_range_m(middle.end), last_m);
  EXPECT_EQ(spans[0].begin, spans[0].end);  // turned away from the box
}

}  // namespace
}  // namespace wobblebench::render
