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

/// Null where the stream does not say.
nlohmann::ordered_json display_scale_json(const hw::DisplayScale& scale);
std::string display_scale_text(const hw::DisplayScale& scale);
/// Puts a stream's scale in the place of that of the scene, which did not make its samples.
void report_stream_scale(nlohmann::ordered_json& report, const hw::DisplayScale& scale);

}  // namespace wobblebench::bench
