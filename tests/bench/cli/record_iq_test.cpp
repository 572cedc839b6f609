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
const Words kSmallScan = with({}, {kSphere, kScan, {"--set", "acquisition.samples_per_stick=128"}});
const Words kTwoVolumes = {"--volumes", "2", "--set", "acquisition.motor=alternating"};

std::string at(const ScratchFolder& folder, const std::string& name) {
  return bytes_of(folder.path() / name);
}

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

TEST(RecordIq, DetectedItIsTheRecording) {
  const ScratchFolder folder;
  const auto result = bench(with({"record", "--iq", "--json"}, {kSmallScan, kTwoVolumes}), folder);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder.files("out"),
            (Words{"iq.npy", "recording.json", "recording.wbst", "report.html", "report.json"}));
  const Json iq = Json::parse(result.out).at("iq");
  const std::vector<std::size_t> shape = iq.at("shape");
  ASSERT_EQ(shape.size(), 4U);
  EXPECT_EQ(std::vector(shape.begin(), shape.end() - 1), (std::vector<std::size_t>{2, 9, 16}));
  EXPECT_NEAR(iq.at("sample_spacing_mm"), 160.0 / static_cast<double>(shape[3]), 1e-12);
  EXPECT_EQ(iq.at("center_frequency_mhz"), 3.5);
  const std::string array = at(folder, "out/iq.npy"), bytes = at(folder, "out/recording.wbst");
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

TEST(RecordIq, LeavesTheRecordingAsItIs) {
  const ScratchFolder folder;
  ASSERT_EQ(bench(with({"record", "--iq", "--out", "a"}, {kSmallScan}), folder).exit_code, 0);
  const auto plain = bench(with({"record", "--out", "b", "--json"}, {kSmallScan}), folder);
  EXPECT_EQ(at(folder, "a/recording.wbst"), at(folder, "b/recording.wbst"));
  EXPECT_EQ(folder.files("b"),
            (Words{"recording.json", "recording.wbst", "report.html", "report.json"}));
  EXPECT_TRUE(Json::parse(plain.out).at("iq").is_null());
}

TEST(RecordIq, IsWhatWasEmittedWhateverTheLinkLoses) {
  const ScratchFolder folder;
  ASSERT_EQ(bench(with({"record", "--iq", "--out", "whole"}, {kSmallScan}), folder).exit_code, 0);
  const std::string whole = at(folder, "whole/iq.npy");
  for (const std::string fault : {"drop:0.05+corrupt:0.05+seed:2", "unplug@60"}) {
    const auto result =
        bench(with({"record", "--iq", "--out", "lossy" + fault, "--board", "sim,faults=" + fault},
                   {kSmallScan}),
              folder);
    EXPECT_EQ(result.exit_code, fault.starts_with("unplug") ? 1 : 0) << result.err;
    const auto report = Json::parse(at(folder, "lossy" + fault + "/report.json"));
    EXPECT_LT(report.at("board").at("delivered"), 9 * 16);
    EXPECT_TRUE(at(folder, "lossy" + fault + "/iq.npy") == whole) << fault;
  }
}

/// A volume has 1.2 MB of IQ samples, and 0.08 MB of the recording.
TEST(RecordIq, OfAFullDiskTheRecordingIsKept) {
  const ScratchFolder folder;
  const auto result = bench(with({"record", "--iq"}, {kSmallScan, kTwoVolumes}),
                            folder,
                            {.file_bytes = 1800000, .no_cache = true});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("iq.npy: cannot be written: File too large; "), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("out/recording.wbst.partial holds 1 whole volumes"), std::string::npos)
      << result.err;
  EXPECT_EQ(folder.files("out"), Words{"recording.wbst.partial"});
  const auto none = bench(with({"record", "--iq", "--out", "none"}, {kSmallScan}),
                          folder,
                          {.file_bytes = 500000, .no_cache = true});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.err.find("iq.npy: cannot be written: File too large; nothing is recorded"),
            std::string::npos)
      << none.err;
  EXPECT_TRUE(folder.files("none").empty());
}

struct Refused {
  std::string name;
  Words arguments;
  std::string message;
};

class RecordIqRefuses : public testing::TestWithParam<Refused> {};

TEST_P(RecordIqRefuses, InOneLine) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "there");
  folder.write("there/iq.npy", "old");
  ASSERT_EQ(bench(with({"record", "--out", "rec"}, {kSmallScan}), folder).exit_code, 0);
  const auto result = bench(with({"record"}, {GetParam().arguments}), folder);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find(GetParam().message), std::string::npos) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
  EXPECT_EQ(folder.files("there"), Words{"iq.npy"});
}

INSTANTIATE_TEST_SUITE_P(
    Each,
    RecordIqRefuses,
    testing::Values(
        Refused{"geometry",
                {"--iq", "--set", "simulation.fidelity=geometry"},
                "--iq: needs the rung field or higher; the rung is geometry, which makes no IQ"},
        Refused{"recording",
                {"--iq", "--board", "file=rec/recording.wbst"},
                "--iq: needs --board sim; --board = file=rec/recording.wbst sends detected"},
        Refused{"card", {"--iq", "--board", "xdma=/dev/none"}, "--iq: needs --board sim"},
        Refused{"of_another_recording",
                {"--out", "there", "--replace"},
                "--out = there: holds iq.npy of another recording; must be a folder without one"},
        Refused{"without_replace",
                {"--out", "there", "--iq"},
                "--out = there: holds iq.npy of another recording"}),
    [](const auto& refused) { return refused.param.name; });

}  // namespace
}  // namespace wobblebench::bench
