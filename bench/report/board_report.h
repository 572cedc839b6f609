// What report.json says of the board.
#pragma once

#include <nlohmann/json.hpp>

#include "bench/pipeline/acquire.h"

namespace wobblebench::bench {

/// emitted, delivered, lost by cause; then duplicates, damage, and the link.
nlohmann::ordered_json board_json(const Acquisition& acquisition);
nlohmann::ordered_json account_json(const hw::BoardAccount& account);
nlohmann::ordered_json link_json(const hw::LinkCapabilities& link);

}  // namespace wobblebench::bench
