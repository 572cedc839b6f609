// Streams that change, files that cannot be read, and limits of the machine, by running the
// program.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

class LiveFaults : public testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  ProcessResult run(const Words& arguments, const ProcessLimits& limits = {}) const {
    return bench(arguments, folder_, limits);
  }
  std::string record(const Words& phantom, const std::string& folder) const {
    const auto result =
        run(with({"record", "--volumes", "2", "--out", folder}, {kSphere, kScan, phantom}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return bytes_of(at(folder + "/recording.wbst"));
  }
  static void expect_line(const ProcessResult& result, int code, const std::string& text) {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_NE(result.err.find(text), std::string::npos) << result.err;
  }

  ScratchFolder folder_;
};

TEST_F(LiveFaults, AnotherBodyInTheStreamIsRefusedAndAnotherScaleEndsIt) {
  const std::string sphere = record({}, "sphere");
  folder_.write("bodies.wbst", sphere + record({"--set", "phantom.radius_mm=25"}, "other"));
  folder_.write("scales.wbst", sphere + record({"--set", "simulation.full_scale_db=-6"}, "scaled"));
  const auto stream = [&](const std::string& file) {
    return run(with({"stream", "--board", "file=" + file, "--out", "out"}, {kSphere, kPicture}));
  };
  expect_line(stream("bodies.wbst"), 2, "behind 2 volumes the samples are of another subject");
  EXPECT_FALSE(fs::exists(at("out")));
  expect_line(stream("scales.wbst"), 1, "behind 2 volumes the display scale changes");
  EXPECT_EQ(Json::parse(bytes_of(at("out/report.json")))["timing"]["latency"]["shown"]["volumes"],
            2);
}

TEST_F(LiveFaults, AFileThatCannotBeReadIsNotAnEmptyOne) {
  for (const Words& command : {Words{"phantom", "/proc/self/mem"},
                               Words{"run", "/proc/self/mem"},
                               Words{"trade", "/proc/self/mem"},
                               Words{"accuracy", "/proc/self/mem"}}) {
    expect_line(run(with(command, {{"--out", "out"}})),
                1,
                "/proc/self/mem: cannot be read: Input/output error");
    EXPECT_FALSE(fs::exists(at("out"))) << command.front();
  }
}

TEST_F(LiveFaults, AnUnknownDriverIsOneLine) {
  const auto result = run(with({"run", "--out", "out"}, {kSphere, kScan, kPicture}),
                          {.environment = {{"GALLIUM_DRIVER", "none_such"}}});
  expect_line(result, 1, "where GALLIUM_DRIVER = none_such");
}

TEST_F(LiveFaults, AgesOfSinglePicturesAreThoseOfTheReport) {
  const auto result = run(with({"stream",
                                "--board",
                                "sim,pace=realtime",
                                "--volumes",
                                "5",
                                "--policy",
                                "every",
                                "--errors",
                                "0",
                                "--codec",
                                "none",
                                "--out",
                                "out"},
                               {kSphere, kScan, kPicture}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::istringstream csv(bytes_of(at("out/ages.csv")));
  std::string line;
  std::getline(csv, line);
  Words names;
  std::istringstream head(line);
  for (std::string name; std::getline(head, name, ',');) names.push_back(name);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  ASSERT_LT(column("age_newest_ms"), names.size());
  ASSERT_LT(column("ray_casting_ms"), names.size());
  double oldest = 0;
  int lines = 0;
  while (std::getline(csv, line)) {
    std::vector<double> values;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
    ASSERT_EQ(values.size(), names.size());
    EXPECT_EQ(values[column("volume")], lines++);
    const double shown = values[column("shown_ms")];
    EXPECT_NEAR(values[column("age_newest_ms")], shown - values[column("emitted_last_ms")], 2e-3);
    EXPECT_NEAR(values[column("age_oldest_ms")], shown - values[column("emitted_first_ms")], 2e-3);
    EXPECT_LE(values[column("emitted_last_ms")], values[column("arrived_last_ms")]);
    EXPECT_LE(values[column("arrived_last_ms")], values[column("complete_ms")]);
    EXPECT_LE(shown, values[column("written_ms")]);
    oldest = std::max(oldest, values[column("age_oldest_ms")]);
  }
  EXPECT_EQ(lines, 5);
  const Json report = Json::parse(bytes_of(at("out/report.json")));
  EXPECT_NEAR(report["timing"]["latency"]["age_oldest_ms"]["max"].get<double>(), oldest, 1e-3);
}

TEST_F(LiveFaults, LossesInAStreamFailWhereThatIsAskedFor) {
  const Words command = with({"stream",
                              "--board",
                              "sim,faults=drop@20",
                              "--volumes",
                              "2",
                              "--errors",
                              "0",
                              "--codec",
                              "none",
                              "--out",
                              "out"},
                             {kSphere, kScan, kPicture});
  EXPECT_EQ(run(command).exit_code, 0);
  expect_line(
      run(with(command, {{"--fail-on-loss"}})), 1, "--fail-on-loss: 1 of 288 sticks were lost");
  EXPECT_TRUE(fs::exists(at("out/surface.png")));
}

TEST_F(LiveFaults, TheCpuInThePlaceOfADeviceIsSaid) {
  const auto result =
      run(with({"run", "--gl", "egl-device", "--out", "out"}, {kSphere, kScan, kPicture}));
  if (result.exit_code != 0) GTEST_SKIP() << "no EGL device: " << result.err;
  const Json report = Json::parse(bytes_of(at("out/report.json")));
  const bool cpu = report["provenance"]["gl_renderer"].get<std::string>().find("llvmpipe") == 0;
  EXPECT_EQ(result.err.find("warning: --gl = egl-device") != std::string::npos, cpu) << result.err;
  EXPECT_EQ(report["warnings"].size(), cpu ? 1u : 0u);
}

}  // namespace
}  // namespace wobblebench::bench
