#include "bench/pipeline/board_link.h"

#include <utility>

#include "bench/exchange/files/foreign_names.h"
#include "bench/exchange/input/foreign_scan.h"
#include "hw/recording/file_link.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kLinks = "must be sim, file=RECORDING or xdma=DEVICE, then ,key=value …";

bool is_foreign(const BoardArguments& board) {
  return board.link.link == "file" && foreign_format(board.link.value) != ForeignFormat::none;
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
  if (is_foreign(board)) board = with_geometry(std::move(board));
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

}  // namespace wobblebench::bench
