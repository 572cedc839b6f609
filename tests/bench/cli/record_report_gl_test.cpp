// What reports say of how samples were made: by `record`, `inspect`, and `run` on a recording.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <span>

#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

const Words kRecord = with(words_of("record --json --out rec"), {kSphere, kScan});
const Words kPlay =
    with(words_of("run --json --board file=rec/recording.wbst"), {kSphere, kPicture});

TEST(RecordReport, NamesRungReasonAndEffectsAsRunDoes) {
  const Words moving = with(set("motion.velocity_mm_s=[0,0,1]"), {set("simulation.noise_db=-150")});
  for (const Words& scene : {Words{}, moving}) {
    const ScratchFolder folder;
    const Json record = report_of(bench(with(kRecord, {scene}), folder));
    const Json run =
        report_of(bench(with({"run", "--json"}, {kSphere, kScan, kPicture, scene}), folder));
    EXPECT_EQ(record.at("effects"), run.at("effects"));
    EXPECT_FALSE(record.at("effects").empty());
    for (const char* key : {"rung", "reason", "left_out"}) {
      EXPECT_EQ(record.at("simulation").at(key), run.at("simulation").at(key)) << key;
    }
    EXPECT_EQ(record.at("simulation").at("rung"), scene.empty() ? "field" : "scatterers");
    const Json copy =
        report_of(bench(words_of("record --json --board file=rec/recording.wbst --out b"), folder));
    EXPECT_TRUE(copy.at("simulation").is_null());
    EXPECT_TRUE(copy.at("effects").empty());
  }
}

const Json kScale = {{"full_scale_db", -20}, {"dynamic_range_db", 50}, {"tgc_db_per_cm_mhz", 0.4}};

/// rec/recording.wbst with the scale kScale.
class WithScale : public InFolder {
 protected:
  void record(const Words& more = {}) {
    Words words = with(kRecord, {more});
    for (const auto& [key, value] : kScale.items()) {
      words = with(words, {set("simulation." + key + "=" + value.dump())});
    }
    EXPECT_EQ(report_of(bench(words)).at("recording").at("display_scale"), kScale);
  }

  void expect_scale_of_scene(const Json& report, const Json& scale) {
    for (const auto& [key, value] : kScale.items()) {
      EXPECT_EQ(report.at("scene").at("simulation").at(key), scale.is_null() ? scale : value)
          << key;
    }
  }
};

TEST_F(WithScale, InspectPrintsIt) {
  record();
  const auto summary = bench("inspect rec/recording.wbst");
  EXPECT_TRUE(holds(summary.out,
                    "scale       full scale -20 dB, dynamic range 50 dB, TGC 0.4 dB/cm/MHz\n"));
  const Json report = report_of(bench("inspect rec/recording.wbst --json"));
  EXPECT_EQ(report.at("recording").at("display_scale"), kScale);
}

TEST_F(WithScale, RunReportsTheRecordingsAndNotItsOwn) {
  record();
  const Json report = report_of(bench(with(kPlay, {set("simulation.full_scale_db=-5")})));
  EXPECT_EQ(report.at("board").at("display_scale"), kScale);
  expect_scale_of_scene(report, kScale);
  const Json copy = report_of(bench("record --json --board file=rec/recording.wbst --out b"));
  EXPECT_EQ(copy.at("recording").at("display_scale"), kScale);
  expect_scale_of_scene(copy, kScale);
}

TEST_F(WithScale, LinearEnvelopesAreDisplayedOverItUnlessTheSceneChooses) {
  record(set("simulation.output=linear"));
  const auto displayed_over_db = [&](const Words& more) {
    const Json report = report_of(bench(with(kPlay, {more})));
    return report.at("board").at("samples").at("log_compressed_over_db").get<double>();
  };
  EXPECT_EQ(displayed_over_db({}), 50);
  EXPECT_EQ(displayed_over_db(set("simulation.dynamic_range_db=70")), 70);
}

/// The recording as a card whose receiver is not known would send it.
std::string without_scale(const std::string& recording) {
  hw::Decoder decoder;
  decoder.feed(std::as_bytes(std::span(recording)));
  std::vector<std::byte> bytes;
  while (auto packet = decoder.next()) {
    if (auto* configuration = std::get_if<hw::ConfigurationPacket>(&*packet)) {
      configuration->display_scale = {};
    }
    std::visit(
        [&](const auto& kind) {
          if constexpr (requires { kind.stick; }) {
            hw::encode(kind.stick, bytes);
          } else {
            hw::encode(kind, bytes);
          }
        },
        *packet);
  }
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST_F(WithScale, WithoutOneItIsUnknown) {
  record();
  folder_.write("card.wbst", without_scale(bytes_of(at("rec/recording.wbst"))));
  const auto summary = bench("inspect card.wbst");
  EXPECT_TRUE(holds(summary.out, "scale       unknown: the samples do not say\n"));
  const auto run = bench("run --json --board file=card.wbst", {kSphere, kPicture});
  EXPECT_TRUE(report_of(run).at("board").at("display_scale").is_null());
  expect_scale_of_scene(report_of(run), nullptr);
}

}  // namespace
}  // namespace wobblebench::bench
