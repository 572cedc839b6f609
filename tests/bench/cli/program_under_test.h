// The program as the tests of its commands run it, and scenes that are small enough for them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/bytes_of.h"
#include "tests/support/process.h"

namespace wobblebench::bench {

using testing_support::bytes_of;
using testing_support::ProcessLimits;
using testing_support::ProcessResult;
using testing_support::run_process;
using testing_support::ScratchFolder;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

inline const Words kSphere = {"--set", "phantom.name=sphere", "--set", "phantom.voxel_mm=2"};
inline const Words kScan = {
    "--set", "acquisition.frames_per_volume=9", "--set", "acquisition.sticks_per_frame=16"};
inline const Words kPicture = {"--set",
                               "render.scan_conversion.slice_size=64",
                               "--set",
                               "render.ray_casting.image_size=64",
                               "--set",
                               "render.ray_casting.steps=64"};

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

}  // namespace wobblebench::bench
