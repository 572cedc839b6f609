// Files that break their parsers: a flipped bit makes OpenVDB write beyond its buffers.
#include "phantoms/io/import_process.h"

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <sys/wait.h>

#include <fstream>
#include <random>

#include "phantoms/float_grid.h"
#include "phantoms/io/message.h"
#include "phantoms/io/vdb_file.h"
#include "phantoms/phantom.h"
#include "tests/phantoms/io/meshes.h"
#include "tests/support/bytes_of.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

using testing_support::bytes_of;

class ImportProcess : public testing_support::FolderTest {
 protected:
  static void write(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  }

  /// The line of a refusal; empty if the file is taken.
  static std::string refusal(const std::string& name, const std::filesystem::path& path) {
    PhantomOptions options;
    options.name = name;
    options.file = path.string();
    options.voxel_m = 1e-3;
    try {
      make_phantom(options);
      return {};
    } catch (const InvalidPhantom& error) {
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return error.what();
    }
  }

  /// How many of 250 copies of the file, each with one bit flipped, ended their reader.
  int endings_of_flipped(const std::string& name,
                         const std::filesystem::path& path,
                         std::size_t first_byte) const {
    const std::string sound = bytes_of(path);
    EXPECT_EQ(refusal(name, path), "");
    std::mt19937 random(15);
    std::uniform_int_distribution<std::size_t> byte(first_byte, sound.size() - 1);
    int endings = 0;
    for (int i = 0; i < 250; ++i) {
      std::string damaged = sound;
      damaged[byte(random)] ^= static_cast<char>(1 << random() % 8);
      write(path, damaged);
      endings += refusal(name, path).find("reading it ended in signal") != std::string::npos;
    }
    return endings;
  }
};

TEST_F(ImportProcess, AFlippedBitOfAVdbIsALineOrAResult) {
  openvdb::initialize();
  auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(8, {0, 0, 0}, 1);
  ball->setName("ball");
  openvdb::io::File(file("ball.vdb").string()).write({ball});
  // The tree, behind header and metadata.
  EXPECT_GT(endings_of_flipped("vdb", file("ball.vdb"), 1000), 0)
      << "none of these files is dangerous: the test shows nothing";
}

TEST_F(ImportProcess, AFlippedBitOfOurOwnFileIsALineOrAResult) {
  PhantomOptions options;
  options.name = "sphere";
  options.radius_m = 8e-3;
  options.voxel_m = 1e-3;
  write_phantom(make_phantom(options), file("ours.vdb"));
  endings_of_flipped("file", file("ours.vdb"), 0);
}

TEST_F(ImportProcess, AFlippedBitOfAMeshIsALineOrAResult) {
  write_binary_ply(icosphere(20, 1), file("ball.ply"));
  endings_of_flipped("mesh", file("ball.ply"), 0);
  write_binary_stl(icosphere(20, 1), file("ball.stl"));
  endings_of_flipped("mesh", file("ball.stl"), 0);
}

TEST_F(ImportProcess, LeavesNothingBehind) {
  write(file("a.vdb"), "no grid, but long enough for a header of OpenVDB");
  EXPECT_NE(refusal("vdb", file("a.vdb")), "");
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST(ImportMessage, NoCountIsTrusted) {
  std::string bytes(8, '\xff');
  EXPECT_THROW(MessageReader(bytes).text(), std::invalid_argument);
  EXPECT_THROW(MessageReader(bytes).list<std::uint32_t>(), std::invalid_argument);
  EXPECT_THROW(MessageReader("abc").get<std::uint32_t>(), std::invalid_argument);
}

TEST_F(ImportProcess, RefusesHundredsOfPropertiesAtOnce) {
  std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\n";
  for (int i = 0; i < 300; ++i) ply += "property float p" + std::to_string(i) + "\n";
  ply += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 900; ++i) ply += "0 ";
  write(file("wide.ply"), ply + "\n3 0 1 2\n");
  EXPECT_NE(refusal("mesh", file("wide.ply")).find("an element of more than 100 properties"),
            std::string::npos);
}

}  // namespace
}  // namespace wobblebench::phantoms
