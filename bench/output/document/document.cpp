#include "bench/output/document/document.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

/// "[text](target)"; a picture's begins with "![".
std::string link(const char* begin, const std::string& text, const std::string& target) {
  return std::string(begin).append(text).append("](").append(target).append(")");
}

struct MarkdownOf {
  const Document& document;

  std::string operator()(const Heading& heading) const { return "## " + heading.text; }
  std::string operator()(const Text& text) const {
    return text.markdown.substr(0, text.markdown.find_last_not_of('\n') + 1);
  }
  std::string operator()(const KeyFigures& figures) const {
    std::string list;
    for (const KeyFigures::One& one : figures.all) {
      const std::string unit = one.unit.empty() ? "" : " " + one.unit;
      list += "- **" + one.title + "** " + one.value + unit +
              (one.failed ? ", **failed**: " : ": ") + one.help + "\n";
    }
    return (*this)(Text{list});
  }
  std::string operator()(const Table& table) const { return (*this)(Text{markdown(table)}); }
  std::string operator()(const Figure& figure) const {
    return link("[Chart: ", figure.caption, chart_file(document, figure));
  }
  std::string operator()(const Picture& picture) const {
    return link("![", picture.caption, picture.file);
  }
  std::string operator()(const PicturePair& both) const {
    return (*this)(both.left).append("\n\n").append((*this)(both.right));
  }
  std::string operator()(const MapView&) const { return ""; }
  std::string operator()(const Detail&) const { return ""; }
  std::string operator()(const Listing&) const { return ""; }
  std::string operator()(const CommandLine& command) const { return "    " + command.text; }
};

}  // namespace

std::string chart_file(const Document& document, const Figure& figure) {
  const std::string prefix = document.name.empty() ? "" : document.name + "_";
  return prefix + figure.name + ".vl.json";
}

KeyFigures& KeyFigures::add(
    std::string title, double value, std::string_view key, std::string help, bool failed) {
  const Unit& unit = unit_of(key);
  const bool formed = std::isfinite(value);
  if (!formed && !failed) return *this;
  all.push_back({std::move(title),
                 formed ? fixed(value, unit.digits) : "none",
                 unit.name,
                 std::move(help),
                 failed});
  return *this;
}

KeyFigures key_figures(const Measurements& found, Chosen measures) {
  KeyFigures figures;
  for (const Measure* measure : measures) {
    figures.add(measure->title, found.value(*measure), measure->key, measure->help);
  }
  return figures;
}

nlohmann::ordered_json tables_json(const Document& document) {
  auto json = nlohmann::ordered_json::object();
  for (const Block& block : document.blocks) {
    if (const auto* table = std::get_if<Table>(&block)) json[table->name] = to_json(*table);
  }
  return json;
}

std::string markdown(const Document& document) {
  std::string text = "# " + document.title + "\n";
  for (const Block& block : document.blocks) {
    const std::string part = std::visit(MarkdownOf{document}, block);
    if (!part.empty()) text.append("\n").append(part).append("\n");
  }
  return text;
}

}  // namespace wobblebench::bench
