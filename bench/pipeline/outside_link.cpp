#include "bench/pipeline/outside_link.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "hw/link/xdma_link.h"
#include "hw/recording/file_link.h"

namespace wobblebench::bench {

namespace {

std::unique_ptr<hw::Link> open_bare(const BoardArguments& board) {
  if (board.link.link == "file") {
    return std::make_unique<hw::FileLink>(board.link.value,
                                          read_link_options<hw::FileLinkOptions>(board));
  }
  return std::make_unique<hw::XdmaLink>(board.link.value,
                                        read_link_options<hw::XdmaLinkOptions>(board));
}

/// The link that a path is opened with where the text names none, "file=PATH"; empty: it is no
/// path.
std::string link_of_path(const std::string& text) {
  const std::filesystem::path path = text.substr(0, text.find(','));
  std::error_code ignored;
  const auto type = std::filesystem::status(path, ignored).type();
  using Type = std::filesystem::file_type;
  const bool is_node = type == Type::character || type == Type::fifo;
  if (is_node || path.string().starts_with("/dev/")) return "xdma=" + path.string();
  const bool is_recording = type == Type::regular || path.extension() == ".wbst";
  return is_recording ? "file=" + path.string() : "";
}

void refuse_bare_path(const std::string& text) {
  if (text.substr(0, text.find(',')).find('=') != std::string::npos) return;
  const std::string link = link_of_path(text);
  if (text.empty() || text == "sim" || text.starts_with("sim,") || link.empty()) return;
  throw board_refusal(text, "is a path; must be " + link);
}

}  // namespace

UserError board_refusal(const std::string& text, const std::string& why) {
  return UserError("--board = " + text + ": " + why);
}

BoardArguments split_board(const std::string& text) {
  refuse_bare_path(text);
  return of_board(text, [&] {
    BoardArguments board{.text = text, .link = hw::parse_link_arguments(text), .faults = {}};
    const auto faults = board.link.settings.find("faults");
    if (faults != board.link.settings.end()) board.faults = hw::parse_faults(faults->second);
    return board;
  });
}

void check_outside(const BoardArguments& board, const std::string& links) {
  const bool has_path = !board.link.value.empty();
  if (board.link.link == "file") {
    if (!has_path) throw board_refusal(board.text, "must be file=RECORDING");
    of_board(board.text, [&] { return read_link_options<hw::FileLinkOptions>(board); });
  } else if (board.link.link == "xdma") {
    if (!has_path) {
      throw board_refusal(board.text, "must be xdma=DEVICE, say xdma=/dev/xdma0_c2h_0");
    }
    of_board(board.text, [&] { return read_link_options<hw::XdmaLinkOptions>(board); });
  } else {
    throw board_refusal(board.text, links);
  }
}

BoardArguments parse_outside_board(const std::string& text) {
  BoardArguments board = split_board(text);
  check_outside(board, "must be file=RECORDING or xdma=DEVICE, then ,key=value …");
  return board;
}

std::unique_ptr<hw::Link> with_faults(std::unique_ptr<hw::Link> link, const BoardArguments& board) {
  if (board.faults.faults.empty()) return link;
  return std::make_unique<hw::FaultLink>(std::move(link), board.faults);
}

std::unique_ptr<hw::Link> open_outside_link(const BoardArguments& board) {
  return of_board(board.text, [&] { return with_faults(open_bare(board), board); });
}

}  // namespace wobblebench::bench
