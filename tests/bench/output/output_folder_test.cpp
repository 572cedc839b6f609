#include "bench/output/output_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include "base/user_error.h"
#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
#include "tests/support/file_limit.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::bytes_of;
using testing_support::ScratchFolder;
using Names = std::vector<std::string>;

TEST(OutputFolder, NothingHasItsNameBeforeCommitAndEverythingAfter) {
  const ScratchFolder scratch;
  OutputFolder out(scratch.path() / "a" / "b");
  out.write_text("one.txt", "1");
  out.write_text("two.txt", "2");
  for (const auto& name : scratch.files("a/b")) EXPECT_TRUE(name.starts_with(".")) << name;
  out.commit();
  EXPECT_EQ(scratch.files("a/b"), (Names{".wobblebench.lock", "one.txt", "two.txt"}));
  EXPECT_EQ(bytes_of(scratch.path() / "a/b/two.txt"), "2");
}

TEST(OutputFolder, WithoutCommitNothingIsLeftAndTheOldStays) {
  const ScratchFolder scratch;
  scratch.write("kept.txt", "old");
  {
    OutputFolder out(scratch.path());
    out.write_text("kept.txt", "new");
    out.write_text("other.txt", "new");
  }
  EXPECT_EQ(scratch.files(), Names{"kept.txt"});
  EXPECT_EQ(bytes_of(scratch.path() / "kept.txt"), "old");
}

TEST(OutputFolder, FoldersThatItMadeGoWithTheirContents) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch.path() / "there");
  {
    OutputFolder out(scratch.path() / "there" / "new" / "newer");
    out.write_text("one", "1");
  }
  EXPECT_EQ(scratch.files(), Names{"there"});
  EXPECT_EQ(scratch.files("there"), Names{});
}

TEST(OutputFolder, TakesOneCommandAtATime) {
  const ScratchFolder scratch;
  {
    const OutputFolder out(scratch.path());
    EXPECT_THROW(OutputFolder{scratch.path()}, UserError);
  }
  EXPECT_EQ(scratch.files(), Names{});
  OutputFolder out(scratch.path());
}

TEST(OutputFolder, CompletesOrRemovesWhatAKilledCommandLeft) {
  const ScratchFolder scratch;
  scratch.write("one", "old");
  scratch.write(".wobblebench.lock", "");
  std::filesystem::create_directory(scratch.path() / ".wobblebench-commit");
  scratch.write(".wobblebench-commit/one", "new");
  std::filesystem::create_directory(scratch.path() / ".wobblebench-partial");
  scratch.write(".wobblebench-partial/two", "half");
  { const OutputFolder out(scratch.path()); }
  EXPECT_EQ(scratch.files(), Names{"one"});
  EXPECT_EQ(bytes_of(scratch.path() / "one"), "new");
}

TEST(OutputFolder, RefusesWhatIsNoFolder) {
  const ScratchFolder scratch;
  const auto file = scratch.write("file", "");
  EXPECT_THROW(OutputFolder{file}, UserError);
  EXPECT_THROW(OutputFolder{file / "below"}, UserError);
}

TEST(OutputFolder, NamesTheLinkThatLeadsToNoFolder) {
  const ScratchFolder scratch;
  const auto link = scratch.path() / "link";
  std::filesystem::create_symlink("gone", link);
  for (const auto& out : {link, link / "below"}) {
    try {
      const OutputFolder folder(out);
      ADD_FAILURE() << out;
    } catch (const UserError& error) {
      EXPECT_EQ(error.what(),
                "--out = " + out.string() + ": " + link.string() +
                    " is a symbolic link to gone, which leads to no folder; must be a folder that "
                    "can be written");
    }
  }
  EXPECT_EQ(scratch.files(), Names{"link"});
}

TEST(OutputFolder, AFullDiskIsSaidHoweverLate) {
  const ScratchFolder scratch;
  OutputFolder out(scratch.path());
  const std::string text(10000, 'x');
  for (const std::size_t missing : {std::size_t{1}, std::size_t{100}, text.size()}) {
    const testing_support::FileLimit limit(text.size() - missing);
    EXPECT_THROW(out.write_text("text", text), std::runtime_error) << missing;
  }
}

TEST(OutputFolder, NothingIsRenamedWhenAFolderIsInTheWay) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch.path() / "two");
  {
    OutputFolder out(scratch.path());
    out.write_text("one", "1");
    out.write_text("two", "2");
    EXPECT_THROW(out.commit(), std::runtime_error);
  }
  EXPECT_EQ(scratch.files(), Names{"two"});
}

