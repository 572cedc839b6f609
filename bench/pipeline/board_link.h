// --board ARGS: from the text to an open link, of the simulator too.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bench/pipeline/outside_link.h"
#include "sim/card/sim_link.h"

namespace wobblebench::bench {

/// Throws UserError "--board = ARGS: key = value: what is allowed".
BoardArguments parse_board(const std::string& text);

/// The sticks come from the simulator.
bool is_simulated(const BoardArguments& board);

/// Makes the sticks of a simulated board; called for no other.
using MakeSticks = std::function<sim::StickSource()>;

/// Opens the link and injects its faults. file= may name a file of another program
/// (docs/exchange.md). Throws UserError for a link that cannot be opened, and for such a file.
std::unique_ptr<hw::Link> open_board_link(const BoardArguments& board,
                                          const MakeSticks& make_sticks,
                                          std::shared_ptr<sim::SimLinkStatistics> figures = {});

/// The same for a board that is not simulated.
std::unique_ptr<hw::Link> open_recorded_link(const BoardArguments& board);

/// What a link that takes messages of other programs has not taken so far; empty: nothing.
std::string left_out_warning(const BoardArguments& board);

}  // namespace wobblebench::bench
