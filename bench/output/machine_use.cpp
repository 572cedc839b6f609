#include "bench/output/machine_use.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "base/number_text.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
/// Share of others from which on times are called those of a busy machine, and the shortest time
/// over which it is judged: the kernel counts in ticks of 10 ms.
constexpr double kBusyShare = 0.15;
constexpr double kLeastJudged_s = 0.5;

std::string text_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

void read_own_use(MachineSample& sample) {
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage use{};
    if (::getrusage(who, &use) != 0) continue;
    sample.own_s += seconds(use.ru_utime) + seconds(use.ru_stime);
    sample.switched_away += static_cast<double>(use.ru_nivcsw);
  }
}

/// Clocks of the cores, MHz: as the governor says, or else as /proc/cpuinfo does.
std::vector<double> core_clocks_mhz(int cores) {
  std::vector<double> clocks;
  for (int core = 0; core < cores; ++core) {
    std::ifstream file("/sys/devices/system/cpu/cpu" + std::to_string(core) +
                       "/cpufreq/scaling_cur_freq");
    double khz = 0;
    if (file >> khz) clocks.push_back(khz / 1e3);
  }
  if (!clocks.empty()) return clocks;
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("cpu MHz")) continue;
    clocks.push_back(std::atof(line.substr(line.find(':') + 1).c_str()));
  }
  return clocks;
}

nlohmann::ordered_json moment_json(const MachineSample& sample) {
  nlohmann::ordered_json load = nlohmann::ordered_json::array();
  for (const double average : sample.load) load.push_back(number(average));
  return {{"load_average", load},
          {"slowest_core_mhz", number(sample.slowest_core_mhz)},
          {"fastest_core_mhz", number(sample.fastest_core_mhz)}};
}

}  // namespace

void read_cpu_times(const std::string& stat, double ticks_per_s, MachineSample& sample) {
  sample.busy_s = sample.stolen_s = kUnknown;
  std::istringstream text(stat);
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, irq = 0, soft_irq = 0, steal = 0;
  text >> name >> user >> nice >> system >> idle >> waiting >> irq >> soft_irq >> steal;
  if (!text || name != "cpu") return;
  sample.busy_s = (user + nice + system + irq + soft_irq) / ticks_per_s;
  sample.stolen_s = steal / ticks_per_s;
}

void read_load(const std::string& load, MachineSample& sample) {
  std::istringstream text(load);
  for (double& average : sample.load) {
    if (!(text >> average)) average = kUnknown;
  }
}

MachineSample sample_machine() {
  MachineSample sample;
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  sample.time_s = std::chrono::duration<double>(now).count();
  read_cpu_times(text_of("/proc/stat"), static_cast<double>(::sysconf(_SC_CLK_TCK)), sample);
  read_load(text_of("/proc/loadavg"), sample);
  read_own_use(sample);
  sample.cores = static_cast<int>(std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN)));
  const std::vector<double> clocks = core_clocks_mhz(sample.cores);
  const auto [slowest, fastest] = std::minmax_element(clocks.begin(), clocks.end());
  sample.slowest_core_mhz = clocks.empty() ? kUnknown : *slowest;
  sample.fastest_core_mhz = clocks.empty() ? kUnknown : *fastest;
  return sample;
}

double MachineUse::share_of_others() const {
  const double others_s = (after.busy_s - before.busy_s) - (after.own_s - before.own_s);
  const double stolen_s = after.stolen_s - before.stolen_s;
  // The kernel counts in ticks, which may end within a short command without having begun in it.
  const double share =
      (std::max(others_s, 0.0) + stolen_s) / (after.cores * (after.time_s - before.time_s));
  return share > 1 ? 1 : share;
}

std::string MachineUse::warning() const {
  const double share = share_of_others();
  if (!(share > kBusyShare) || after.time_s - before.time_s < kLeastJudged_s) return "";
  return "the machine was busy: other work took " + fixed(100 * share, 0) + " % of the time of " +
         std::to_string(after.cores) +
         " cores; times of this run are longer than on an idle machine";
}

nlohmann::ordered_json to_json(const MachineUse& use) {
  const std::string warning = use.warning();
  return {{"before", moment_json(use.before)},
          {"after", moment_json(use.after)},
          {"cores", use.after.cores},
          {"others_percent", number(100 * use.share_of_others())},
          {"stolen_s", number(use.after.stolen_s - use.before.stolen_s)},
          {"own_cpu_s", number(use.after.own_s - use.before.own_s)},
          {"switched_away", number(use.after.switched_away - use.before.switched_away)},
          {"warning",
           warning.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(warning)}};
}

}  // namespace wobblebench::bench
