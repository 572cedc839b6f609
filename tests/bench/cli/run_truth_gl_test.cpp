// What `run` says about its truth and its samples, by running the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <span>
#include <string>
#include <vector>

#include "hw/wire/crc32c.h"
#include "hw/wire/packet.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

const Words kPlayed = words_of("run --json --board file=rec/recording.wbst");

/// The last line of stderr, beginning with the program's name; what was done before is progress.
void expect_refusal(const ProcessResult& result, const std::string& words) {
  EXPECT_EQ(result.exit_code, 2);
  const auto line = result.err.find("wobblebench: ");
  ASSERT_NE(line, std::string::npos) << result.err;
  EXPECT_NE(result.err.find(words, line), std::string::npos) << result.err;
  EXPECT_EQ(
      std::count(result.err.begin() + static_cast<std::ptrdiff_t>(line), result.err.end(), '\n'), 1)
      << result.err;
}

class RecordedSphere : public InFolder {
 protected:
  void SetUp() override { fs::copy(recorded(1), at("rec")); }
  ProcessResult play(const std::vector<Words>& settings) { return bench(with(kPlayed, settings)); }
};

TEST_F(RecordedSphere, IsNotScoredAgainstTheDefaultFace) {
  expect_refusal(play({kPicture}), "the scene's [phantom] is not that of the recording");
  EXPECT_FALSE(fs::exists(at("out/report.json")));
}

TEST_F(RecordedSphere, IsNotScoredElsewhereOrInMotion) {
  expect_refusal(play({kSphere, kPicture, set("placement.rotation_deg=[10,0,0]")}),
                 "the scene's [placement] is not");
  expect_refusal(play({kSphere, kPicture, set("placement.position_mm=[1,0,110]")}),
                 "the scene's [placement] is not");
  expect_refusal(play({kSphere, kPicture, set("motion.velocity_mm_s=[0,0,1]")}),
                 "the scene's [motion] is not");
}

TEST_F(RecordedSphere, IsScoredWhateverElseDiffers) {
  const auto report = report_of(
      play({kSphere,
            kPicture,
            set("simulation.seed=5 render.view.yaw_deg=20 render.ray_casting.threshold=0.2")}));
  EXPECT_EQ(report.at("truth"), "recorded scene");
  EXPECT_TRUE(report.at("provenance").at("seed").is_null()) << "not the recording's";
  const auto live = report_of(bench("run --json", {kSphere, kScan, kPicture}));
  EXPECT_EQ(live.at("truth"), "simulated scene");
  EXPECT_EQ(live.at("provenance").at("seed"), 1);
}

constexpr std::size_t kConfigurationBytes = hw::kWireHeaderBytes + hw::kWireConfigurationBytes;

/// The configuration as programs wrote it before it had a subject.
void remove_subject(const fs::path& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::string bytes(kConfigurationBytes, '\0');
  file.read(bytes.data(), kConfigurationBytes);
  std::fill(bytes.begin() + 64 + 148, bytes.begin() + 64 + 160, '\0');
  const auto span = std::as_bytes(std::span(bytes));
  const auto crc = hw::crc32c(span.subspan(64), hw::crc32c(span.first(60)));
  for (int i = 0; i < 4; ++i) bytes[60 + i] = static_cast<char>(crc >> (8 * i));
  file.seekp(0).write(bytes.data(), kConfigurationBytes);
}

TEST_F(RecordedSphere, WithoutASubjectItsTruthIsTakenOnTrust) {
  remove_subject(at("rec/recording.wbst"));
  EXPECT_EQ(report_of(play({kSphere, kPicture})).at("truth"), "scene, on trust");
  const auto summary = bench("run --board file=rec/recording.wbst", {kSphere, kPicture});
  EXPECT_EQ(summary.exit_code, 0) << summary.err;
  EXPECT_TRUE(holds(summary.out, "taken from the scene on trust"));
}

using RunReport = InFolder;

TEST_F(RunReport, NamesTheModeThatRendered) {
  for (const char* mode : {"fast", "plain"}) {
    const auto report = report_of(
        bench("run --json",
              {kSphere, kScan, kPicture, set(std::string("render.pipeline.mode=") + mode)}));
    EXPECT_EQ(report.at("render").at("mode"), mode);
  }
}

TEST_F(RunReport, WithoutASurfaceInViewHasNoFigures) {
  const std::vector<Words> nothing = {kSphere,
                                      kScan,
                                      kPicture,
                                      set("render.volume_of_interest.center_mm=[0,0,60] "
                                          "render.volume_of_interest.size_mm=[20,20,10]")};
  const auto error = report_of(bench("run --json", nothing)).at("error");
  EXPECT_TRUE(error.at("missed_percent").is_null());
  EXPECT_TRUE(error.at("missed_surface_percent").is_null());
  EXPECT_TRUE(error.at("false_percent").is_null());
  EXPECT_TRUE(error.at("bias_mm").is_null());
  EXPECT_EQ(error.at("surface_percent"), 0);
  const auto summary = bench("run", nothing);
  EXPECT_EQ(summary.exit_code, 0);
  EXPECT_TRUE(holds(summary.out, "no surface in view"));
}

