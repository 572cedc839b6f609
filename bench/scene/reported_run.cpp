#include "bench/scene/reported_run.h"

#include <nlohmann/json.hpp>

#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

std::string text_at(const Json& report, const char* pointer) {
  const Json text = report.value(Json::json_pointer(pointer), Json());
  return text.is_string() ? text.get<std::string>() : "";
}

}  // namespace

std::uint32_t volume_of(const Json& report, const std::string& source) {
  const Json volume = report.value(Json::json_pointer("/board/volume"), Json());
  if (volume.is_number_unsigned()) return volume.get<std::uint32_t>();
  throw UserError(source + ": does not say which volume it is of (\"board\": {\"volume\": N})");
}

std::string simulated_board_of(const Json& report, const std::string& source) {
  const std::string origin = text_at(report, "/provenance/board");
  if (origin != "simulated") {
    throw UserError(
        source + ": is of " + origin +
        " samples, which it does not hold; only a simulated run can be made again: take "
        "the recording itself");
  }
  std::string board = text_at(report, "/board/arguments");
  if (!board.empty()) return board;
  if (volume_of(report, source) == 0) return "sim";  // of before it was written
  throw UserError(source + ": does not say what --board was given: run it again");
}

}  // namespace wobblebench::bench
