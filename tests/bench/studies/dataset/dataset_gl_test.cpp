// `wobblebench dataset` as a user runs it: shards, resuming, refusals, and making scenes again.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/number_text.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Scenes 0 to 3: spheres; `bad` is a mesh with a hole, which is refused when it is made.
const std::string kPlan =
    "scenes = 4\nseed = 3\n"
    "[scene]\n"
    "phantom = { name = \"sphere\", voxel_mm = 2, radius_mm = { uniform = [15, 25] } }\n"
    "acquisition = { frames_per_volume = 9, sticks_per_frame = 16, focal_zones = 2 }\n"
    "render.scan_conversion.slice_size = 64\n"
    "render.ray_casting = { image_size = 64, steps = 64 }\n"
    "[strata.good]\nshare = 0.75\n"
    "[strata.bad]\nshare = 0.25\n"
    "phantom = { name = \"mesh\", file = \"open.obj\", voxel_mm = 2, radius_mm = 20 }\n";
const std::string kOpenMesh =
    "v -20 -20 -20\nv 20 -20 -20\nv 0 20 -20\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";

class Dataset : public testing::Test {
 protected:
  Dataset() {
    folder_.write("plan.toml", kPlan);
    folder_.write("open.obj", kOpenMesh);
  }

  ProcessResult dataset(const Words& more, const ProcessLimits& limits = {}) {
    return bench(with({"dataset", "plan.toml"}, {more}), folder_, limits);
  }

  /// The bytes of all files under a folder that the manifest has hashes of, and of the manifest.
  std::map<std::string, std::string> bytes_in(const std::string& out) const {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / out)) {
      const std::string name = entry.path().filename().string();
      const bool has_times = name == "report.json" || name == "recording.json" ||
                             name == "report.html" || !entry.is_regular_file();
      if (has_times) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::ostringstream text;
      text << file.rdbuf();
      bytes[fs::relative(entry.path(), folder_.path() / out).string()] = text.str();
    }
    return bytes;
  }

  std::vector<Json> manifest(const std::string& out) const {
    std::ifstream file(folder_.path() / out / "manifest.jsonl");
    std::vector<Json> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(Json::parse(line));
    return lines;
  }

  ScratchFolder folder_;
};

std::vector<std::string> names_of(const std::map<std::string, std::string>& files) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files) names.push_back(name);
  return names;
}

void expect_equal(const std::map<std::string, std::string>& a,
                  const std::map<std::string, std::string>& b) {
  EXPECT_EQ(names_of(a), names_of(b));
  for (const auto& [name, bytes] : a) {
    EXPECT_TRUE(b.contains(name) && bytes == b.at(name)) << name;
  }
}

TEST_F(Dataset, HasALineForEachSceneAndNotesRefusals) {
  const ProcessResult made = dataset({"--out", "whole"});
  ASSERT_EQ(made.exit_code, 1) << made.err;
  EXPECT_NE(made.err.find("1 of 4 scenes were refused: manifest.jsonl says why"), std::string::npos)
      << made.err;
  const auto lines = manifest("whole");
  ASSERT_EQ(lines.size(), 4U);
  int refused = 0;
  std::vector<double> p95_mm;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Json& line = lines[i];
    EXPECT_EQ(line.at("index"), i);
    EXPECT_EQ(line.at("seed"), line.at("settings").at("simulation.seed"));
    if (line.contains("refused")) {
      ++refused;
      EXPECT_EQ(line.at("stratum"), "bad");
      EXPECT_NE(line.at("refused").get<std::string>().find("open.obj"), std::string::npos);
      continue;
    }
    for (const char* name :
         {"recording.wbst", "polar.npz", "depth.exr", "truth_depth.exr", "labels.exr"}) {
      EXPECT_TRUE(line.at("files").contains(name)) << name;
    }
    p95_mm.push_back(line.at("error").at("p95_mm"));
    const std::string scene = "whole/scenes/00000" + std::to_string(i) + "/report.json";
    std::ifstream report(folder_.path() / scene);
    EXPECT_EQ(Json::parse(report).at("warnings").dump().find("--board sim"), std::string::npos)
        << "of what it was made with";
    const double radius_mm = line.at("settings").at("phantom.radius_mm");
    EXPECT_TRUE(radius_mm >= 15 && radius_mm <= 25) << radius_mm;
  }
  EXPECT_EQ(refused, 1);
  // Large: the median over the scenes, and the scene where it is greatest.
  ASSERT_EQ(p95_mm.size(), 3U);
  std::ranges::sort(p95_mm);
  std::ifstream page(folder_.path() / "whole/dataset.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(text.find("- **P95** " + fixed(p95_mm[1], 2) + " mm: "), std::string::npos) << text;
  EXPECT_NE(text.find("greatest " + fixed(p95_mm[2], 2) + " of scene "), std::string::npos) << text;
}

TEST_F(Dataset, ShardsTogetherAreTheWhole) {
  ASSERT_EQ(dataset({"--out", "whole"}).exit_code, 1);
  for (const char* shard : {"2/2", "1/2"}) {
    const ProcessResult made = dataset({"--out", "parts", "--shard", shard});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_FALSE(fs::exists(folder_.path() / "parts/manifest.jsonl"));
  }
  ASSERT_EQ(dataset({"--out", "parts"}).exit_code, 1);
  expect_equal(bytes_in("whole"), bytes_in("parts"));
}

