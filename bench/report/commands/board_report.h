// What report.json says of the board.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "bench/pipeline/acquire.h"

namespace wobblebench::bench {

using LossCount = std::pair<std::string, std::uint64_t>;
/// Every cause, with its name in reports.
std::array<LossCount, 4> losses_by_cause(const hw::BoardAccount& account);

/// emitted, delivered, lost by cause; then duplicates, damage, and the link.
nlohmann::ordered_json board_json(const Acquisition& acquisition);
nlohmann::ordered_json account_json(const hw::BoardAccount& account);
nlohmann::ordered_json link_json(const hw::LinkCapabilities& link);

}  // namespace wobblebench::bench
