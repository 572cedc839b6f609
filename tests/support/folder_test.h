// A fixture with a folder of its own, gone with the test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace wobblebench::testing_support {

/// Where files that are synced a thousand times need not wait for a disk: in memory, if the machine
/// has such a folder.
inline std::filesystem::path folder_in_memory() {
  const std::filesystem::path shared = "/dev/shm";
  return ::access(shared.c_str(), W_OK | X_OK) == 0 ? shared
                                                    : std::filesystem::temp_directory_path();
}

class FolderTest : public testing::Test {
 protected:
  explicit FolderTest(
      const std::filesystem::path& within = std::filesystem::temp_directory_path()) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "_" + test->name();
    for (char& c : name) c = c == '/' ? '_' : c;
    folder_ = within / ("wobblebench_" + std::to_string(getpid()) + "_" + name);
    std::filesystem::create_directories(folder_);
  }
  ~FolderTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  /// The new file's path.
  std::filesystem::path write(const std::vector<std::byte>& bytes,
                              const std::string& name = "r.wbst") const {
    std::ofstream stream(file(name), std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    return file(name);
  }

  std::filesystem::path folder_;
};

}  // namespace wobblebench::testing_support
