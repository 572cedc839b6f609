#include "bench/cache/blob_cache.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "tests/support/bytes_of.h"
#include "tests/support/file_limit.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

namespace fs = std::filesystem;
using testing_support::bytes_of;
using testing_support::FileLimit;

constexpr std::uint64_t kRoomy = 1000000;

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

class BlobCacheTest : public testing_support::FolderTest {
 protected:
  std::string loaded(const std::string& key) const { return cache_.load(key).value_or("nothing"); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(cache_.folder()), fs::directory_iterator()));
  }

  BlobCache cache_{folder_ / "deep" / "kept", kRoomy};
};

TEST_F(BlobCacheTest, FindsWhatWasStoredUnderItsKeyAlone) {
  const std::string bytes("with \0 in it", 12);
  EXPECT_EQ(loaded("a"), "nothing");
  EXPECT_TRUE(cache_.store("a", bytes));
  EXPECT_TRUE(cache_.store("b", ""));
  EXPECT_EQ(loaded("a"), bytes);
  EXPECT_EQ(loaded("b"), "");
  EXPECT_EQ(loaded("c"), "nothing");
  EXPECT_TRUE(cache_.store("a", "another"));
  EXPECT_EQ(loaded("a"), "another");
  EXPECT_EQ(files(), 2U);
}

TEST_F(BlobCacheTest, AnEntryOfAnotherKeyIsNone) {
  ASSERT_TRUE(cache_.store("a", "bytes"));
  fs::rename(cache_.path_of("a"), cache_.path_of("b"));
  EXPECT_EQ(loaded("b"), "nothing");
}

TEST_F(BlobCacheTest, NoFlippedBitAndNoOtherLengthIsTaken) {
  ASSERT_TRUE(cache_.store("key", "some bytes that are kept"));
  const std::string whole = bytes_of(cache_.path_of("key"));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    write_text(cache_.path_of("key"), damaged);
    EXPECT_EQ(loaded("key"), "nothing") << "bit " << bit;
  }
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_text(cache_.path_of("key"), whole.substr(0, size));
    EXPECT_EQ(loaded("key"), "nothing") << size << " bytes";
  }
  write_text(cache_.path_of("key"), whole + "x");
  EXPECT_EQ(loaded("key"), "nothing");
  EXPECT_TRUE(cache_.store("key", "made anew"));
  EXPECT_EQ(loaded("key"), "made anew");
}

TEST_F(BlobCacheTest, WhatIsNoPlainFileIsNone) {
  ASSERT_TRUE(cache_.store("key", "bytes"));
  const fs::path path = cache_.path_of("key");
  fs::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(loaded("key"), "nothing");
  fs::remove(path);
  fs::create_directory(path);
  EXPECT_EQ(loaded("key"), "nothing");
}

TEST_F(BlobCacheTest, WhatWasNotUsedForTheLongestTimeGoesFirst) {
  const BlobCache small(cache_.folder(), 5000);
  const auto now = fs::file_time_type::clock::now();
  for (int i = 0; i < 4; ++i) {
    const std::string key = std::to_string(i);
    ASSERT_TRUE(small.store(key, std::string(1000, 'x')));
    fs::last_write_time(small.path_of(key), now - std::chrono::hours(10 - i));
  }
  EXPECT_TRUE(small.load("0")) << "used again now";
  ASSERT_TRUE(small.store("large", std::string(2500, 'x')));
  EXPECT_TRUE(small.load("0"));
  EXPECT_FALSE(small.load("1"));
  EXPECT_FALSE(small.load("2"));
  EXPECT_TRUE(small.load("3"));
  EXPECT_FALSE(small.store("too large", std::string(5000, 'x')));
  EXPECT_TRUE(small.load("large"));
}

TEST_F(BlobCacheTest, HalfEntriesOfDeadWritersCountAndGo) {
  const BlobCache small(cache_.folder(), 5000);
  ASSERT_TRUE(small.store("a", "bytes"));
  const fs::path half = small.path_of("b").string() + ".1-0";
  write_text(half, std::string(4000, 'x'));
  fs::last_write_time(half, fs::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_FALSE(small.load("b"));
  ASSERT_TRUE(small.store("c", std::string(2000, 'x')));
  EXPECT_FALSE(fs::exists(half));
  EXPECT_TRUE(small.load("a"));
}

TEST_F(BlobCacheTest, AFolderThatCannotBeMadeKeepsNothing) {
  write_text(folder_ / "file", "");
  const BlobCache nowhere(folder_ / "file" / "kept", kRoomy);
  EXPECT_FALSE(nowhere.store("a", "bytes"));
  EXPECT_FALSE(nowhere.load("a"));
}

TEST_F(BlobCacheTest, AFullDiskKeepsNothingAndLeavesNothing) {
  ASSERT_TRUE(cache_.store("a", "before"));
  {
    const FileLimit full(100);
    EXPECT_FALSE(cache_.store("a", std::string(1000, 'x')));
    EXPECT_FALSE(cache_.store("b", std::string(1000, 'x')));
  }
  EXPECT_EQ(loaded("a"), "before");
  EXPECT_EQ(files(), 1U);
}

/// Stores and loads under a few keys, in a folder so small that entries keep going; 0: every blob
/// was whole.
int use_cache(const BlobCache& cache, char own) {
  for (int i = 0; i < 300; ++i) {
    const std::string key = std::to_string(i % 5);
    if (const auto bytes = cache.load(key)) {
      if (bytes->size() != 3000 || bytes->find_first_not_of((*bytes)[0]) != bytes->npos) return 1;
    }
    cache.store(key, std::string(3000, own));
  }
  return 0;
}

TEST_F(BlobCacheTest, SeveralProcessesSeeWholeBlobsOrNone) {
  const BlobCache shared(cache_.folder(), 10000);
  std::vector<pid_t> children;
  for (const char own : {'a', 'b', 'c', 'd'}) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(use_cache(shared, own));
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
  ASSERT_TRUE(shared.store("last", "bytes"));
  std::uintmax_t all = 0;
  for (const auto& entry : fs::directory_iterator(shared.folder())) {
    EXPECT_EQ(entry.path().extension(), ".blob") << entry.path();
    all += entry.file_size();
  }
  EXPECT_LE(all, 10000U);
}

TEST(CacheFolder, IsWhereTheUserKeepsCaches) {
  const auto with = [](const char* xdg, const char* home) {
    ::setenv("XDG_CACHE_HOME", xdg, 1);
    ::setenv("HOME", home, 1);
    return default_cache_folder().value_or("none").string();
  };
  const char* home = std::getenv("HOME");
  const std::string before = home == nullptr ? "" : home;
  EXPECT_EQ(with("/x", "/h"), "/x/wobblebench");
  EXPECT_EQ(with("", "/h"), "/h/.cache/wobblebench");
  EXPECT_EQ(with("relative", "/h"), "/h/.cache/wobblebench");
  EXPECT_EQ(with("", ""), "none");
  ::unsetenv("XDG_CACHE_HOME");
  ::setenv("HOME", before.c_str(), 1);
}

}  // namespace
}  // namespace wobblebench::bench
