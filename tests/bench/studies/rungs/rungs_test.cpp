// Measurements and documents of the comparison of rungs. No time is asserted.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/studies/rungs/rung_comparison.h"
#include "bench/studies/rungs/rungs_report.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using sim::Rung;

hw::AcquisitionOptions few_sticks() {
  return {.sticks_per_frame = 9, .samples_per_stick = 512, .frames_per_volume = 5};
}

RungScene sphere_scene() {
  const auto sphere = phantoms::make_phantom({.name = "sphere", .voxel_m = 1e-3});
  return {phantoms::still_at(sphere, sphere.suggested_position_m()), {{}, few_sticks()}, {}};
}

TEST(Rungs, ExponentsAreSlopesOfLogarithms) {
  std::vector<GrowthPoint> points;
  for (const double size : {1.0, 2.0, 4.0, 8.0}) {
    points.push_back({"sticks", size, Rung::field, {{3 * size}, {5 * std::sqrt(size)}}});
    points.push_back({"frames", size, Rung::field, {{7}, {7}}});
  }
  EXPECT_NEAR(growth_exponent(points, "sticks", Rung::field, &VolumeTime::first_ms), 1, 1e-12);
  EXPECT_NEAR(growth_exponent(points, "sticks", Rung::field, &VolumeTime::moving_ms), 0.5, 1e-12);
  EXPECT_NEAR(growth_exponent(points, "frames", Rung::field, &VolumeTime::first_ms), 0, 1e-12);
}

TEST(Rungs, GrowthVariesOneSizeAtATime) {
  GrowthInputs inputs;
  inputs.acquisition = few_sticks();
  inputs.sticks = {4, 8};
  inputs.frames = {2};
  inputs.samples = {128};
  inputs.scatterers = {5};
  inputs.front_mm = {400, 70, -50};
  inputs.repeats = 1;
  const auto points = measure_growth({Rung::geometry}, {}, inputs);
  std::vector<double> tissue;
  for (const auto& point : points) {
    EXPECT_GT(point.time.first_ms.min, 0) << point.what;
    if (point.what == "tissue") tissue.push_back(point.size);
  }
  EXPECT_EQ(points.size(), 2u + 1 + 1 + 1 + 3);
  ASSERT_EQ(tissue.size(), 3u);
  EXPECT_EQ(tissue[0], 0);
  EXPECT_GT(tissue[1], 0.3);
  EXPECT_LT(tissue[1], 0.7);
  EXPECT_EQ(tissue[2], 1);
}

TEST(Rungs, TrueRangesMeetTheSphere) {
  const auto scene = sphere_scene();
  const auto ranges = true_ranges(scene);
  ASSERT_EQ(ranges.size(), 45u);
  // The middle stick meets the sphere's front 50 mm from the face; the outermost ones miss it.
  EXPECT_NEAR(ranges[2 * 9 + 4], 50e-3, 1e-5);
  EXPECT_TRUE(std::isnan(ranges[0]));
}

TEST(Rungs, GeometryFindsTheSurfaceWhereItIs) {
  const auto scene = sphere_scene();
  const auto errors = measure_rung_errors("sphere", scene, {Rung::geometry, Rung::field}, {1});
  ASSERT_EQ(errors.size(), 2u);
  // The mean of three samples rises over as many: half a sample's doubt, and the slope of the
  // level.
  EXPECT_LT(errors[0].against_truth.p95_abs_mm, 0.5);
  EXPECT_EQ(errors[0].against_truth.missed_percent, 0);
  ASSERT_TRUE(errors[0].image_rms_db);
  EXPECT_GT(*errors[0].image_rms_db, 0);
  EXPECT_FALSE(errors[1].against_above);
}

TEST(Rungs, AFrameIsASectorOnWhite) {
  const hw::AcquisitionPlan plan({}, few_sticks());
  const std::vector<float> volume(static_cast<std::size_t>(plan.sticks_per_volume()) * 512, 0.25f);
  const auto picture = frame_picture(plan, volume, 2, 200);
  EXPECT_EQ(picture.width, 200);
  EXPECT_EQ(picture.at(100, picture.height / 2), 0.25f);
  EXPECT_EQ(picture.at(0, 0), 1.0f);
  EXPECT_EQ(picture.at(199, picture.height - 1), 1.0f);
}

