// The order of rooms and folders (docs/architecture.md), read off the sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/house/include_graph.h"

namespace wobblebench {
namespace {

/// Folders that the files of a room may include, through any number of other files.
const std::map<std::string, std::vector<std::string>> kMayInclude = {
    {"base", {"base"}},
    {"hw", {"base", "hw"}},
    {"phantoms", {"base", "phantoms"}},
    {"sim", {"base", "hw", "phantoms", "sim"}},
    {"render", {"base", "hw/probe", "render"}},
    {"bench", {"base", "hw", "phantoms", "sim", "render", "bench"}},
};

const IncludeGraph& graph() {
  static const IncludeGraph all(WOBBLEBENCH_SOURCE_DIR,
                                {"base", "hw", "phantoms", "sim", "render", "bench"});
  return all;
}

bool lies_below(const std::string& file, const std::vector<std::string>& folders) {
  return std::any_of(folders.begin(), folders.end(), [&](const auto& folder) {
    return file.starts_with(folder + "/");
  });
}

void expect_reaches_only(const std::string& file, const std::vector<std::string>& allowed) {
  for (const auto& [included, unused] : graph().reachable(file)) {
    EXPECT_TRUE(lies_below(included, allowed)) << graph().path_to(file, included);
  }
}

TEST(IncludeOrder, RoomsReachOnlyWhatTheyMay) {
  for (const auto& [room, allowed] : kMayInclude) {
    const auto files = graph().files_below(room);
    EXPECT_FALSE(files.empty()) << room << " was not read";
    for (const auto& file : files) expect_reaches_only(file, allowed);
  }
}

TEST(IncludeOrder, WhatTheScannerIsNeedsNothingOfItsLinks) {
  for (const auto& file : graph().files_below("hw/probe")) {
    expect_reaches_only(file, {"base", "hw/probe"});
  }
}

/// What `wobblebench tables` has and `wobblebench-tables` has not.
const std::set<std::string> kTablesOfTheBench = {"bench/studies/tables/tables_command.cpp",
                                                 "bench/studies/tables/tables_command.h"};

TEST(IncludeOrder, TheTablesProgramReachesNoSimulator) {
  for (const auto& file : graph().files_below("bench/studies/tables")) {
    if (kTablesOfTheBench.contains(file)) continue;
    expect_reaches_only(file, {"base", "hw", "render", "bench"});
  }
}

TEST(IncludeOrder, RoomsIncludeNothingOfTests) {
  for (const auto& file : graph().files()) {
    for (const auto& include : graph().direct(file)) {
      EXPECT_NE(room_of(include), "tests") << file << " includes " << include;
    }
  }
}

TEST(IncludeOrder, EveryIncludeOfOursIsAFile) {
  const auto files = graph().files();
  const std::set<std::string> known(files.begin(), files.end());
  for (const auto& file : files) {
    for (const auto& include : graph().direct(file)) {
      if (!kMayInclude.contains(room_of(include)) || include.find('/') == std::string::npos)
        continue;
      EXPECT_TRUE(known.contains(include)) << file << " includes " << include;
    }
  }
}

/// Folders that each folder includes. A room's own level holds its door and its vocabulary, and
/// takes no part.
std::map<std::string, std::set<std::string>> folder_edges() {
  std::map<std::string, std::set<std::string>> edges;
  for (const auto& file : graph().files()) {
    const std::string from = folder_of(file);
    for (const auto& include : graph().direct(file)) {
      const std::string to = folder_of(include);
      const bool inner = room_of(include) == room_of(file) && to != from && from != room_of(file) &&
                         to != room_of(file);
      if (inner) edges[from].insert(to);
    }
  }
  return edges;
}

void expect_one_way(const std::map<std::string, std::set<std::string>>& edges) {
  std::set<std::string> done;
  std::vector<std::string> path;
  const std::function<void(const std::string&)> visit = [&](const std::string& folder) {
    const auto again = std::find(path.begin(), path.end(), folder);
    if (again != path.end()) {
      std::string circle;
      for (auto at = again; at != path.end(); ++at) circle += *at + " -> ";
      ADD_FAILURE() << circle << folder;
      return;
    }
    if (done.contains(folder)) return;
    path.push_back(folder);
    if (edges.contains(folder)) {
      for (const auto& next : edges.at(folder)) visit(next);
    }
    path.pop_back();
    done.insert(folder);
  };
  for (const auto& [folder, unused] : edges) visit(folder);
}

TEST(IncludeOrder, FoldersOfARoomIncludeEachOtherOneWay) {
  expect_one_way(folder_edges());
}

/// Of the bench as a whole, each with all below it: "bench/exchange" of "bench/exchange/files".
TEST(IncludeOrder, RoomsOfTheBenchIncludeEachOtherOneWay) {
  const auto bench_room = [](const std::string& folder) {
    return folder.substr(0, folder.find('/', std::string("bench/").size()));
  };
  std::map<std::string, std::set<std::string>> edges;
  for (const auto& [folder, included] : folder_edges()) {
    if (!folder.starts_with("bench/")) continue;
    for (const std::string& to : included) {
      if (bench_room(to) != bench_room(folder)) edges[bench_room(folder)].insert(bench_room(to));
    }
  }
  EXPECT_GT(edges.size(), 8u);
  expect_one_way(edges);
}

/// Our headers that include OpenVDB or toml++, for .cpp files alone.
const std::set<std::string> kHeavyOfOurs = {
    "phantoms/float_grid.h", "phantoms/io/vdb_file.h", "bench/scene/toml_file.h"};

TEST(IncludeOrder, HeavyHeadersStayInSources) {
  const std::regex heavy("^(openvdb/(?!version\\.h)|(ceres|opencv2|OpenImageIO|CLI|toml\\+\\+)/)");
  for (const auto& file : graph().files()) {
    if (!file.ends_with(".h") || kHeavyOfOurs.contains(file)) continue;
    for (const auto& include : graph().direct(file)) {
      EXPECT_FALSE(std::regex_search(include, heavy) || kHeavyOfOurs.contains(include))
          << file << " includes " << include;
    }
  }
}

TEST(IncludeOrder, JsonIsDeclaredInHeadersAndDefinedInSources) {
  for (const auto& file : graph().files()) {
    if (!file.ends_with(".h")) continue;
    const auto& includes = graph().direct(file);
    EXPECT_EQ(std::count(includes.begin(), includes.end(), "nlohmann/json.hpp"), 0) << file;
  }
}

}  // namespace
}  // namespace wobblebench
