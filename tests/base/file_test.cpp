// Reading whole files: all bytes, or why they cannot be read.
#include "base/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <stdexcept>
#include <string>

#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench {
namespace {

class ReadFile : public testing_support::FolderTest {
 protected:
  /// what() of the refusal; empty: it was read.
  static std::string refusal(const std::filesystem::path& path) {
    return refusal_of<std::runtime_error>([&] { read_file(path); });
  }
};

TEST_F(ReadFile, GivesEveryByte) {
  std::string bytes;
  for (int i = 0; i < 200000; ++i) bytes += static_cast<char>(i * 7919 >> 5);
  for (const std::size_t size : {0u, 1u, 65535u, 65536u, 65537u, 200000u}) {
    write_file(folder_ / "file", bytes.substr(0, size));
    EXPECT_EQ(read_file(folder_ / "file"), bytes.substr(0, size));
    EXPECT_EQ(read_file(folder_ / "file", 70000),
              bytes.substr(0, std::min<std::size_t>(size, 70000)));
    std::string joined;
    read_pieces(folder_ / "file", [&](std::string_view piece) { joined += piece; });
    EXPECT_EQ(joined, bytes.substr(0, size));
  }
}

/// The first page of a process's memory is never mapped: reading it is EIO, after a successful
/// open.
TEST_F(ReadFile, AReadThatFailsIsNotTheEndOfTheFile) {
  EXPECT_EQ(refusal("/proc/self/mem"), "/proc/self/mem: cannot be read: Input/output error");
}

TEST_F(ReadFile, WhatIsNoFileIsRefusedWithoutWaiting) {
  const std::string fifo = folder_ / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(refusal(fifo), fifo + ": cannot be read: is no file");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: cannot be read: is no file");
  EXPECT_EQ(refusal(folder_), folder_.string() + ": cannot be read: is a folder");
  EXPECT_EQ(refusal(folder_ / "none"),
            (folder_ / "none").string() + ": cannot be read: No such file or directory");
}

}  // namespace
}  // namespace wobblebench