TEST(Rungs, FrontHoldsWhatNothingBeats) {
  RungsResults results;
  results.phantom = "ball";
  results.sound_ms = 100;
  const auto add = [&](Rung rung, double ms, double error_mm) {
    RungTime time;
    time.rung = rung;
    time.first_ms = {ms, ms, ms};
    results.times.push_back(time);
    RungError error;
    error.body = "ball";
    error.rung = rung;
    error.against_truth.p95_abs_mm = error_mm;
    error.against_truth.n = 1;
    results.errors.push_back(error);
  };
  add(Rung::geometry, 10, 3);
  add(Rung::field, 20, 4);
  add(Rung::scatterers, 30, 1);
  const auto rungs = rungs_json(results, Document());
  EXPECT_EQ(rungs.at("front"), (nlohmann::ordered_json{"geometry", "scatterers"}));
}

/// Two rungs on a ball; no stick meets a surface of "fog".
RungsResults made_up_results() {
  RungsResults results;
  results.phantom = "ball";
  results.sound_ms = 100;
  results.repeats = 3;
  results.seeds = {1, 2};
  for (const Rung rung : {Rung::geometry, Rung::field}) {
    const double ms = rung == Rung::geometry ? 10 : 200;
    const Spread time{ms, 0.9 * ms, 1.5 * ms};
    results.times.push_back({rung, time, time, time, time, time, time});
    results.growth.push_back({"sticks", 16, rung, {time, time}});
    for (const char* body : {"ball", "sheet"}) {
      const double db = rung == Rung::geometry ? 8 : 2;
      const RangeError range{0.1, 0.2, 0.4, 50, 1.5};
      results.errors.push_back({body, rung, range, range, db, 0.9});
    }
  }
  results.errors.push_back({"fog", Rung::field, {}, {}, {}, {}});
  results.small_scatterers = results.small_reference = {{10, 9, 11}, {10, 9, 11}};
  return results;
}

TEST(Rungs, ChartHasATimeWithItsSpreadForEachBodyAndRung) {
  const auto figure = rungs_figure(made_up_results());
  const auto& chart = std::get<Chart>(figure.panels.front());
  ASSERT_EQ(chart.series.size(), 4u);
  const Series &ball = chart.series[0], &sheet = chart.series[1], &field = chart.series[2];
  EXPECT_EQ(ball.name, "ball, geometry");
  EXPECT_EQ(ball.mark, sheet.mark);
  EXPECT_NE(ball.colour, sheet.colour);
  EXPECT_NE(ball.mark, field.mark);
  EXPECT_EQ(ball.colour, field.colour);
  EXPECT_DOUBLE_EQ(field.x.at(0), 2);
  EXPECT_DOUBLE_EQ(field.y.at(0), 2);
  EXPECT_DOUBLE_EQ(field.low.at(0), 1.8);
  EXPECT_DOUBLE_EQ(field.high.at(0), 3);
}

TEST(Rungs, DocumentHasNoErrorWhereNoStickMeetsASurface) {
  const auto document = rungs_document(made_up_results(), {});
  const auto text = markdown(document);
  EXPECT_TRUE(holds(text, "No stick meets a surface of fog:"));
  EXPECT_EQ(document.data.front().file, "rungs_errors.csv");
  const Table& errors = document.data.front().table;
  EXPECT_EQ(errors.rows.front().at(0).text(), "ball");
  EXPECT_EQ(errors.rows.front().at(5).number(), 0.2);
  EXPECT_FALSE(errors.rows.back().at(5).is_number());
}

// The address sanitizer keeps an eighth of what is held besides.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WOBBLEBENCH_TEST_ASAN
#endif
#endif
#if defined(WOBBLEBENCH_TEST_ASAN) || defined(__SANITIZE_ADDRESS__)
constexpr double kShadow = 1.125;
#else
constexpr double kShadow = 1;
#endif

TEST(RungsCommand, RefusesWhatItSetsItself) {
  const testing_support::ScratchFolder folder;
  const auto result = testing_support::run_process(
      WOBBLEBENCH_PROGRAM, {"rungs", "--set", "simulation.fidelity=field"}, folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err.find("wobblebench: simulation.fidelity: is set by the command"), 0u)
      << result.err;
}

TEST(PeakMemory, SeesWhatABodyHolds) {
  constexpr std::size_t kBytes = 200u << 20;
  const double idle = peak_memory_bytes([] {});
  const double busy = peak_memory_bytes([] {
    std::vector<char> held(kBytes);
    for (std::size_t i = 0; i < held.size(); i += 4096) held[i] = 1;
    if (held[kBytes / 2] == 3) throw std::logic_error("unreachable");
  });
  const double expected = kShadow * static_cast<double>(kBytes);
  EXPECT_NEAR(busy - idle, expected, 0.1 * static_cast<double>(kBytes));
  EXPECT_THROW(peak_memory_bytes([] { throw std::runtime_error("expected"); }), std::runtime_error);
}

}  // namespace
}  // namespace wobblebench::bench
