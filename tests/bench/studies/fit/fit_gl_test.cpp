// The command `fit` on a small ball.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

const Words kSmall =
    set("phantom.name=sphere phantom.voxel_mm=1 simulation.fidelity=field "
        "render.ray_casting.image_size=64 acquisition.frames_per_volume=19");
/// A detector whose error is large enough for a correction to gain on a small scan.
const Words kPaper = set("render.preset=baseline");

using Fit = InFolder;

TEST_F(Fit, SaysWhatACorrectionWouldGain) {
  const auto fit =
      report_of(bench("fit --json --seeds 1 --coverage 1 --out fit", {kSmall, kPaper})).at("fit");
  EXPECT_GT(fit.at("registration").at("blocks").get<int>(), 10);
  EXPECT_EQ(fit.at("registration").at("coverage").at("seeds"), 1);
  EXPECT_EQ(fit.at("model").at("terms").size(), 11 + 4);
  EXPECT_TRUE(fit.at("model").at("explained_variance_held_out").is_number());
  EXPECT_FALSE(fit.at("model").at("choice").at("taken").empty());
  for (const std::string& file :
       words_of("fit.md fit_terms.csv fit_held_out.csv fit_residuals.csv fit_coverage.csv "
                "fit_residuals.vl.json")) {
    EXPECT_TRUE(fs::exists(at("fit") / file)) << file;
  }
  const auto held_out = fit.at("model").at("scans").at(1);
  EXPECT_LT(held_out.at("rms_after_mm"), held_out.at("rms_before_mm"));
}

TEST_F(Fit, OfAPictureWithoutASurfaceIsRefused) {
  expect_line(
      bench("fit --set render.preset=baseline --set render.ray_casting.threshold=60", {kSmall}),
      2,
      "render.ray_casting: 0 of 0 found points");
  EXPECT_FALSE(fs::exists(at("out/fit.md")));
}

TEST_F(Fit, RefusesAJudgedSceneThatIsNotThere) {
  expect_refused(bench("fit --judge nowhere.toml"), "nowhere.toml");
}

TEST_F(Fit, RefusesWhatItCannotFitInOneLine) {
  expect_refusals({{"fit --set motion.velocity_mm_s=[5,0,0]", "motion: must be none"},
                   {"fit --set render.ray_casting.mode=volume", "render.ray_casting.mode"},
                   {"fit --set acquisition.volumes=2", "acquisition.volumes"}});
}

}  // namespace
}  // namespace wobblebench::bench
