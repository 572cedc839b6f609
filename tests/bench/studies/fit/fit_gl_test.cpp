// The command `fit`, and `run` with the correction that it wrote, on a small ball.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

const Words kSmall = {"--set",
                      "phantom.name=sphere",
                      "--set",
                      "phantom.voxel_mm=1",
                      "--set",
                      "simulation.fidelity=field",
                      "--set",
                      "render.ray_casting.image_size=64",
                      "--set",
                      "acquisition.frames_per_volume=19"};
/// A detector whose error is large enough for a small scan to show what a correction does.
const Words kPaper = {"--set", "render.preset=baseline"};

TEST(Fit, WritesACorrectionThatRunApplies) {
  const ScratchFolder folder;
  const auto fitted = bench(
      with({"fit", "--json", "--seeds", "1", "--coverage", "1", "--out", "fit"}, {kSmall, kPaper}),
      folder);
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const auto fit = nlohmann::json::parse(fitted.out).at("fit");
  EXPECT_GT(fit.at("registration").at("blocks").get<int>(), 10);
  EXPECT_EQ(fit.at("registration").at("coverage").at("seeds"), 1);
  EXPECT_EQ(fit.at("model").at("terms").size(), 11);
  EXPECT_TRUE(fit.at("model").at("explained_variance_held_out").is_number());
  EXPECT_FALSE(fit.at("model").at("choice").at("taken").empty());
  for (const char* file : {"fit.md",
                           "fit_terms.csv",
                           "fit_held_out.csv",
                           "fit_residuals.csv",
                           "fit_coverage.csv",
                           "fit_residuals.vl.json",
                           "correction.json"}) {
    EXPECT_TRUE(fs::exists(folder.path() / "fit" / file)) << file;
  }
  const auto run = bench(with({"run",
                               "--json",
                               "--set",
                               "render.correction=fit/correction.json",
                               "--set",
                               "simulation.seed=77"},
                              {kSmall, kPaper}),
                         folder);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto error = nlohmann::json::parse(run.out).at("error");
  const auto rms = [](const nlohmann::json& of) {
    return of.at("depth_mm").at("rms").get<double>();
  };
  const auto bias = [](const nlohmann::json& of) {
    return std::abs(of.at("depth_mm").at("median").get<double>());
  };
  EXPECT_LT(rms(error), rms(error.at("before_correction")));
  EXPECT_LT(bias(error), 0.5 * bias(error.at("before_correction")));
  EXPECT_EQ(error.at("missed_percent"), error.at("before_correction").at("missed_percent"));
}

TEST(Fit, OfAPictureWithoutASurfaceIsRefused) {
  const ScratchFolder folder;
  const auto result = bench(
      with({"fit", "--set", "render.preset=baseline", "--set", "render.ray_casting.threshold=60"},
           {kSmall}),
      folder);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("render.ray_casting: 0 of 0 found points"), std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out" / "fit.md"));
}

TEST(Fit, RefusesAJudgedSceneThatIsNotThere) {
  const ScratchFolder folder;
  const auto result = bench({"fit", "--judge", "nowhere.toml"}, folder);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find("nowhere.toml"), std::string::npos) << result.err;
}

TEST(Fit, RefusesWhatItCannotFitInOneLine) {
  const ScratchFolder folder;
  for (const std::string setting : {"motion.velocity_mm_s=[5,0,0]",
                                    "render.ray_casting.mode=volume",
                                    "acquisition.volumes=2",
                                    "render.correction=x.json"}) {
    const auto result = bench({"fit", "--set", setting}, folder);
    EXPECT_EQ(result.exit_code, 2) << setting;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

}  // namespace
}  // namespace wobblebench::bench
