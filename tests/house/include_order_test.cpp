// The order of the rooms (docs/architecture.md), read off the sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"hw", {"hw"}},
    {"phantoms", {"phantoms"}},
    {"sim", {"sim", "hw", "phantoms"}},
    {"render", {"render", "hw"}},
    {"bench", {"bench", "sim", "render", "hw", "phantoms"}},
};

struct Include {
  std::string file;
  std::string path;
};

std::vector<fs::path> sources_of(const std::string& room) {
  std::vector<fs::path> files;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(WOBBLEBENCH_SOURCE_DIR) / room)) {
    const auto extension = entry.path().extension();
    if (extension == ".h" || extension == ".cpp") files.push_back(entry.path());
  }
  return files;
}

std::vector<Include> includes_of(const std::string& room) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  for (const auto& file : sources_of(room)) {
    std::ifstream text(file);
    std::smatch match;
    for (std::string line; std::getline(text, line);) {
      if (std::regex_search(line, match, pattern)) includes.push_back({file.string(), match[1]});
    }
  }
  return includes;
}

std::string first_folder(const std::string& path) {
  return path.substr(0, path.find('/'));
}

TEST(IncludeOrder, RoomsIncludeOnlyWhatTheyMay) {
  for (const auto& [room, allowed] : kMayInclude) {
    const auto includes = includes_of(room);
    EXPECT_FALSE(includes.empty()) << room << " was not read";
    for (const auto& [file, path] : includes) {
      const std::string folder = first_folder(path);
      if (!kMayInclude.contains(folder)) continue;
      EXPECT_TRUE(allowed.contains(folder)) << file << " includes " << path;
    }
  }
}

TEST(IncludeOrder, RenderKnowsTheBoardsVocabularyAndNotItsLinks) {
  for (const auto& [file, path] : includes_of("render")) {
    EXPECT_FALSE(path == "hw/link/link.h" || path == "hw/board/board.h" ||
                 path == "hw/wire/packet.h")
        << file << " includes " << path;
  }
}

TEST(IncludeOrder, TheTablesAreMeasuredWithoutASimulator) {
  for (const auto& [file, path] : includes_of("bench/tables")) {
    EXPECT_FALSE(path.starts_with("sim/") || path.starts_with("phantoms/"))
        << file << " includes " << path;
  }
}

/// Our headers that are heavy themselves, and stay in .cpp files too.
const std::set<std::string> kHeavyOfOurs = {"phantoms/float_grid.h",
                                            "phantoms/io/vdb_file.h",
                                            "phantoms/io/clearance.h",
                                            "sim/tissue/extended_distance.h"};

bool is_heavy_header(const std::string& file) {
  return std::any_of(kHeavyOfOurs.begin(), kHeavyOfOurs.end(), [&](const auto& name) {
    return file.ends_with("/" + name);
  });
}

TEST(IncludeOrder, HeavyHeadersStayInSources) {
  // openvdb/version.h only defines macros: a forward declaration needs it.
  const std::regex heavy("^(openvdb/(?!version\\.h)|ceres/|opencv2/|OpenImageIO/)");
  for (const auto& [room, unused] : kMayInclude) {
    for (const auto& [file, path] : includes_of(room)) {
      if (!file.ends_with(".h") || is_heavy_header(file)) continue;
      EXPECT_FALSE(std::regex_search(path, heavy) || kHeavyOfOurs.contains(path))
          << file << " includes " << path;
    }
  }
}

}  // namespace
