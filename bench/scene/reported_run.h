// A run as its report.json tells it, where another command makes or scores it again.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace wobblebench::bench {

/// What --board was given. `source`: of the report, for refusals. Throws UserError where the sticks
/// were not simulated, since a report does not hold them, and where the report does not say what it
/// was given, although its volume is not the first.
std::string simulated_board_of(const nlohmann::ordered_json& report, const std::string& source);

/// The number that the board gave the volume. Throws UserError where the report does not say it.
std::uint32_t volume_of(const nlohmann::ordered_json& report, const std::string& source);

}  // namespace wobblebench::bench
