// What `run` and `inspect` say of a scan that is not the one that was meant, and whether the files
// of `run` give the figures of its report, by running the program.
#include <gtest/gtest.h>

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "hw/wire/packet.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;
using Law = std::function<double(double planned_rad)>;

const Words kPlayed = words_of("run --board file=scan.wbst");

/// A volume of dark and bright samples from hardware; the motor angle of a stick is `law` of the
/// plan's.
void write_scan(const ScratchFolder& folder, const Law& law, int frames = 9) {
  const hw::AcquisitionPlan plan(
      {}, {.sticks_per_frame = 16, .samples_per_stick = 64, .frames_per_volume = frames});
  std::vector<std::byte> bytes;
  encode(hw::ConfigurationPacket{.source = hw::StreamOrigin::hardware,
                                 .probe = plan.probe(),
                                 .acquisition = plan.acquisition()},
         bytes);
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  for (std::uint64_t sequence = 0; sequence < sticks; ++sequence) {
    hw::Stick stick;
    hw::schedule(stick, plan, sequence);
    stick.motor_angle_rad = law(stick.motor_angle_rad);
    stick.samples.assign(64, 0.1f);
    std::fill(stick.samples.begin() + 40, stick.samples.end(), 0.8f);
    encode(stick, bytes);
  }
  encode(hw::VolumeEndPacket{.sequence = sticks, .volume = 0, .time = plan.volume_end_time(0)},
         bytes);
  std::ofstream(folder.path() / "scan.wbst", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// What stderr warns of, line by line.
int warnings(const ProcessResult& result, const std::string& words) {
  std::istringstream lines(result.err);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    count += line.find("wobblebench: warning: ") != std::string::npos &&
             line.find(words) != std::string::npos;
  }
  return count;
}

using RunOnAScan = InFolder;

TEST_F(RunOnAScan, MotorAnglesThatLeaveThePlanAreSaidWithMaximumAndRms) {
  // 1 degree off: the RMS is 1 degree, too.
  write_scan(folder_, [](double planned_rad) { return planned_rad + kDegree; });
  const auto result = bench(with(kPlayed, {kPicture}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(warnings(result, "motor angles leave the plan by at most 1 deg (RMS 1 deg)"), 1)
      << result.err;
  const Json report = json_of("out/report.json");
  EXPECT_NEAR(report.at("acquisition").at("motor_angles").at("off_plan_max_deg"), 1, 1e-6);
  EXPECT_NEAR(report.at("acquisition").at("motor_angles").at("off_plan_rms_deg"), 1, 1e-6);
  EXPECT_NEAR(report.at("acquisition").at("motor_angles").at("greatest_deg"), 31.5, 1e-6);
  EXPECT_TRUE(holds(report.at("warnings").dump(), "motor angles"));
  const auto inspected = bench("inspect scan.wbst");
  EXPECT_TRUE(
      holds(inspected.out, "motor       angles leave the plan by at most 1 deg (RMS 1 deg)"));
}

TEST_F(RunOnAScan, MotorAnglesThatKeepToThePlanAreNotSpokenOf) {
  write_scan(folder_, [](double planned_rad) { return double{static_cast<float>(planned_rad)}; });
  const auto result = bench(with(kPlayed, {kPicture}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(warnings(result, "motor"), 0) << result.err;
  EXPECT_FALSE(holds(bench("inspect scan.wbst").out, "motor "));
}

TEST_F(RunOnAScan, MotorAnglesOutsideTheFanAreRefused) {
  write_scan(folder_, [](double planned_rad) { return planned_rad + 70 * kDegree; });
  for (const char* command : {"run", "stream"}) {
    Words words = kPlayed;
    words.front() = command;
    expect_line(bench(with(words, {kPicture})),
                2,
                "--board = file=scan.wbst: its motor angles go from 39.5 to 100");
  }
}

TEST_F(RunOnAScan, TheIncidenceCorrectionForAnotherReceiverOrHardwareIsSaidUnlessItIsGiven) {
  const std::string words =
      "render.ray_casting.incidence_correction_mm = auto takes the width of the beam";
  const auto warned = [&](const std::vector<Words>& settings) {
    const auto result = bench("run", {kSphere, kScan, kPicture, with({}, settings)});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return warnings(result, words);
  };
  EXPECT_EQ(warned({}), 0);
  EXPECT_EQ(warned({set("probe.preset=c5-2v")}), 0);
  const Words other_receiver = set("simulation.dynamic_range_db=40");
  EXPECT_EQ(warned({other_receiver}), 1);
  EXPECT_EQ(warned({other_receiver, set("render.preset=baseline")}), 0);
  EXPECT_EQ(warned({other_receiver, set("render.ray_casting.incidence_correction_mm=1.2")}), 0);
  EXPECT_EQ(warned({set("simulation.fidelity=geometry")}), 0);
  EXPECT_EQ(json_of("out/report.json")
                .at("scene")
                .at("render")
                .at("ray_casting")
                .at("incidence_correction_mm"),
            0);
  write_scan(folder_, [](double planned_rad) { return planned_rad; });
  EXPECT_EQ(warnings(bench(with(kPlayed, {kPicture})), words), 1);
  EXPECT_TRUE(holds(json_of("out/report.json").at("warnings").dump(), words));
}

TEST_F(RunOnAScan, OneFrameIsSaidToFillItsFan) {
  write_scan(
      folder_, [](double planned_rad) { return planned_rad; }, 1);
  EXPECT_EQ(warnings(bench(with(kPlayed, {kPicture})),
                     "acquisition.frames_per_volume = 1: the picture shows the one plane all over "
                     "the fan of 61 deg"),
            1);
}

/// The channels of an EXR by their names.
std::map<std::string, std::vector<float>> channels_of(const fs::path& path) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) throw std::runtime_error(path.string() + ": cannot be read");
  const OIIO::ImageSpec& spec = input->spec();
  std::map<std::string, std::vector<float>> channels;
  for (int c = 0; c < spec.nchannels; ++c) {
    std::vector<float>& values = channels[spec.channelnames[static_cast<std::size_t>(c)]];
    values.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
    if (!input->read_image(0, 0, c, c + 1, OIIO::TypeDesc::FLOAT, values.data())) {
      throw std::runtime_error(path.string() + ": " + input->geterror());
    }
  }
  return channels;
}

/// As numpy.percentile(values, 95).
double p95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double at = 0.95 * static_cast<double>(values.size() - 1);
  const auto first = static_cast<std::size_t>(at);
  const double next = values[std::min(first + 1, values.size() - 1)];
  return values[first] + (at - std::floor(at)) * (next - values[first]);
}

/// As docs/output.md computes them.
TEST_F(RunOnAScan, FilesGiveTheFiguresOfTheReport) {
  // Seen askew, with a wide box, a short fan and a low threshold: pixels of every reason.
  const auto result = bench(
      "run",
      {kSphere,
       kScan,
       kPicture,
       set("acquisition.fan_deg=14 render.view.pitch_deg=50 render.ray_casting.iso_level=0.4")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json error = json_of("out/report.json").at("error");
  const auto found = channels_of(at("out/depth.exr")).at("Z");
  const auto truth = channels_of(at("out/truth_depth.exr"));
  const auto& reason = truth.at("truth_reason");
  const auto& crossing = truth.at("Z_crossing");
  std::vector<double> errors;
  double missed = 0, false_surface = 0;
  std::map<int, int> counts;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ++counts[static_cast<int>(reason[i])];
    const bool is_found = !std::isnan(found[i]), seen = reason[i] == 1;
    EXPECT_EQ(std::isnan(truth.at("Z")[i]), !seen);
    EXPECT_EQ(std::isnan(crossing[i]), reason[i] == 0);
    missed += seen && !is_found;
    false_surface += reason[i] == 0 && is_found;
    if (seen && is_found) errors.push_back(std::abs(double{found[i]} - double{crossing[i]}));
  }
  const double percent = 100.0 / static_cast<double>(found.size());
  EXPECT_GT(counts[1], 100);
  EXPECT_GT(counts[2], 0);
  EXPECT_GT(counts[3], 0);
  EXPECT_NEAR(error.at("p95_mm"), p95(errors), 1e-4);
  EXPECT_EQ(error.at("pixels"), errors.size());
  EXPECT_NEAR(error.at("missed_percent"), missed * percent, 1e-9);
  EXPECT_NEAR(error.at("false_percent"), false_surface * percent, 1e-9);
  EXPECT_NEAR(error.at("outside_field_percent"), counts[2] * percent, 1e-9);
  EXPECT_NEAR(error.at("grazing_percent"), counts[3] * percent, 1e-9);
  EXPECT_NEAR(error.at("shadowed_percent"), counts[4] * percent, 1e-9);
}

}  // namespace
}  // namespace wobblebench::bench
