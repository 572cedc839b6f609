// Files that cannot be read and drivers of OpenGL that are not there, by running the program.
#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::json;

using Surroundings = InFolder;

TEST_F(Surroundings, AFileThatCannotBeReadIsNotAnEmptyOne) {
  for (const Words& command : {Words{"phantom", "/proc/self/mem"},
                               Words{"run", "/proc/self/mem"},
                               Words{"trade", "/proc/self/mem"},
                               Words{"accuracy", "/proc/self/mem"}}) {
    expect_line(bench(with(command, {{"--out", "out"}})),
                1,
                "/proc/self/mem: cannot be read: Input/output error");
    EXPECT_FALSE(fs::exists(at("out"))) << command.front();
  }
}

TEST_F(Surroundings, AnUnknownDriverIsOneLine) {
  const auto result = bench("run --out out",
                            {kSphere, kScan, kPicture},
                            {.environment = {{"GALLIUM_DRIVER", "none_such"}}});
  expect_line(result, 1, "where GALLIUM_DRIVER = none_such");
}

TEST_F(Surroundings, ThePageIsOpenedAndDoesNotFailWhereNothingOpensIt) {
  folder_.write("xdg-open", "#!/bin/sh\nprintf %s \"$1\" >\"$OPENED\"\n");
  fs::permissions(at("xdg-open"), fs::perms::owner_all);
  const Words words = with(words_of("phantom --open --out out"), {kSphere});
  const std::string opened = at("opened").string();
  const auto result = bench(words,
                            {.environment = {{"PATH", folder_.path().string() + ":/usr/bin:/bin"},
                                             {"OPENED", opened},
                                             {"DISPLAY", ":0"}}});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  while (!fs::exists(opened) || fs::file_size(opened) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(fs::path(bytes_of(opened)), fs::weakly_canonical(at("out/report.html")));
  expect_line(bench(words, {.environment = {{"PATH", at("out").string()}, {"DISPLAY", ":0"}}}),
              0,
              "warning: --open: xdg-open cannot be started: ");
  folder_.write("xdg-open", "#!/bin/sh\nexit 3\n");
  const std::string path = folder_.path().string() + ":/usr/bin:/bin";
  expect_line(bench(words, {.environment = {{"PATH", path}, {"DISPLAY", ":0"}}}),
              0,
              "warning: --open: xdg-open failed: exit code 3; the page is ");
  expect_line(
      bench(words,
            {.environment =
                 {{"PATH", path}, {"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, {"BROWSER", ""}}}),
      0,
      "warning: --open: there is no desktop");
}

/// By the system, for want of memory, or the clock: the file may be good.
TEST_F(Surroundings, AReaderThatIsStoppedSaysNothingOfTheFile) {
  fs::copy_file(WOBBLEBENCH_PROGRAM, at("wobblebench"));
  folder_.write("ball.obj", "v 0 0 0\n");
  for (const std::string signal : {"KILL", "ALRM"}) {
    folder_.write("wobblebench-import", "#!/bin/sh\nkill -" + signal + " $$\n");
    fs::permissions(at("wobblebench-import"), fs::perms::owner_all);
    const auto result = run_process(
        at("wobblebench"),
        words_of("phantom --out out --set phantom.name=mesh --set phantom.file=ball.obj"),
        folder_.path());
    expect_line(result, 1, "ball.obj: could not be tried: ");
  }
}

/// The cache of shaders, which is Mesa's, and that of phantoms.
TEST_F(Surroundings, ARelativeCacheFolderIsIgnored) {
  const auto result =
      bench("run --out out",
            {kSphere, kScan, kPicture},
            {.environment = {{"XDG_CACHE_HOME", "cache"}, {"HOME", at("home").string()}},
             .no_cache = true});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder_.files(), (Words{"home", "out"}));
  EXPECT_EQ(folder_.files("home/.cache/wobblebench").size(), 3U)
      << "a phantom, its map and the echoes";
}

TEST_F(Surroundings, AFileSystemWithoutLocksIsWrittenAndThatIsSaid) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer replaces the same functions";
#endif
  for (const int reason : {ENOLCK, EOPNOTSUPP, ENOSYS, EIO}) {
    const std::string number = std::to_string(reason), cache = "cache" + number;
    const auto result = bench(with({"phantom", "--out", number}, {kSphere}),
                              {.environment = {{"LD_PRELOAD", WOBBLEBENCH_FAILING_CALLS},
                                               {"WOBBLEBENCH_FLOCK_ERRNO", number}},
                               .cache_home = at(cache).string()});
    if (reason == EIO) {
      expect_line(result, 2, "--out = 5: Input/output error; must be a folder");
      continue;
    }
    expect_line(result, 0, "warning: --out = " + number + ": its file system has no locks");
    EXPECT_EQ(folder_.files(number), (Words{"phantom.vdb", "report.html", "report.json"}));
    EXPECT_EQ(folder_.files(cache + "/wobblebench").size(), 1U);
  }
}

/// As after `ulimit -v`, of which the program's libraries need more or less, by the machine.
TEST_F(Surroundings, TooLittleAddressSpaceIsOneLineThatNamesTheLimit) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than there is memory";
#endif
  const std::string small = " --set phantom.name=sphere --set phantom.voxel_mm=2";
  ASSERT_EQ(bench("run --out scored", {kSphere, kScan, kPicture}).exit_code, 0);
  int failed = 0;
  for (const std::string& command :
       {"run" + small,
        "export sim --to out/scan.npz" + small,
        std::string("score scored/depth.exr --scene scored/report.json")}) {
    for (const char* const kilobytes : {"300000", "450000"}) {
      const std::string line =
          std::string("ulimit -v ") + kilobytes + " && exec " + WOBBLEBENCH_PROGRAM + " " + command;
      const auto result = run_process("/bin/sh", {"-c", line}, folder_.path());
      if (result.exit_code == 0) continue;
      ++failed;
      expect_line(result, 1, " MB (ulimit -v)");
      EXPECT_EQ(result.err.find("a fault of this program"), std::string::npos) << result.err;
      EXPECT_EQ(result.err.find("here: install"), std::string::npos) << result.err;
    }
  }
  EXPECT_GE(failed, 3);
}

TEST_F(Surroundings, WithoutThreadsItEndsWithOneLine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer replaces the same functions";
#endif
  const auto result = bench(Words{"--version"},
                            {.environment = {{"LD_PRELOAD", WOBBLEBENCH_FAILING_CALLS},
                                             {"WOBBLEBENCH_NO_THREADS", "1"}}});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err,
            "wobblebench: the system refuses a thread, a lock or memory: Resource temporarily "
            "unavailable\n");
}

TEST_F(Surroundings, TheCpuInThePlaceOfADeviceIsSaid) {
  const auto result = bench("run --gl egl-device --out out", {kSphere, kScan, kPicture});
  if (result.exit_code != 0) GTEST_SKIP() << "no EGL device: " << result.err;
  const Json report = json_of("out/report.json");
  const bool cpu = report["provenance"]["gl_renderer"].get<std::string>().find("llvmpipe") == 0;
  EXPECT_EQ(result.err.find("warning: --gl = egl-device") != std::string::npos, cpu) << result.err;
  EXPECT_EQ(report["warnings"].size(), cpu ? 1u : 0u);
}

}  // namespace
}  // namespace wobblebench::bench
