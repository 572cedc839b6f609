// The hash by which journals of a trade are joined: of the bytes of all files that its plan names,
// and of no name of a file.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/studies/trade/trade_study.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

namespace fs = std::filesystem;

/// Names of a plan's files; `folder` is the first part of each.
struct Names {
  fs::path folder;
  std::string mesh = "body.obj", other_mesh = "other.obj", points = "points.csv",
              scene = "scene.toml";

  std::vector<fs::path> all() const {
    return {folder / mesh, folder / other_mesh, folder / points, folder / scene};
  }
};

class TradeHash : public testing_support::FolderTest {
 protected:
  /// Writes a plan of three scenes: a mesh with point scatterers beside it, one of two meshes by an
  /// axis, and one that begins from a file.
  static TradeWork plan_of(const Names& names) {
    fs::create_directories(names.folder);
    write_file(names.folder / names.mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_file(names.folder / names.other_mesh, "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n");
    write_file(names.folder / names.points, "x_m,y_m,z_m,amplitude\n0,0,0,1\n");
    write_file(names.folder / names.scene, "# a scene\nphantom.name = \"sphere\"\n");
    return read(names);
  }

  static TradeWork read(const Names& names) {
    const fs::path plan = names.folder / "plan.toml";
    write_file(plan,
               "points = 2\ndesign = \"latin_hypercube\"\n"
               "[scenes.a]\nphantom = { name = \"mesh\", file = \"" +
                   names.mesh + "\", scatterers = \"" + names.points +
                   "\" }\n"
                   "[scenes.b]\nphantom = { name = \"mesh\", file = \"" +
                   names.mesh +
                   "\" }\n"
                   "[scenes.c]\nfile = \"" +
                   names.scene +
                   "\"\n"
                   "[axes]\n\"render.ray_casting.steps\" = [32, 64]\n"
                   "\"phantom.file\" = ['" +
                   (names.folder / names.mesh).string() + "', '" +
                   (names.folder / names.other_mesh).string() + "']\n");
    TradeWork work;
    work.plan = load_trade_plan(plan);
    work.points = design_points(work.plan);
    return work;
  }
};

/// Other bytes and names with --gtest_shuffle --gtest_random_seed=N.
std::uint64_t seed_of_run() {
  return static_cast<std::uint64_t>(testing::UnitTest::GetInstance()->random_seed());
}

TEST_F(TradeHash, ChangesWithAnyByteOfAnyFile) {
  const Names names{folder_ / "here"};
  const std::string hash = plan_of(names).hash();
  std::mt19937_64 random(3 + seed_of_run());
  std::set<std::string> hashes = {hash};
  std::size_t changes = 0;
  for (int round = 0; round < 150; ++round) {
    const fs::path file = names.all()[random() % 4];
    const std::string bytes = read_file(file);
    std::string changed = bytes;
    const auto at = random() % (file.extension() == ".toml" ? 9 : bytes.size());
    changed[at] = static_cast<char>(changed[at] ^ (1 << random() % 8));
    write_file(file, changed);
    try {
      const std::string other = read(names).hash();
      EXPECT_NE(other, hash) << file << ", byte " << at;
      hashes.insert(other);
      ++changes;
    } catch (const UserError&) {  // no TOML any more
    }
    write_file(file, bytes);
  }
  EXPECT_EQ(read(names).hash(), hash);
  EXPECT_GT(changes, 75U);
  EXPECT_GT(hashes.size(), 40U) << "different bytes, different hashes";
}

TEST_F(TradeHash, IsOfNoName) {
  const std::string hash = plan_of({folder_ / "here"}).hash();
  std::mt19937_64 random(5 + seed_of_run());
  const auto name = [&](const std::string& extension) {
    std::string text;
    for (int i = 0; i < 8; ++i) text += static_cast<char>('a' + random() % 26);
    return text + extension;
  };
  for (int round = 0; round < 20; ++round) {
    const Names names{
        folder_ / name("") / name(""), name(".obj"), name(".obj"), name(".csv"), name(".toml")};
    EXPECT_EQ(plan_of(names).hash(), hash) << names.folder;
  }
}

TEST_F(TradeHash, ChangesWithWhatAScenesFileSaysWhereTheReferenceSaysAnother) {
  const auto hash_with = [&](int steps) {
    write_file(file("scene.toml"),
               "phantom.name = \"sphere\"\nrender.ray_casting.steps = " + std::to_string(steps));
    write_file(file("plan.toml"),
               "[reference.render]\nray_casting.steps = 512\n[scenes.a]\nfile = \"scene.toml\"\n"
               "[axes]\n\"render.scan_conversion.slice_size\" = [64, 128]\n");
    TradeWork work;
    work.plan = load_trade_plan(file("plan.toml"));
    return work.hash();
  };
  EXPECT_NE(hash_with(64), hash_with(128));
}

/// 0.25 and 0.2500001 are other points.
TEST_F(TradeHash, KeepsAllDigitsOfARange) {
  const auto hash_from = [&](const std::string& from) {
    write_file(file("plan.toml"),
               "points = 2\ndesign = \"sobol\"\n[scenes.a]\nphantom.name = \"sphere\"\n"
               "[axes]\n\"render.ray_casting.iso_level\" = { from = " +
                   from + ", to = 0.9 }\n");
    TradeWork work;
    work.plan = load_trade_plan(file("plan.toml"));
    return work.hash();
  };
  EXPECT_NE(hash_from("0.25"), hash_from("0.25000001"));
}

TEST_F(TradeHash, AnAxisTakesNoSetting) {
  TradeWork work = plan_of({folder_ / "here"});
  EXPECT_NO_THROW(check_trade(work));
  work.more = {"render.ray_casting.steps=48"};
  EXPECT_THROW(check_trade(work), UserError);
}

}  // namespace
}  // namespace wobblebench::bench
