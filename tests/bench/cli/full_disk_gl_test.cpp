// Commands on a disk that is full: one line that names a file, and no half file.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// The limit holds for the file that takes stderr, too.
constexpr long kRoomForLines = 2000;

const Words kSmallRun = with(kSphere, {kScan, kPicture});

struct FullDiskCase {
  const char* name;
  Words words;            ///< OUT stands for the folder of the results
  int every = 1;          ///< n: the disk is full at every nth of the places
  std::string kept = {};  ///< matches names of files that may be there without the others
};

void PrintTo(const FullDiskCase& one, std::ostream* out) {
  *out << one.name;
}

/// Sizes of all files below, hidden ones too.
std::map<std::string, std::uintmax_t> files_below(const fs::path& folder) {
  std::map<std::string, std::uintmax_t> sizes;
  if (!fs::exists(folder)) return sizes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    sizes[entry.path().lexically_relative(folder).string()] = entry.file_size();
  }
  return sizes;
}

/// Whether equal commands write it with other bytes.
bool has_times(const std::string& file) {
  const std::string name = fs::path(file).filename().string();
  const Words with_times = {
      "ages.csv", "ages.vl.json", "recording.json", "spans.vl.json", "trace.json"};
  return name.starts_with("report.") || std::ranges::count(with_times, name) > 0;
}

class FullDisk : public testing::TestWithParam<FullDiskCase> {
 protected:
  FullDisk() {
    folder_.write("plan.toml",
                  "scenes = 1\n[scene]\nphantom = { name = \"sphere\", voxel_mm = 2 }\n"
                  "acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }\n"
                  "render.scan_conversion.slice_size = 64\n"
                  "render.ray_casting = { image_size = 64, steps = 64 }\n");
  }

  /// Without a cache, whose files the limit would meet, too.
  ProcessResult run(const std::string& out, std::optional<long> most = {}) const {
    Words words = GetParam().words;
    for (std::string& word : words) {
      if (word.starts_with("OUT")) word.replace(0, 3, out);
    }
    return bench(words, folder_, {.file_bytes = most, .no_cache = true});
  }

  /// What is left is whole, and all of it is there unless the command failed.
  void expect_no_half_file(const std::string& out,
                           bool failed,
                           const std::map<std::string, std::uintmax_t>& whole) const {
    const auto left = files_below(folder_.path() / out);
    for (const auto& [file, size] : left) {
      EXPECT_TRUE(whole.contains(file)) << file;
      EXPECT_TRUE(!failed || std::regex_match(file, std::regex(GetParam().kept))) << file;
      if (!whole.contains(file) || has_times(file)) continue;
      EXPECT_EQ(size, whole.at(file)) << file;
    }
    EXPECT_TRUE(failed || left.size() == whole.size());
  }

  ScratchFolder folder_;
};

/// The disk is full one byte, and a hundred, before the end of each file. Nothing may be left,
/// unless reports, whose sizes differ, are short enough to fit.
TEST_P(FullDisk, LeavesNoHalfFileAndIsOneLine) {
  const auto made = run("whole");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto whole = files_below(folder_.path() / "whole");
  std::set<long> limits = {0};
  for (const auto& [file, size] : whole) {
    for (const long missing : {1L, 100L}) limits.insert(static_cast<long>(size) - missing);
  }
  const std::regex line("wobblebench: (?!warning).*: cannot be written: File too large.*\n");
  int place = 0, runs = 0, failed = 0;
  for (const long bytes : limits) {
    if (place++ % GetParam().every != 0) continue;
    SCOPED_TRACE(std::to_string(bytes) + " bytes");
    const std::string out = "out" + std::to_string(bytes);
    const auto result = run(out, bytes);
    const bool has_failed = result.exit_code != 0;
    ++runs;
    failed += has_failed;
    expect_no_half_file(out, has_failed, whole);
    if (!has_failed || bytes < kRoomForLines) continue;
    EXPECT_EQ(result.exit_code, 1);
    const std::sregex_iterator found(result.err.begin(), result.err.end(), line), none;
    EXPECT_EQ(std::distance(found, none), 1) << result.err;
  }
  EXPECT_GE(failed, runs - 4) << "all but those about the reports";
}

INSTANTIATE_TEST_SUITE_P(
    Of,
    FullDisk,
    testing::Values(
        FullDiskCase{"run", with({"run", "--out", "OUT"}, {kSmallRun}), 3},
        FullDiskCase{"phantom", with({"phantom", "--out", "OUT"}, {kSphere})},
        FullDiskCase{
            "stream",
            with({"stream", "--policy", "every", "--volumes", "2", "--trace", "--out", "OUT"},
                 {kSmallRun}),
            4},
        FullDiskCase{"export",
                     with({"export",
                           "sim",
                           "--to",
                           "OUT/scan.npz",
                           "--to",
                           "OUT/scan.mha",
                           "--to",
                           "OUT/scan.nrrd",
                           "--to",
                           "OUT/scan.vol",
                           "--to",
                           "OUT/scan.ply"},
                          {kSmallRun}),
                     5},
        FullDiskCase{"dataset",
                     {"dataset", "plan.toml", "--out", "OUT"},
                     8,
                     "dataset.json|scenes/000000/.*"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace wobblebench::bench
