// Service times of another machine, from the report of `tables`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "base/user_error.h"
#include "bench/studies/latency/service_times.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::ordered_json;

Json stage(const std::string& settings, int frames, double scale) {
  return {{"settings", settings},
          {"frames", frames},
          {"frame_ms", {1 * scale, 3 * scale}},
          {"last_frame_ms", {10 * scale}},
          {"picture_ms", {20 * scale, 40 * scale}},
          {"new_view_ms", {5}}};
}

Json report() {
  return {{"provenance", {{"gl_renderer", "Some GPU/PCIe, OpenGL 4.6"}}},
          {"timing",
           {{"stages",
             {stage("paper", 37, 1),
              stage("default", 37, 2),
              stage("paper", 27, 0.5),
              stage("default", 27, 1)}}}}};
}

std::vector<KnownTimes> read(const Json& json) {
  const testing_support::ScratchFolder folder;
  folder.write("report.json", json.dump());
  return read_known_times(folder.path() / "report.json");
}

TEST(KnownTimes, AreThoseOfBothSettingsInSeconds) {
  const auto all = read(report());
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "Some GPU, paper");
  EXPECT_EQ(all[1].name, "Some GPU, default");
  EXPECT_EQ(all[0].frames_of_one, 37);
  EXPECT_EQ(all[0].frames_of_other, 27);
  // 36 x 2 ms + 10 ms + 30 ms, and 26 x 1 ms + 5 ms + 15 ms.
  EXPECT_NEAR(all[0].one.renderer_s(37), 0.112, 1e-9);
  EXPECT_NEAR(all[0].other.renderer_s(27), 0.046, 1e-9);
  EXPECT_NEAR(all[1].at(37).renderer_s(37), 0.224, 1e-9);
}

TEST(KnownTimes, OfReportsThatHaveNoneAreRefused) {
  const auto expect_refused = [](const Json& json, const std::string& why) {
    const std::string text = refusal_of<UserError>([&] { read(json); });
    EXPECT_EQ(text.find("--times = "), 0u) << text;
    EXPECT_TRUE(holds(text, why));
  };
  expect_refused(Json::object(), "timing");
  Json one_number = report();
  one_number["timing"]["stages"].erase(2);
  expect_refused(one_number, "two numbers of frames of the settings paper");
  Json negative = report();
  negative["timing"]["stages"][0]["picture_ms"][0] = -1;
  expect_refused(negative, "picture_ms holds what is no time");
  Json empty = report();
  empty["timing"]["stages"][3]["frame_ms"] = Json::array();
  expect_refused(empty, "frame_ms is empty");
}

}  // namespace
}  // namespace wobblebench::bench