/// Point scatterers have no surface: what is found of their echoes is not false.
TEST_F(RunReport, OfPointsHasNoFalseSurface) {
  const Words points = set("phantom.name=points");
  const auto result = bench("run", {points, kScan, kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(holds(result.out, "no surface in view: the phantom has no surface to detect\n"));
  const Json error = json_of("out/report.json").at("error");
  EXPECT_GT(error.at("found_surface_cm2"), 0);
  EXPECT_TRUE(error.at("false_percent").is_null());
  EXPECT_TRUE(error.at("false_surface_percent").is_null());
}

TEST_F(RunReport, GivesMissedOfTheSurfaceBesideMissedOfThePicture) {
  // Nothing is found: all of the surface is missed, and less of the picture.
  const auto error =
      report_of(bench("run --json",
                      {kSphere,
                       kScan,
                       kPicture,
                       set("render.preset=baseline render.ray_casting.threshold=60")}))
          .at("error");
  EXPECT_EQ(error.at("missed_surface_percent"), 100);
  EXPECT_EQ(error.at("missed_percent"), error.at("surface_percent"));
  EXPECT_LT(error.at("missed_percent").get<double>(), 90);
}

/// Log-compressed on arrival, live and from a recording.
TEST_F(RunReport, RendersLinearEnvelopesAsTheirLogCompression) {
  const Words linear = set("simulation.output=linear");
  const auto log = report_of(bench("run --json", {kSphere, kScan, kPicture}));
  const auto live = report_of(bench("run --json", {kSphere, kScan, kPicture, linear}));
  ASSERT_EQ(bench("record --out rec", {kSphere, kScan, linear}).exit_code, 0);
  const auto played = report_of(bench(with(kPlayed, {kSphere, kPicture})));
  for (const auto& report : {live, played}) {
    EXPECT_EQ(report.at("board").at("samples").at("scale"), "linear");
    EXPECT_EQ(report.at("board").at("samples").at("log_compressed_over_db"), 60);
    const auto bias = [](const Json& of) { return of.at("error").at("bias_mm"); };
    EXPECT_NEAR(bias(report).get<double>(), bias(log).get<double>(), 1e-3);
  }
  EXPECT_EQ(log.at("board").at("samples").at("scale"), "log");
}

/// A recording of constant sticks written by hand.
void write_recording(const fs::path& path, hw::Stick stick, hw::StreamOrigin source) {
  const hw::AcquisitionPlan plan(
      {}, {.sticks_per_frame = 16, .samples_per_stick = 64, .frames_per_volume = 9});
  std::vector<std::byte> bytes;
  encode(
      hw::ConfigurationPacket{
          .source = source, .probe = plan.probe(), .acquisition = plan.acquisition()},
      bytes);
  for (std::uint64_t sequence = 0; sequence < 9 * 16; ++sequence) {
    stick.sequence = sequence;
    stick.index = plan.index(sequence);
    stick.time = plan.stick_time(sequence);
    stick.motor_angle_rad = plan.motor_angle_rad(stick.index);
    encode(stick, bytes);
  }
  encode(hw::VolumeEndPacket{.sequence = 9 * 16, .volume = 0, .time = plan.volume_end_time(0)},
         bytes);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

using RunSamples = InFolder;

TEST_F(RunSamples, OfAnotherScaleAreRefused) {
  fs::create_directory(at("rec"));
  hw::Stick stick;
  stick.samples.assign(64, 200.0f);
  write_recording(at("rec/recording.wbst"), stick, hw::StreamOrigin::simulated);
  expect_line(bench(with(kPlayed, {kSphere, kPicture})),
              2,
              "its samples go from 200 to 200, 100 % of them out of range");
  stick.samples.assign(64, 0.5f);
  stick.scale = hw::SampleScale::linear_envelope;
  write_recording(at("rec/recording.wbst"), stick, hw::StreamOrigin::hardware);
  expect_line(
      bench(with(kPlayed, {kSphere, kPicture})), 2, "linear envelopes of unknown full scale");
}

TEST_F(RunSamples, OutOfRangeAreNamedWithTheLeastAndTheMost) {
  fs::create_directory(at("rec"));
  hw::Stick stick;
  stick.samples.assign(64, 0.25f);
  write_recording(at("rec/recording.wbst"), stick, hw::StreamOrigin::simulated);
  // One sample of one stick: of 9216, 0.01 %.
  std::fstream file(at("rec/recording.wbst"), std::ios::in | std::ios::out | std::ios::binary);
  std::string packet(64 + 256, '\0');
  file.seekg(kConfigurationBytes).read(packet.data(), static_cast<std::streamsize>(packet.size()));
  const float outlier = 3;
  std::memcpy(packet.data() + 64 + 40, &outlier, 4);
  const auto span = std::as_bytes(std::span(packet));
  const auto crc = hw::crc32c(span.subspan(64), hw::crc32c(span.first(60)));
  for (int i = 0; i < 4; ++i) packet[60 + i] = static_cast<char>(crc >> (8 * i));
  file.seekp(kConfigurationBytes).write(packet.data(), static_cast<std::streamsize>(packet.size()));
  file.close();
  const auto report = report_of(bench(with(kPlayed, {kSphere, kPicture})));
  EXPECT_EQ(report.at("board").at("samples").at("out_of_range"), 1);
  EXPECT_EQ(report.at("board").at("samples").at("most"), 3);
  const auto summary = bench("run --board file=rec/recording.wbst", {kSphere, kPicture});
  EXPECT_TRUE(holds(summary.out, "1 of 9216 out of range and clamped: they go from 0.25 to 3"));
}

class RunWarnings : public InFolder {
 protected:
  /// Warnings of a run of the small sphere, one line each on stderr and in the report.
  std::vector<std::string> warnings_of(const Words& more) const {
    const auto result = bench("run --json", {kSphere, kScan, kPicture, more});
    const auto warnings = report_of(result).at("warnings").get<std::vector<std::string>>();
    for (const std::string& warning : warnings) {
      EXPECT_TRUE(holds(result.err, "wobblebench: warning: " + warning + "\n"));
    }
    return warnings;
  }
};

TEST_F(RunWarnings, SayWhichStageLostTheSurface) {
  const auto only = [&](const Words& more, const std::string& text) {
    const auto warnings = warnings_of(more);
    ASSERT_EQ(warnings.size(), 1U) << text;
    EXPECT_TRUE(holds(warnings.front(), text));
  };
  EXPECT_EQ(warnings_of({}), std::vector<std::string>{});
  const std::string box = "render.volume_of_interest.center_mm=";
  only(set(box + "[0,0,900]"),
       "no stick passes render.volume_of_interest: it lies outside the scanned sector");
  only(with(set("render.preset=baseline"), {set("render.ray_casting.threshold=60")}),
       "Difference reached the threshold, 60 over 8 samples");
  only(set("phantom.name=speckle_block"), "shows no surface and is black");
}

/// A threshold of 0 takes noise for a surface, in a box of fluid.
TEST_F(RunWarnings, SayThatThePhantomHasNoSurfaceThere) {
  const auto warnings = warnings_of(
      with(set("render.preset=baseline"),
           {set("render.ray_casting.threshold=0 render.volume_of_interest.center_mm=[0,0,60] "
                "render.volume_of_interest.size_mm=[40,40,24]")}));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings.front().find("the phantom has no surface in view"), 0U) << warnings.front();
}

TEST_F(RunReport, HoldsTheLevelsOfFluidAndTissue) {
  const auto levels = [&](const Words& more) {
    return report_of(bench("run --json", {kSphere, kScan, kPicture, more}))
        .at("render")
        .at("levels");
  };
  const auto measured = levels({});
  EXPECT_TRUE(measured.at("separate"));
  EXPECT_GE(measured.at("fluid"), 0);
  EXPECT_GT(measured.at("tissue"), measured.at("fluid"));
  EXPECT_LE(measured.at("tissue"), 1);
  EXPECT_TRUE(levels(set("render.preset=baseline")).is_null());
}

TEST_F(RunReport, TheSummarySaysWhatWasFitted) {
  const auto result = bench("run --register", {kSphere, kScan, kPicture});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::regex_search(
      result.out, std::regex("\nregistered  \\d+ points, RMS distance .* mm before, .* mm after")))
      << result.out;
  EXPECT_TRUE(std::regex_search(
      result.out,
      std::regex(
          "\n            bias along the ray -?[0-9.e-]+ mm \\(-?[0-9.e-]+ to -?[0-9.e-]+\\)\n")))
      << result.out;
}

TEST_F(RunReport, ALengthThatIsTooLongForTheBoxIsRefusedByItsKey) {
  // 64 steps of the sphere's box are shorter than those of the default box.
  const auto result = bench(
      "run",
      {kSphere, kScan, set("render.preset=baseline render.ray_casting.buffer_length_mm=9.5")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(
      holds(result.err, "wobblebench: render.ray_casting.buffer_length_mm = 9.5: must be 2 to 64"));
}

}  // namespace
}  // namespace wobblebench::bench
