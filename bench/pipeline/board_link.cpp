#include "bench/pipeline/board_link.h"

#include <utility>

namespace wobblebench::bench {

namespace {

constexpr const char* kLinks = "must be sim, file=RECORDING or xdma=DEVICE, then ,key=value …";

}  // namespace

BoardArguments parse_board(const std::string& text) {
  BoardArguments board = split_board(text);
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

std::unique_ptr<hw::Link> open_board_link(const BoardArguments& board,
                                          const MakeSticks& make_sticks,
                                          std::shared_ptr<sim::SimLinkStatistics> figures) {
  if (!is_simulated(board)) return open_outside_link(board);
  return of_board(board.text, [&] {
    auto link = std::make_unique<sim::SimLink>(
        make_sticks(), read_link_options<sim::SimLinkOptions>(board), std::move(figures));
    return with_faults(std::move(link), board);
  });
}

}  // namespace wobblebench::bench
