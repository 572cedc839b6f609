#include "bench/pipeline/board_link.h"

#include <utility>

#include "bench/exchange/files/foreign_names.h"
#include "bench/exchange/igtl/left_out.h"
#include "bench/exchange/igtl/sockets.h"
#include "bench/exchange/input/foreign_scan.h"
#include "bench/exchange/input/igtl_link.h"
#include "hw/recording/file_link.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kLinks =
    "must be sim, file=RECORDING, xdma=DEVICE or igtl=HOST:PORT, then ,key=value …";

bool is_foreign(const BoardArguments& board) {
  return board.link.link == "file" && foreign_format(board.link.value) != ForeignFormat::none;
}

bool is_igtl(const BoardArguments& board) {
  return board.link.link == "igtl";
}

BoardArguments with_igtl(BoardArguments board) {
  of_board(board.text, [&] { return read_link_options<IgtlLinkOptions>(board); });
  try {
    parse_endpoint(board.link.value, 1);
  } catch (const std::invalid_argument& error) {
    throw board_refusal(board.text, std::string("igtl: ") + error.what());
  }
  board.left_out = std::make_shared<LeftOut>();
  return board;
}

std::unique_ptr<hw::Link> open_igtl_link(const BoardArguments& board) try {
  return of_board(board.text, [&] {
    const auto options = read_link_options<IgtlLinkOptions>(board);
    return with_faults(
        std::make_unique<IgtlLink>(board.link.value, board.geometry, options, board.left_out),
        board);
  });
} catch (const UserError& error) {
  // Of what a server sent: it names the server.
  const std::string why = error.what();
  throw why.starts_with("--board") ? error : board_refusal(board.text, why);
}

/// Takes the key that recordings of ours do not have.
BoardArguments with_geometry(BoardArguments board) {
  const auto found = board.link.settings.find("geometry");
  if (found != board.link.settings.end()) {
    if (found->second.empty()) throw board_refusal(board.text, "geometry is empty; must be a file");
    board.geometry = found->second;
    board.link.settings.erase(found);
  }
  return board;
}

}  // namespace

BoardArguments parse_board(const std::string& text) {
  BoardArguments board = split_board(text);
  if (is_foreign(board) || is_igtl(board)) board = with_geometry(std::move(board));
  if (is_igtl(board)) return with_igtl(std::move(board));
  if (!is_simulated(board)) {
    check_outside(board, kLinks);
    return board;
  }
  if (!board.link.value.empty()) {
    throw board_refusal(text, "sim takes no value; " + std::string(kLinks));
  }
  of_board(text, [&] { return read_link_options<sim::SimLinkOptions>(board); });
  return board;
}

bool is_simulated(const BoardArguments& board) {
  return board.link.link == "sim";
}

std::unique_ptr<hw::Link> open_recorded_link(const BoardArguments& board) {
  if (is_igtl(board)) return open_igtl_link(board);
  if (!is_foreign(board)) return open_outside_link(board);
  return of_board(board.text, [&] {
    const ForeignScan scan = open_foreign_scan(board.link.value, board.geometry);
    return with_faults(open_foreign_link(scan, read_link_options<hw::FileLinkOptions>(board)),
                       board);
  });
}

std::unique_ptr<hw::Link> open_board_link(const BoardArguments& board,
                                          const MakeSticks& make_sticks,
                                          std::shared_ptr<sim::SimLinkStatistics> figures) {
  if (!is_simulated(board)) return open_recorded_link(board);
  return of_board(board.text, [&] {
    auto link = std::make_unique<sim::SimLink>(
        make_sticks(), read_link_options<sim::SimLinkOptions>(board), std::move(figures));
    return with_faults(std::move(link), board);
  });
}

std::string left_out_warning(const BoardArguments& board) {
  const std::string text = board.left_out ? board.left_out->text() : "";
  return text.empty() ? "" : "--board = " + board.text + ": left out: " + text;
}

}  // namespace wobblebench::bench
