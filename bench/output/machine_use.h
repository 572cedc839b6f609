// How busy the machine was while a command measured times, and at which clock its cores ran.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace wobblebench::bench {

/// What the kernel says at one moment. Sums are those since the machine, or this process, started.
/// NaN: it does not say.
struct MachineSample {
  double time_s = 0;             ///< of a steady clock
  double busy_s = 0;             ///< CPU time of all programs and of the kernel, over all cores
  double stolen_s = 0;           ///< CPU time that a hypervisor gave to other guests
  double own_s = 0;              ///< CPU time of this process and of its finished children
  double switched_away = 0;      ///< how often this process was interrupted for another program
  std::array<double, 3> load{};  ///< load average over 1, 5 and 15 minutes
  double slowest_core_mhz = 0;   ///< clock of the slowest core
  double fastest_core_mhz = 0;
  int cores = 1;
};

/// From /proc and /sys.
MachineSample sample_machine();

/// The same from given texts; `stat`: /proc/stat, `load`: /proc/loadavg.
void read_cpu_times(const std::string& stat, double ticks_per_s, MachineSample& sample);
void read_load(const std::string& load, MachineSample& sample);

/// The machine between two samples.
struct MachineUse {
  MachineSample before, after;

  /// Share of the CPU time of all cores that went to other programs and to other guests.
  double share_of_others() const;
  /// One line that says so; empty: it was too little to change times much, or is not known.
  std::string warning() const;
};

nlohmann::ordered_json to_json(const MachineUse& use);

}  // namespace wobblebench::bench
