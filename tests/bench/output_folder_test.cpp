#include "bench/output_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "bench/user_error.h"
#include "support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::ScratchFolder;
using Names = std::vector<std::string>;

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(OutputFolder, NothingHasItsNameBeforeCommitAndEverythingAfter) {
  const ScratchFolder scratch;
  OutputFolder out(scratch.path() / "a" / "b");
  out.write_text("one.txt", "1");
  out.write_text("two.txt", "2");
  for (const auto& name : scratch.files("a/b")) EXPECT_TRUE(name.starts_with(".partial-")) << name;
  out.commit();
  EXPECT_EQ(scratch.files("a/b"), (Names{"one.txt", "two.txt"}));
  EXPECT_EQ(text_of(scratch.path() / "a/b/two.txt"), "2");
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
  EXPECT_EQ(text_of(scratch.path() / "kept.txt"), "old");
}

TEST(OutputFolder, RefusesWhatIsNoFolder) {
  const ScratchFolder scratch;
  const auto file = scratch.write("file", "");
  EXPECT_THROW(OutputFolder{file}, UserError);
  EXPECT_THROW(OutputFolder{file / "below"}, UserError);
}

}  // namespace
}  // namespace wobblebench::bench