/// A folder of somebody else, and what may be planted in a command's folder while it works.
class PlantedFolder : public testing::Test {
 protected:
  PlantedFolder() {
    std::filesystem::create_directory(at("out"));
    std::filesystem::create_directory(at("victim"));
    scratch_.write("victim/report.json", "precious");
    scratch_.write("victim/thesis.tex", "precious");
    scratch_.write("out/report.json", "old");
  }
  std::filesystem::path at(const std::string& name) const { return scratch_.path() / name; }
  void expect_victim_untouched() const {
    EXPECT_EQ(scratch_.files("victim"), (Names{"report.json", "thesis.tex"}));
    EXPECT_EQ(bytes_of(at("victim/report.json")), "precious");
    EXPECT_EQ(bytes_of(at("out/report.json")), "old");
  }
  /// Puts a link to the victim in the place of the folder that the command has made.
  void plant() const {
    std::filesystem::rename(at("out/.wobblebench-partial"), at("out/.moved"));
    std::filesystem::create_directory_symlink(at("victim"), at("out/.wobblebench-partial"));
  }

  const ScratchFolder scratch_;
};

TEST_F(PlantedFolder, BeforeAFileIsStagedItIsRefused) {
  {
    OutputFolder out(at("out"));
    plant();
    EXPECT_THROW(out.write_text("report.json", "new"), std::runtime_error);
  }
  expect_victim_untouched();
}

TEST_F(PlantedFolder, AfterAFileIsStagedItIsRefused) {
  {
    OutputFolder out(at("out"));
    out.write_text("report.json", "new");
    plant();
    EXPECT_THROW(out.commit(), std::runtime_error);
  }
  expect_victim_untouched();
}

TEST_F(PlantedFolder, LinksAndFilesWithinItAreRefused) {
  for (const char* name : {"report.json", "thesis.tex"}) {
    {
      OutputFolder out(at("out"));
      const auto planted = at("out/.wobblebench-partial") / name;
      std::filesystem::create_symlink(at("victim") / name, planted);
      EXPECT_THROW(
          {
            out.write_text("report.json", "new");
            out.commit();
          },
          std::runtime_error)
          << name;
      std::filesystem::remove(planted);
    }
    expect_victim_untouched();
  }
}

TEST_F(PlantedFolder, OfACommittedCommandALinkIsRefused) {
  std::filesystem::create_directory_symlink(at("victim"), at("out/.wobblebench-commit"));
  EXPECT_THROW(OutputFolder{at("out")}, UserError);
  expect_victim_untouched();
}

/// As before the first command: the link goes, what it leads to stays.
TEST_F(PlantedFolder, OfAKilledCommandALinkIsRemoved) {
  std::filesystem::create_directory_symlink(at("victim"), at("out/.wobblebench-partial"));
  { const OutputFolder out(at("out")); }
  EXPECT_EQ(scratch_.files("out"), Names{"report.json"});
  expect_victim_untouched();
}

TEST(OutputFolder, WhatCannotBeMovedIsMovedByTheNextCommandAndThatIsSaid) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch.path() / ".wobblebench-commit");
  scratch.write(".wobblebench-commit/one", "new");
  std::filesystem::create_directory(scratch.path() / "one");
  EXPECT_TRUE(holds(refusal_of<std::runtime_error>([&] { const OutputFolder out(scratch.path()); }),
                    "the next command with this folder"));
  EXPECT_EQ(bytes_of(scratch.path() / ".wobblebench-commit/one"), "new");
  std::filesystem::remove(scratch.path() / "one");
  { const OutputFolder out(scratch.path()); }
  EXPECT_EQ(scratch.files(), Names{"one"});
  EXPECT_EQ(bytes_of(scratch.path() / "one"), "new");
}

TEST(OutputFolder, ADiskWithoutRoomIsSaidBeforeAnythingIsWritten) {
  const ScratchFolder scratch;
  const OutputFolder out(scratch.path());
  EXPECT_NO_THROW(out.check_space(1));
  EXPECT_THROW(out.check_space(std::uint64_t{1} << 60), std::runtime_error);
}

enum class SignalReaches { any_thread, another_thread };

/// In a process of its own: commits many files while a second thread sends SIGTERM to the process.
void commit_under_fire(const std::filesystem::path& directory, SignalReaches reaches) {
  OutputFolder out(directory);
  // Not write_text, which waits for the disk.
  for (int i = 0; i < 60; ++i) std::ofstream(out.stage(std::to_string(i))) << "x";
  std::atomic<bool> ready = false, committing = false;
  std::thread sender([&] {
    ready = true;
    while (!committing) {
    }
    ::kill(::getpid(), SIGTERM);
  });
  if (reaches == SignalReaches::another_thread) {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
  }
  while (!ready) {
  }
  committing = true;
  out.commit();
  sender.join();
}

TEST(OutputFolder, ASignalDuringCommitLeavesAllFilesOrNone) {
  for (const auto reaches : {SignalReaches::any_thread, SignalReaches::another_thread}) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      const ScratchFolder scratch;
      const pid_t child = ::fork();
      if (child == 0) {
        commit_under_fire(scratch.path(), reaches);
        ::_exit(0);
      }
      ::waitpid(child, nullptr, 0);
      const auto count = scratch.files().size();
      EXPECT_TRUE(count == 0 || count == 60) << count;
    }
  }
}

}  // namespace
}  // namespace wobblebench::bench
