// record and salvage with each call failing, and killed at each call: what was there before, or the
// whole new files, and no packet lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

/// The length of the whole packets at the start of `stream`, by the header alone:
/// docs/wire_format.md has the payload's length at byte 8, after a header of 64.
std::size_t whole_packets(const std::string& stream) {
  std::size_t end = 0;
  while (stream.size() - end >= 64) {
    std::uint32_t payload = 0;
    std::memcpy(&payload, stream.data() + end + 8, sizeof payload);
    if (stream.size() - end < 64 + payload) break;
    end += 64 + payload;
  }
  return end;
}

class FailingCalls : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer replaces the same functions";
#endif
    const auto record = [&](const std::string& seed, const std::string& folder) {
      const Words scan = {"--set",
                          "acquisition.frames_per_volume=2",
                          "--set",
                          "acquisition.sticks_per_frame=4",
                          "--set",
                          "simulation.seed=" + seed};
      return bench(with({"record", "--out", folder, "--volumes", "2"}, {kSphere, scan}));
    };
    ASSERT_EQ(record("1", "source").exit_code, 0);
    ASSERT_EQ(record("2", "old").exit_code, 0);
    source_ = bytes_of(at("source/recording.wbst"));
    old_ = bytes_of(at("old/recording.wbst"));
    ASSERT_EQ(whole_packets(source_), source_.size());
    ASSERT_NE(source_, old_);
  }

  fs::path at(const std::string& name) const {
    return folder_.path() / name;
  }

  ProcessResult bench(const Words& arguments, const ProcessLimits& limits = {}) const {
    return run_process(WOBBLEBENCH_PROGRAM, arguments, folder_.path(), limits);
  }

  /// Runs the command for each call of that kind until there are no more; after each, `check`.
  template <class Prepare, class Check>
  void each(const std::string& kind,
            const std::string& action,
            const Words& command,
            const Prepare& prepare,
            const Check& check) {
    const bool sample = kind == "allocate";
    for (long n = 1;; n += sample ? n / 3 + 1 : 1) {
      prepare();
      fs::remove(at("reached"));
      ProcessLimits limits;
      limits.no_cache = true;  // only the command's own calls are counted
      limits.environment = {{"LD_PRELOAD", WOBBLEBENCH_FAILING_CALLS},
                            {"WOBBLEBENCH_FAIL", kind + ":" + std::to_string(n) + ":" + action},
                            {"WOBBLEBENCH_FAIL_REACHED", at("reached").string()}};
      const ProcessResult result = bench(command, limits);
      SCOPED_TRACE(kind + " " + std::to_string(n) + " " + action + ": " + result.err);
      const bool reached = fs::exists(at("reached"));
      if (action == "kill" && reached) {
        EXPECT_EQ(result.exit_code, 128 + SIGKILL);
      } else if (kind != "allocate") {
        // nlohmann's JSON crashes where its memory fails; nothing may be lost by that, either.
        EXPECT_LE(result.exit_code, 2);
      }
      check(result);
      if (HasFailure()) return;
      if (!reached) {
        EXPECT_GT(n, 1) << "no such call";
        return;
      }
    }
  }

  void record_into_a_used_folder(const std::string& kind, const std::string& action) {
    const Words command = {
        "record", "--board", "file=source/recording.wbst", "--out", "out", "--replace"};
    const auto prepare = [&] {
      fs::remove_all(at("out"));
      fs::copy(at("old"), at("out"));
    };
    each(kind, action, command, prepare, [&](const ProcessResult& result) {
      const std::string recording = bytes_of(at("out/recording.wbst"));
      EXPECT_TRUE(recording == source_ || recording == old_) << "neither the old nor the new one";
      if (result.exit_code == 0) {
        EXPECT_EQ(recording, source_);
        EXPECT_EQ(folder_.files("out"),
                  (Words{"recording.json", "recording.wbst", "report.html", "report.json"}));
        return;
      }
      salvage_partial();
      const auto again = bench(command);
      EXPECT_EQ(again.exit_code, 0) << again.err;
      EXPECT_EQ(folder_.files("out"),
                (Words{"recording.json", "recording.wbst", "report.html", "report.json"}));
      EXPECT_EQ(bytes_of(at("out/recording.wbst")), source_);
    });
  }

  /// Salvages out/recording.wbst.partial, if there is one that holds a packet, and removes it.
  void salvage_partial() {
    const std::string partial = bytes_of(at("out/recording.wbst.partial"));
    EXPECT_EQ(partial, source_.substr(0, partial.size())) << "bytes are missing, or others";
    const std::size_t whole = whole_packets(partial);
    fs::remove(at("saved.wbst"));
    if (whole > 0) {
      const auto salvaged =
          bench({"inspect", "out/recording.wbst.partial", "--salvage", "saved.wbst"});
      EXPECT_NE(salvaged.exit_code, 2) << salvaged.err;
      EXPECT_EQ(bytes_of(at("saved.wbst")), source_.substr(0, whole));
    }
    fs::remove(at("out/recording.wbst.partial"));
  }

  void salvage(const std::string& kind, const std::string& action) {
    const std::string torn = source_.substr(0, source_.size() - 100);
    const std::string wanted = source_.substr(0, whole_packets(torn));
    folder_.write("torn.wbst", torn);
    const Words command = {"inspect", "torn.wbst", "--salvage", "saved/new.wbst"};
    each(
        kind,
        action,
        command,
        [&] { fs::remove_all(at("saved")); },
        [&](const ProcessResult&) {
          EXPECT_EQ(bytes_of(at("torn.wbst")), torn);
          // The second time it may find the file, which the first had begun to move.
          if (folder_.files("saved") != Words{"new.wbst"}) {
            EXPECT_GE(bench(command).exit_code, 1);
          }
          EXPECT_EQ(folder_.files("saved"), Words{"new.wbst"});
          EXPECT_EQ(bytes_of(at("saved/new.wbst")), wanted);
        });
  }

  ScratchFolder folder_;
  std::string source_;  ///< what record reads and writes
  std::string old_;     ///< what was there before
};

class EachCall : public FailingCalls, public testing::WithParamInterface<const char*> {};

TEST_P(EachCall, FailingInRecordLosesNothing) {
  record_into_a_used_folder(GetParam(), "fail");
}

INSTANTIATE_TEST_SUITE_P(Of,
                         EachCall,
                         testing::Values("open", "write", "rename", "sync", "link", "allocate"),
                         [](const auto& test) { return std::string(test.param); });

class EachCallOfSalvage : public FailingCalls, public testing::WithParamInterface<const char*> {};

TEST_P(EachCallOfSalvage, FailingLosesNothing) {
  salvage(GetParam(), "fail");
}

INSTANTIATE_TEST_SUITE_P(Of,
                         EachCallOfSalvage,
                         testing::Values("open", "write", "rename", "sync", "allocate"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(FailingCalls, KilledAtAnyCallRecordLosesNoPacket) {
  record_into_a_used_folder("any", "kill");
}

TEST_F(FailingCalls, KilledAtAnyCallSalvageLosesNothing) {
  salvage("any", "kill");
}

}  // namespace
}  // namespace wobblebench::bench
