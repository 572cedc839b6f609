// Files that break their parsers: a flipped bit makes OpenVDB write beyond its buffers.
#include "phantoms/io/import_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "phantoms/float_grid.h"
#include "phantoms/import/confine.h"
#include "phantoms/io/message.h"
#include "phantoms/io/vdb_file.h"
#include "phantoms/phantom.h"
#include "tests/phantoms/io/meshes.h"
#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
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
    options.voxel_m = 2e-3;
    const std::string line = refusal_of<InvalidPhantom>([&] { make_phantom(options); });
    EXPECT_TRUE(line.empty() || holds(line, path.string()));
    EXPECT_FALSE(holds(line, "\n"));
    return line;
  }

  /// How many of `copies` of the file, each with one bit flipped, ended their reader.
  int endings_of_flipped(const std::string& name,
                         const std::filesystem::path& path,
                         std::size_t first_byte,
                         int copies) const {
    const std::string sound = bytes_of(path);
    EXPECT_EQ(refusal(name, path), "");
    std::mt19937 random(15);
    std::uniform_int_distribution<std::size_t> byte(first_byte, sound.size() - 1);
    int endings = 0;
    for (int i = 0; i < copies; ++i) {
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
  EXPECT_GT(endings_of_flipped("vdb", file("ball.vdb"), 1000, 80), 0)
      << "none of these files is dangerous: the test shows nothing";
}

TEST_F(ImportProcess, AFlippedBitOfOurOwnFileIsALineOrAResult) {
  PhantomOptions options;
  options.name = "sphere";
  options.radius_m = 8e-3;
  options.voxel_m = 1e-3;
  write_phantom(make_phantom(options), file("ours.vdb"));
  endings_of_flipped("file", file("ours.vdb"), 0, 20);
}

TEST_F(ImportProcess, AFlippedBitOfAMeshIsALineOrAResult) {
  write_binary_ply(icosphere(20, 1), file("ball.ply"));
  endings_of_flipped("mesh", file("ball.ply"), 0, 20);
  write_binary_stl(icosphere(20, 1), file("ball.stl"));
  endings_of_flipped("mesh", file("ball.stl"), 0, 20);
}

/// Forks, and returns the exit status of `body` in the child.
int status_of(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(ImportProcess, ReadsButNeitherWritesNorConnectsNorStartsPrograms) {
  write(file("there"), "bytes");
  const std::string there = file("there").string(), fresh = file("new").string();
  // The exit status is the number of the first attempt that had another result than it should.
  EXPECT_EQ(status_of([&] {
              if (!give_up_system_calls()) return 1;
              char byte = 0;
              const int in = ::open(there.c_str(), O_RDONLY | O_CLOEXEC);
              if (in < 0 || ::read(in, &byte, 1) != 1 || byte != 'b') return 2;
              if (::open(there.c_str(), O_RDWR) >= 0) return 3;
              if (::open(there.c_str(), O_WRONLY | O_TRUNC) >= 0) return 4;
              if (::open(fresh.c_str(), O_RDONLY | O_CREAT, 0600) >= 0) return 5;
              if (::syscall(SYS_openat, AT_FDCWD, fresh.c_str(), O_WRONLY | O_CREAT, 0600) >= 0)
                return 6;
              if (::unlink(there.c_str()) == 0 || ::rename(there.c_str(), fresh.c_str()) == 0)
                return 7;
              if (::mkdir(fresh.c_str(), 0700) == 0 || ::symlink("/", fresh.c_str()) == 0) return 8;
              if (::chmod(there.c_str(), 0777) == 0 || ::truncate(there.c_str(), 0) == 0) return 9;
              for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK}) {
                if (::socket(family, SOCK_STREAM, 0) >= 0) return 10;
              }
              if (::fork() >= 0) return 11;
              ::execl("/bin/true", "true", nullptr);
              if (::prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) >= 0) return 12;  // nor may it ask
              if (::kill(::getppid(), SIGTERM) == 0) return 13;
              return 0;
            }),
            0);
  EXPECT_EQ(bytes_of(file("there")), "bytes");
}

bool gains_no_privileges(const std::filesystem::path& process) {
  std::ifstream status(process / "status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("NoNewPrivs:")) return line.ends_with('1');
  }
  return false;
}

TEST_F(ImportProcess, GainsNoPrivileges) {
  EXPECT_EQ(status_of([] {
              if (!give_up_system_calls()) return 1;
              return gains_no_privileges("/proc/self") ? 0 : 2;
            }),
            0);
}

/// Numbers of the processes that run the reader with this file and have confined themselves, which
/// they do once they have asked to end with their parent.
std::vector<pid_t> readers_of(const std::filesystem::path& path) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream in(entry.path() / "cmdline", std::ios::binary);
    const std::string line{std::istreambuf_iterator<char>(in), {}};
    if (line.find("wobblebench-import") == std::string::npos) continue;
    if (line.find(path.string()) == std::string::npos) continue;
    if (gains_no_privileges(entry.path())) found.push_back(std::stoi(name));
  }
  return found;
}

TEST_F(ImportProcess, EndsWithItsParent) {
  std::string corners;  // The reader takes about a second, and is stopped before it has read them.
  for (int i = 0; i < 1'000'000; ++i) corners += "v 0.123456 0.234567 0.345678\n";
  write(file("large.obj"), corners + "f 1 2 3\n");
  const pid_t parent = ::fork();
  if (parent == 0) {
    try {
      const ImportedBytes large(ImportFormat::mesh, file("large.obj"));
    } catch (const std::exception&) {
    }
    ::_exit(0);
  }
  const auto wait_for = [&](std::size_t readers) {
    for (int i = 0; i < 10'000 && readers_of(file("large.obj")).size() != readers; ++i)
      ::usleep(1'000);
    return readers_of(file("large.obj"));
  };
  const std::vector<pid_t> readers = wait_for(1);
  ASSERT_EQ(readers.size(), 1u);
  ::kill(readers.front(), SIGSTOP);
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  EXPECT_TRUE(wait_for(0).empty());
}

/// As if the parent had been killed before the reader could ask to end with it.
TEST_F(ImportProcess, EndsWhereItsParentIsGoneAlready) {
  EXPECT_EQ(status_of([] { return die_with(::getppid()) ? 0 : 1; }), 0);
  EXPECT_EQ(status_of([] { return die_with(::getppid() + 1) ? 0 : 1; }), 1);
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
  EXPECT_TRUE(holds(refusal("mesh", file("wide.ply")), "an element of more than 100 properties"));
}

}  // namespace
}  // namespace wobblebench::phantoms
