#include "bench/output/page/report_page.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "bench/output/finished_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void add_warnings(const Json& report, std::vector<Block>& blocks) {
  Json warnings = report.value("warnings", Json::array());
  // Apart in the report, as equal runs do not share it; on the page it belongs to the times.
  const Json::json_pointer busy("/provenance/load/warning");
  if (measures_times(report) && report.contains(busy) && report.at(busy).is_string()) {
    warnings.push_back(report.at(busy));
  }
  if (warnings.empty()) return;
  Table table{.name = "warnings", .columns = {{"warning", "Warnings"}}};
  for (const Json& warning : warnings) table.add({text_of(warning)});
  blocks.emplace_back(std::move(table));
}

/// A row for each value that is one; those within a part below its name.
void add_values(const Json& values, const std::string& prefix, Table& table) {
  for (const auto& [key, value] : values.items()) {
    const bool is_nothing = value.is_null() || (value.is_string() && text_of(value).empty());
    if (is_nothing || value.is_array()) continue;
    if (value.is_object()) {
      add_values(value, prefix + key + ".", table);
    } else {
      table.add({Cell::code(prefix + key), text_of(value)});
    }
  }
}

void add_provenance(const Json& report, std::vector<Block>& blocks) {
  Table table{
      .name = "provenance", .caption = "Program and machine", .columns = {{"what"}, {"value"}}};
  add_values(report.value("provenance", Json::object()), "", table);
  blocks.emplace_back(std::move(table));
}

void add_steps(const Json& report, std::vector<Block>& blocks) {
  const Json::json_pointer place("/timing/wall_ms");
  if (!report.contains(place)) return;
  Table table{.name = "steps",
              .caption = "Wall time of the command's steps",
              .columns = {{"step"}, {"wall_ms", "time", "ms", 0}}};
  for (const auto& [step, ms] : report.at(place).items()) {
    table.add({step, ms.is_number() ? Cell(ms.get<double>()) : Cell()});
  }
  blocks.emplace_back(std::move(table));
}

void add_scene(const Json& report, std::vector<Block>& blocks) {
  for (const char* key : {"scene", "scenes", "plan"}) {
    if (!report.contains(key) || report.at(key).is_null()) continue;
    const bool is_scene = std::string(key) != "plan";
    blocks.emplace_back(
        Listing{is_scene ? "The scene, every option as it was used" : "The plan",
                report.at(key).dump(2, ' ', false, Json::error_handler_t::replace)});
  }
}

std::size_t leading_blocks(const Document& document) {
  const auto figures = std::ranges::find_if(
      document.blocks, [](const Block& one) { return std::holds_alternative<KeyFigures>(one); });
  const auto all = static_cast<std::size_t>(figures - document.blocks.begin());
  return std::min(document.blocks.size(), all < document.blocks.size() ? all + 1 : 1);
}

}  // namespace

std::string report_page(Document document,
                        const std::string& report,
                        const std::string& command_line,
                        const ReadPicture& read_picture) {
  const Json json = Json::parse(report);
  std::vector<Block> blocks;
  // What leads a document is the answer to what was asked: whether it holds, and its figures.
  const std::size_t leading = leading_blocks(document);
  const auto rest = document.blocks.begin() + static_cast<std::ptrdiff_t>(leading);
  std::move(document.blocks.begin(), rest, std::back_inserter(blocks));
  add_warnings(json, blocks);
  std::move(rest, document.blocks.end(), std::back_inserter(blocks));
  blocks.emplace_back(Heading{"How it was made"});
  blocks.emplace_back(CommandLine{command_line});
  add_provenance(json, blocks);
  add_steps(json, blocks);
  add_scene(json, blocks);
  document.blocks = std::move(blocks);
  return html(document, read_picture);
}

}  // namespace wobblebench::bench
