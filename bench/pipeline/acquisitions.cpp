#include "bench/pipeline/acquisitions.h"

#include <variant>

#include "bench/exchange/files/foreign_names.h"
#include "hw/recording/file_link.h"
#include "hw/recording/recording_reader.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::bench {

namespace {

/// A fraction of a second: of longer recordings `inspect` tells.
constexpr std::uint64_t kSearchedBytes = 256 << 20;

bool holds_several(const std::string& path) {
  const hw::RecordingFile file(path);
  hw::RecordingReader reader(file, 0, kSearchedBytes);
  hw::StreamAudit audit;
  int acquisitions = 0;
  try {
    while (const auto recorded = reader.next()) {
      if (!recorded->packet) continue;
      if (const auto* stick = std::get_if<hw::StickPacket>(&*recorded->packet)) {
        if (audit.take(stick->stick).accepted) audit.deliver();
      } else if (const auto* packet = std::get_if<hw::ConfigurationPacket>(&*recorded->packet)) {
        if (audit.take(*packet).accepted && ++acquisitions > 1) return true;
      }
    }
  } catch (const hw::UnreadableStream&) {
    // Said by whoever reads so far.
  }
  return false;
}

}  // namespace

bool holds_several_acquisitions(const BoardArguments& board) {
  if (board.link.link != "file") return false;
  if (foreign_format(board.link.value) != ForeignFormat::none) return false;
  if (read_link_options<hw::FileLinkOptions>(board).acquisition != 0) return false;
  return of_board(board.text, [&] { return holds_several(board.link.value); });
}

std::string acquisitions_warning(const BoardArguments& board) {
  if (!holds_several_acquisitions(board)) return "";
  return "--board = " + board.text +
         ": holds several acquisitions; acquisition=N takes one, without it the first is taken "
         "(`wobblebench inspect` lists them)";
}

}  // namespace wobblebench::bench
