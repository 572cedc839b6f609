// record --iq, by running the program: the array is what the recorded samples are made of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kHeaderBytes = 128;
const Words kSmallScan = with({}, {kSphere, kScan, set("acquisition.samples_per_stick=128")});
const Words kTwoVolumes = words_of("--volumes 2 --set acquisition.motor=alternating");

std::complex<double> iq_at(const std::string& array, std::size_t index) {
  std::complex<float> value;
  std::memcpy(&value, array.data() + kHeaderBytes + 8 * index, 8);
  return value;
}

/// The default receive chain: envelope, mean, TGC, log compression.
double detected(const std::string& array, std::size_t first, std::size_t each, int k) {
  double envelope = 0;
  for (std::size_t i = 0; i < each; ++i) {
    envelope += std::abs(iq_at(array, first + i)) / static_cast<double>(each);
  }
  const double tgc_db = 2 * 0.22 * 3.5 * 16 * (k + 0.5) / 128;
  return std::clamp(1 + (20 * std::log10(envelope) + tgc_db + 15) / 60, 0.0, 1.0);
}

using RecordIq = InFolder;

TEST_F(RecordIq, DetectedItIsTheRecording) {
  const auto result = bench("record --iq --json", {kSmallScan, kTwoVolumes});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder_.files("out"),
            words_of("iq.npy recording.json recording.wbst report.html report.json"));
  const Json iq = Json::parse(result.out).at("iq");
  const std::vector<std::size_t> shape = iq.at("shape");
  ASSERT_EQ(shape.size(), 4U);
  EXPECT_EQ(std::vector(shape.begin(), shape.end() - 1), (std::vector<std::size_t>{2, 9, 16}));
  EXPECT_NEAR(iq.at("sample_spacing_mm"), 160.0 / static_cast<double>(shape[3]), 1e-12);
  EXPECT_EQ(iq.at("center_frequency_mhz"), 3.5);
  const std::string array = bytes_of(at("out/iq.npy")), bytes = bytes_of(at("out/recording.wbst"));
  ASSERT_EQ(array.size(), kHeaderBytes + 8 * 2 * 9 * 16 * shape[3]);
  hw::Decoder decoder;
  decoder.feed(std::as_bytes(std::span(bytes)));
  std::size_t sticks = 0, shown = 0;
  while (const auto packet = decoder.next()) {
    const auto* found = std::get_if<hw::StickPacket>(&*packet);
    if (found == nullptr) continue;
    const auto& [volume, frame, line] = found->stick.index;
    const std::size_t first = ((volume * 9 + frame) * 16 + line) * shape[3];
    for (int k = 0; k < 128; ++k) {
      const std::size_t each = shape[3] / 128, from = first + static_cast<std::size_t>(k) * each;
      const float sample = found->stick.samples.at(static_cast<std::size_t>(k));
      ASSERT_NEAR(sample, detected(array, from, each, k), 2e-6) << volume << frame << line << k;
      shown += sample > 0 && sample < 1 ? 1 : 0;
    }
    ++sticks;
  }
  EXPECT_EQ(sticks, 2U * 9 * 16);
  EXPECT_GT(shown, 5000U);
}

TEST_F(RecordIq, LeavesTheRecordingAsItIs) {
  ASSERT_EQ(bench("record --iq --out a", {kSmallScan}).exit_code, 0);
  const auto plain = bench("record --out b --json", {kSmallScan});
  EXPECT_EQ(bytes_of(at("a/recording.wbst")), bytes_of(at("b/recording.wbst")));
  EXPECT_EQ(folder_.files("b"), words_of("recording.json recording.wbst report.html report.json"));
  EXPECT_TRUE(Json::parse(plain.out).at("iq").is_null());
}

TEST_F(RecordIq, IsWhatWasEmittedWhateverTheLinkLoses) {
  ASSERT_EQ(bench("record --iq --out whole", {kSmallScan}).exit_code, 0);
  const std::string whole = bytes_of(at("whole/iq.npy"));
  for (const std::string fault : {"drop:0.05+corrupt:0.05+seed:2", "unplug@60"}) {
    const auto result =
        bench(with({"record", "--iq", "--out", "lossy" + fault, "--board", "sim,faults=" + fault},
                   {kSmallScan}));
    EXPECT_EQ(result.exit_code, fault.starts_with("unplug") ? 1 : 0) << result.err;
    const auto report = json_of("lossy" + fault + "/report.json");
    EXPECT_LT(report.at("board").at("delivered"), 9 * 16);
    EXPECT_TRUE(bytes_of(at("lossy" + fault + "/iq.npy")) == whole) << fault;
  }
}

/// A volume has 1.2 MB of IQ samples, and 0.08 MB of the recording.
TEST_F(RecordIq, OfAFullDiskTheRecordingIsKept) {
  const auto result =
      bench("record --iq", {kSmallScan, kTwoVolumes}, {.file_bytes = 1800000, .no_cache = true});
  expect_line(result, 1, "iq.npy: cannot be written: File too large; ");
  EXPECT_TRUE(holds(result.err, "out/recording.wbst.partial holds 1 whole volumes"));
  EXPECT_EQ(folder_.files("out"), Words{"recording.wbst.partial"});
  const auto none =
      bench("record --iq --out none", {kSmallScan}, {.file_bytes = 500000, .no_cache = true});
  expect_line(none, 1, "iq.npy: cannot be written: File too large; nothing is recorded");
  EXPECT_TRUE(folder_.files("none").empty());
}

TEST_F(RecordIq, IsRefusedInOneLine) {
  fs::create_directory(at("there"));
  folder_.write("there/iq.npy", "old");
  ASSERT_EQ(bench("record --out rec", {kSmallScan}).exit_code, 0);
  expect_refusals(
      {{"record --iq --set simulation.fidelity=geometry",
        "--iq: needs the rung field or higher; the rung is geometry, which makes no IQ"},
       {"record --iq --board file=rec/recording.wbst",
        "--iq: needs --board sim; --board = file=rec/recording.wbst sends detected"},
       {"record --iq --board xdma=/dev/none", "--iq: needs --board sim"},
       {"record --out there --replace",
        "--out = there: holds iq.npy of another recording; must be a folder without one"},
       {"record --out there --iq", "--out = there: holds iq.npy of another recording"}});
  EXPECT_EQ(folder_.files("there"), Words{"iq.npy"});
}

}  // namespace
}  // namespace wobblebench::bench
