#include "tests/house/include_graph.h"

#include <deque>
#include <fstream>
#include <regex>

namespace wobblebench {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<std::string> includes;
  std::ifstream text(file);
  std::smatch match;
  for (std::string line; std::getline(text, line);) {
    if (std::regex_search(line, match, pattern)) includes.push_back(match[1]);
  }
  return includes;
}

bool is_source(const fs::path& path) {
  return path.extension() == ".h" || path.extension() == ".cpp";
}

}  // namespace

IncludeGraph::IncludeGraph(const fs::path& project, const std::vector<std::string>& rooms) {
  for (const auto& room : rooms) {
    for (const auto& entry : fs::recursive_directory_iterator(project / room)) {
      if (!is_source(entry.path())) continue;
      includes_[fs::relative(entry.path(), project).generic_string()] = includes_of(entry.path());
    }
  }
}

std::vector<std::string> IncludeGraph::files() const {
  std::vector<std::string> all;
  for (const auto& [file, unused] : includes_) all.push_back(file);
  return all;
}

std::vector<std::string> IncludeGraph::files_below(const std::string& folder) const {
  std::vector<std::string> below;
  for (const auto& [file, unused] : includes_) {
    if (file.starts_with(folder + "/")) below.push_back(file);
  }
  return below;
}

const std::vector<std::string>& IncludeGraph::direct(const std::string& file) const {
  return includes_.at(file);
}

std::map<std::string, std::string> IncludeGraph::reachable(const std::string& file) const {
  std::map<std::string, std::string> through;
  std::deque<std::string> open = {file};
  for (; !open.empty(); open.pop_front()) {
    for (const auto& include : includes_.at(open.front())) {
      if (include == file || !includes_.contains(include)) continue;
      if (through.emplace(include, open.front()).second) open.push_back(include);
    }
  }
  return through;
}

std::string IncludeGraph::path_to(const std::string& file, const std::string& target) const {
  const auto through = reachable(file);
  std::string path = target;
  for (std::string at = target; at != file;) {
    at = through.at(at);
    path += " <- " + at;
  }
  return path;
}

std::string room_of(const std::string& path) {
  return path.substr(0, path.find('/'));
}

std::string folder_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

}  // namespace wobblebench