TEST_F(Dataset, AKilledCommandLeavesWholeScenesAndIsResumed) {
  ASSERT_EQ(dataset({"--out", "whole"}).exit_code, 1);
  const fs::path scenes = folder_.path() / "parts/scenes";
  ProcessLimits limits;
  limits.signal = 9;
  // While the second scene is made.
  limits.interrupt_when = [&] { return fs::exists(scenes / ".making-000001/scene/scene.toml"); };
  EXPECT_EQ(dataset({"--out", "parts"}, limits).exit_code, 128 + 9);
  for (const auto& entry : fs::directory_iterator(scenes)) {
    const std::string name = entry.path().filename().string();
    const bool is_whole = fs::exists(entry.path() / "scene.json");
    EXPECT_TRUE(is_whole || name.starts_with(".")) << name;
  }
  EXPECT_FALSE(fs::exists(scenes / "000001"));
  const ProcessResult resumed = dataset({"--out", "parts"});
  ASSERT_EQ(resumed.exit_code, 1) << resumed.err;
  expect_equal(bytes_in("whole"), bytes_in("parts"));
}

TEST_F(Dataset, VerifyFindsAFlippedByte) {
  ASSERT_EQ(dataset({"--out", "whole"}).exit_code, 1);
  const ProcessResult same = dataset({"--out", "whole", "--verify", "4"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  const std::string file = "scenes/000000/depth.exr";
  std::fstream bytes(folder_.path() / "whole" / file,
                     std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekg(2000);
  const char flipped = static_cast<char>(bytes.get() ^ 1);
  bytes.seekp(2000);
  bytes.put(flipped);
  bytes.close();
  const ProcessResult other = dataset({"--out", "whole", "--verify", "4"});
  EXPECT_EQ(other.exit_code, 1) << other.err;
  EXPECT_NE(other.out.find(file + ": differs"), std::string::npos) << other.out;
}

TEST_F(Dataset, RefusesALinkThatLeadsToNoFolder) {
  fs::create_symlink("gone", folder_.path() / "link");
  const ProcessResult result = dataset({"--out", "link"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("link is a symbolic link to gone, which leads to no folder"),
            std::string::npos)
      << result.err;
}

TEST_F(Dataset, RefusesAFolderOfAnotherPlan) {
  ASSERT_EQ(dataset({"--out", "whole", "--shard", "1/4"}).exit_code, 0);
  folder_.write("plan.toml", "# changed\n" + kPlan);
  const ProcessResult other = dataset({"--out", "whole"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("holds scenes of another plan"), std::string::npos) << other.err;
  const ProcessResult none = dataset({"--out", "nothing", "--verify", "1"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_FALSE(fs::exists(folder_.path() / "nothing"));
}

/// Rows of a CSV file without quotes, by the names of its columns.
std::vector<std::map<std::string, std::string>> csv_rows(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    lines.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) lines.back().push_back(cell);
  }
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    rows.emplace_back();
    for (std::size_t j = 0; j < lines[i].size(); ++j) rows.back()[lines[0][j]] = lines[i][j];
  }
  return rows;
}

TEST_F(Dataset, IsAnAxisOfAccuracy) {
  std::string plan = kPlan;
  plan.replace(plan.find("scenes = 4"), 10, "scenes = 16");
  folder_.write("plan.toml", plan);
  const std::string head = "population = \"plan.toml\"\nhalf = \"judge\"\nrungs = [\"field\"]\n",
                    settings = "[settings.a.render]\npreset = \"baseline\"\n[settings.b]\n";
  folder_.write("axis.toml", head + "per_stratum = 3\n" + settings);
  const ProcessResult made = bench({"accuracy", "axis.toml", "--out", "out", "--json"}, folder_);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  std::map<std::string, std::set<std::string>> seeds;
  std::map<std::string, double> sums;
  for (const auto& row : csv_rows(folder_.path() / "out/accuracy.csv")) {
    if (row.at("group") != "picture") continue;
    EXPECT_EQ(row.at("scene"), "good");
    seeds[row.at("setting")].insert(row.at("seed"));
    sums[row.at("setting")] += std::stod(row.at("p95_mm"));
  }
  ASSERT_EQ(seeds.size(), 2U);
  for (const auto& [setting, of] : seeds) EXPECT_EQ(of.size(), 3U);
  const std::string page = bytes_of(folder_.path() / "out/accuracy.md");
  EXPECT_NE(page.find("A scene of bad (seed "), std::string::npos);
  // The mean of the table is that of the rows.
  std::ostringstream mean;
  mean.precision(2);
  mean << std::fixed << sums.at("a") / 3;
  const auto table = page.find("## By stratum");
  ASSERT_NE(table, std::string::npos);
  EXPECT_NE(page.find(mean.str() + " (", table), std::string::npos) << page.substr(table, 900);

  for (const std::string wrong : {"seeds = 3\n", "[scenes.x]\n", "half = \"both\"\n"}) {
    folder_.write("wrong.toml", "population = \"plan.toml\"\n" + wrong + settings);
    EXPECT_EQ(bench({"accuracy", "wrong.toml"}, folder_).exit_code, 2) << wrong;
  }
  folder_.write("wrong.toml", "half = \"judge\"\n[scenes.x]\n" + settings);
  EXPECT_EQ(bench({"accuracy", "wrong.toml"}, folder_).exit_code, 2);
}

}  // namespace
}  // namespace wobblebench::bench
