// What a scene costs, against what it takes.
#include "bench/scene/scene_cost.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "base/user_error.h"
#include "tests/support/expect.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

namespace fs = std::filesystem;
using testing_support::ScratchFolder;

/// Largest resident size of `wobblebench run` of these settings.
double peak_bytes(const std::vector<std::string>& settings) {
  const ScratchFolder folder;
  std::vector<std::string> words = {WOBBLEBENCH_PROGRAM, "run", "--out", folder.path().string()};
  for (const auto& setting : settings) words.insert(words.end(), {"--set", setting});
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(WOBBLEBENCH_PROGRAM, arguments.data());
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  EXPECT_EQ(status, 0);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

class MemoryOfRun : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(MemoryOfRun, IsEstimatedWithinAFactorOfTwo) {
  const double estimate = memory_need(load_scene({}, GetParam())).of_run();
  const double measured = peak_bytes(GetParam());
  EXPECT_GT(estimate, measured / 2) << measured / 1e9 << " GB measured";
  EXPECT_LT(estimate, measured * 2) << measured / 1e9 << " GB measured";
}

INSTANTIATE_TEST_SUITE_P(
    Scenes,
    MemoryOfRun,
    testing::Values(std::vector<std::string>{"phantom.voxel_mm=1"},
                    std::vector<std::string>{"phantom.name=sphere", "phantom.voxel_mm=0.25"},
                    words_of("phantom.name=plane phantom.voxel_mm=1 "
                             "render.ray_casting.image_size=1536 render.ray_casting.steps=32")));

std::string refusal_of_run(const std::vector<std::string>& settings, double available) {
  return refusal_of<UserError>([&] { check_memory_of_run(load_scene({}, settings), available); });
}

TEST(MemoryOfRun, TooMuchIsALineThatNamesItsKey) {
  EXPECT_EQ(refusal_of_run({}, 4e9), "");
  EXPECT_EQ(
      refusal_of_run({"phantom.voxel_mm=0.1"}, 4e9).find("phantom.voxel_mm = 0.1: need about"), 0u);
  EXPECT_EQ(refusal_of_run({"phantom.name=sphere", "render.ray_casting.image_size=4096"}, 2e9)
                .find("render.ray_casting.image_size = 4096: need about"),
            0u);
}

class AvailableMemory : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_.path() / name).parent_path());
    root_.write(name, text);
  }
  ScratchFolder root_;
};

TEST_F(AvailableMemory, IsThatOfTheMachineWithoutALimit) {
  EXPECT_GT(available_memory_bytes(root_.path()), 1e8);
  write("proc/self/cgroup", "0::/\n");
  write("sys/fs/cgroup/memory.max", "max\n");
  EXPECT_GT(available_memory_bytes(root_.path()), 1e8);
}

TEST_F(AvailableMemory, IsTheLeastLimitOfTheControlGroups) {
  write("proc/self/cgroup", "0::/a/b\n");
  write("sys/fs/cgroup/a/b/memory.max", "max\n");
  write("sys/fs/cgroup/a/memory.max", "50000000\n");
  EXPECT_EQ(available_memory_bytes(root_.path()), 5e7);
  write("proc/self/cgroup", "7:cpu:/x\n4:blkio,memory:/c\n");
  write("sys/fs/cgroup/memory/c/memory.limit_in_bytes", "40000000\n");
  EXPECT_EQ(available_memory_bytes(root_.path()), 4e7);
}

}  // namespace
}  // namespace wobblebench::bench
