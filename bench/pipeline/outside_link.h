// --board ARGS: the parsed text, and links to a recording or a card.
#pragma once

#include <memory>
#include <string>

#include "base/options.h"
#include "base/user_error.h"
#include "hw/link/fault_link.h"
#include "hw/link/link.h"
#include "hw/link/link_arguments.h"

namespace wobblebench::bench {

class LeftOut;

/// --board ARGS, parsed and checked without opening anything.
struct BoardArguments {
  std::string text;  ///< as given
  hw::LinkArguments link;
  std::string geometry = {};  ///< file that describes one of another program; empty: none
  hw::FaultPlan faults;       ///< injected into the link
  /// What a link that takes messages of other programs did not take; null: another link.
  std::shared_ptr<LeftOut> left_out = {};
};

/// "--board = ARGS: why".
UserError board_refusal(const std::string& text, const std::string& why);

/// The result of `body`; InvalidOption and LinkOpenError become a UserError of --board.
template <class Body>
auto of_board(const std::string& text, const Body& body) {
  try {
    return body();
  } catch (const InvalidOption& error) {
    throw board_refusal(text, error.what());
  } catch (const hw::LinkOpenError& error) {
    throw board_refusal(text, error.what());
  }
}

/// Parses the text, whatever link it names. Throws UserError.
BoardArguments split_board(const std::string& text);

/// The options of the link that the arguments name. Throws InvalidOption.
template <class Options>
Options read_link_options(const BoardArguments& board) {
  hw::LinkSettings settings(board.link);
  Options options;
  settings.read(options);
  std::string faults;
  settings.text("faults", faults);
  settings.finish(board.link.link);
  return options;
}

/// Throws UserError where the arguments are invalid for their link, or the link is neither file=
/// nor xdma=; `links`: the message in that case.
void check_outside(const BoardArguments& board, const std::string& links);

/// For programs without a simulator. Throws UserError.
BoardArguments parse_outside_board(const std::string& text);

/// The link with the faults of the arguments injected.
std::unique_ptr<hw::Link> with_faults(std::unique_ptr<hw::Link> link, const BoardArguments& board);

/// Opens a recording or a card and injects its faults. Throws UserError for a link that cannot be
/// opened.
std::unique_ptr<hw::Link> open_outside_link(const BoardArguments& board);

}  // namespace wobblebench::bench
