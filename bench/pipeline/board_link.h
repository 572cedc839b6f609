// --board ARGS: from what the user wrote to an open link, the simulator's too.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bench/pipeline/outside_link.h"
#include "sim/card/sim_link.h"

namespace wobblebench::bench {

/// Throws UserError "--board = ARGS: key = value: what is allowed".
BoardArguments parse_board(const std::string& text);

/// The sticks come from the simulator, not from outside.
bool is_simulated(const BoardArguments& board);

/// What a simulated board sends; asked only if the board is one.
using MakeSticks = std::function<sim::StickSource()>;

/// Opens the link, with its faults around it. Throws UserError for what cannot be opened.
std::unique_ptr<hw::Link> open_board_link(const BoardArguments& board,
                                          const MakeSticks& make_sticks,
                                          std::shared_ptr<sim::SimLinkStatistics> figures = {});

}  // namespace wobblebench::bench
