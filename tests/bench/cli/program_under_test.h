// The program as the tests of its commands run it, and scenes that are small enough for them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {

using testing_support::bytes_of;
using testing_support::ProcessLimits;
using testing_support::ProcessResult;
using testing_support::run_process;
using testing_support::ScratchFolder;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

/// "a.b=1 c.d=2" as {"--set", "a.b=1", "--set", "c.d=2"}.
inline Words set(const std::string& settings) {
  Words words;
  for (const std::string& setting : words_of(settings)) {
    words.insert(words.end(), {"--set", setting});
  }
  return words;
}

inline const Words kSphere = set("phantom.name=sphere phantom.voxel_mm=2");
inline const Words kScan = set("acquisition.frames_per_volume=9 acquisition.sticks_per_frame=16");
inline const Words kPicture =
    set("render.scan_conversion.slice_size=64 render.ray_casting.image_size=64 "
        "render.ray_casting.steps=64");

/// One list after the other.
inline Words with(Words words, const std::vector<Words>& more) {
  for (const Words& part : more) words.insert(words.end(), part.begin(), part.end());
  return words;
}

/// `wobblebench ARGUMENTS…` in that folder.
inline ProcessResult bench(const Words& arguments,
                           const ScratchFolder& folder,
                           const ProcessLimits& limits = {}) {
  return run_process(WOBBLEBENCH_PROGRAM, arguments, folder.path(), limits);
}

/// The folder "out" of a command that is run once for all tests of a process. `files`: what it
/// reads.
inline fs::path result_of(const Words& command,
                          const std::map<std::string, std::string>& files = {}) {
  static std::map<std::pair<Words, std::map<std::string, std::string>>, const ScratchFolder> made;
  const auto [found, is_new] = made.try_emplace({command, files});
  const ScratchFolder& folder = found->second;
  if (is_new) {
    for (const auto& [name, text] : files) folder.write(name, text);
    const ProcessResult result = bench(command, folder);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  return folder.path() / "out";
}

/// A recording of the small sphere.
inline fs::path recorded(int volumes) {
  return result_of(with({"record", "--volumes", std::to_string(volumes)}, {kSphere, kScan}));
}

inline void expect_line(const ProcessResult& result, int code, const std::string& text) {
  EXPECT_EQ(result.exit_code, code) << result.err;
  EXPECT_TRUE(holds(result.err, text));
}

/// One line that holds `text`, and exit code 2.
inline void expect_refused(const ProcessResult& result, const std::string& text) {
  expect_line(result, 2, text);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
}

/// A wrong command line, and what the line that refuses it holds.
struct RefusedLine {
  RefusedLine(const char* line, std::string said) : words(words_of(line)), text(std::move(said)) {}
  RefusedLine(Words line, std::string said) : words(std::move(line)), text(std::move(said)) {}

  Words words;
  std::string text;
};

/// What a command printed that was given --json; it must have succeeded.
inline nlohmann::json report_of(const ProcessResult& result) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out, nullptr, /*allow_exceptions=*/false);
}

/// Runs the program in a folder of the test's own.
class InFolder : public testing::Test {
 protected:
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  nlohmann::json json_of(const std::string& name) const {
    return nlohmann::json::parse(bytes_of(at(name)));
  }
  ProcessResult bench(const Words& arguments, const ProcessLimits& limits = {}) const {
    return run_process(WOBBLEBENCH_PROGRAM, arguments, folder_.path(), limits);
  }
  ProcessResult bench(const std::string& line,
                      const std::vector<Words>& more = {},
                      const ProcessLimits& limits = {}) const {
    return bench(with(words_of(line), more), limits);
  }
  /// Each is refused by one line, and leaves no folder "out".
  void expect_refusals(const std::vector<RefusedLine>& refusals) const {
    for (const RefusedLine& one : refusals) {
      SCOPED_TRACE(::testing::PrintToString(one.words));
      expect_refused(bench(one.words), one.text);
      EXPECT_FALSE(fs::exists(at("out")));
    }
  }

  ScratchFolder folder_;
};

}  // namespace wobblebench::bench
