#include "bench/scene/available_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// Infinite where the file is missing or says "max".
double limit_in(const fs::path& file) {
  std::ifstream in(file);
  double bytes = 0;
  return in >> bytes ? bytes : std::numeric_limits<double>::infinity();
}

/// The least limit of the groups from `group` up to the hierarchy's root.
double least_limit(const fs::path& hierarchy, std::string group, const std::string& name) {
  double least = limit_in(hierarchy / name);
  while (group.find_first_not_of('/') != std::string::npos) {
    least = std::min(least, limit_in(fs::path(hierarchy.string() + group) / name));
    group.resize(group.rfind('/'));
  }
  return least;
}

/// Of ":NAME,NAME,".
bool lists_memory(const std::string& controllers) {
  return controllers.starts_with(":memory,") || controllers.find(",memory,") != std::string::npos;
}

/// Lines of /proc/self/cgroup are NUMBER:CONTROLLERS:GROUP, and those of v2 name no controller.
double cgroup_limit_bytes(const fs::path& root) {
  const fs::path mounted = root / "sys/fs/cgroup";
  double least = std::numeric_limits<double>::infinity();
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first, second - first) + ',';
    const std::string group = line.substr(second + 1);
    if (controllers == ":,") {
      least = std::min(least, least_limit(mounted, group, "memory.max"));
    } else if (lists_memory(controllers)) {
      least = std::min(least, least_limit(mounted / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}

}  // namespace

double available_memory_bytes(const fs::path& root) {
  const double machine = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
                         static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  return std::min(machine, cgroup_limit_bytes(root));
}

}  // namespace wobblebench::bench
