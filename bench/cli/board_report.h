// What report.json says of the board and of the simulator; a summary as a list of the page.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "bench/output/document/table.h"
#include "bench/pipeline/acquire.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

/// A list of what a summary says: its lines begin with the name of what they are about, in columns
/// of 12 characters; a line without a name goes on with the one before.
std::string summary_list(const std::string& summary);

/// ", N lost: CAUSE" for each cause that lost sticks.
std::string losses_text(const hw::BoardAccount& account);

/// Sticks emitted, delivered and lost by cause, for people.
Table board_table(const hw::BoardAccount& account);

/// emitted, delivered and lost by cause, to the end of the volume; the samples, and the link.
nlohmann::ordered_json board_json(const Acquisition& acquisition);
/// The account of all that the board had read, some of it ahead of the volume; damage, transport.
nlohmann::ordered_json board_timing_json(const Acquisition& acquisition);
nlohmann::ordered_json account_json(const hw::BoardAccount& account);
nlohmann::ordered_json link_json(const hw::LinkCapabilities& link);

/// Null where the stream does not say.
nlohmann::ordered_json display_scale_json(const hw::DisplayScale& scale);
std::string display_scale_text(const hw::DisplayScale& scale);
/// Puts a stream's scale in the place of that of the scene, which did not make its samples.
void report_stream_scale(nlohmann::ordered_json& report, const hw::DisplayScale& scale);

/// Sets "effects", those that ran, and "simulation": the rung, why it was taken, and what it leaves
/// out. `fidelity`: none where nothing was simulated.
void report_fidelity(nlohmann::ordered_json& report, const std::optional<sim::Fidelity>& fidelity);
/// The same, with the simulator's times. `simulated`: sums over `volumes`, 0 counting as 1.
void report_simulation(nlohmann::ordered_json& report,
                       const std::optional<SimulatedVolume>& simulated,
                       const hw::AcquisitionPlan& plan,
                       std::uint64_t volumes = 1);

}  // namespace wobblebench::bench
