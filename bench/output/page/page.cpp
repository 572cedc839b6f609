#include "bench/output/page/page.h"

#include <array>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "bench/output/page/page_assets.h"
#include "bench/output/page/page_text.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// JSON in a <script>: "</script>" and "<!--" cannot occur in it.
std::string script_json(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return "<script type=\"application/json\">" + safe + "</script>";
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + escaped(value) + "\"";
}

std::string caption(const std::string& text) {
  return text.empty() ? "" : "<figcaption>" + escaped(text) + "</figcaption>\n";
}

std::string header_cell(const Table& table, std::size_t i) {
  const Column& column = table.columns[i];
  const std::string kind = is_numeric(table, i) ? "number" : "text";
  std::string cell = "<th scope=\"col\" class=\"" + kind + "\">" +
                     escaped(column.title.empty() ? column.key : column.title);
  if (!column.unit.empty()) cell += " <span class=\"unit\">" + escaped(column.unit) + "</span>";
  return cell + "</th>";
}

std::string body_cell(const Cell& cell, const Column& column) {
  constexpr int kDigits = 9;
  const std::string text = escaped(cell.shown(column));
  if (cell.is_number()) {
    return "<td class=\"number\"" + attribute("data-value", significant(cell.number(), kDigits)) +
           ">" + text + "</td>";
  }
  constexpr std::size_t kLong = 60;
  return (text.size() > kLong ? "<td class=\"long\">" : "<td>") +
         (cell.is_code() ? "<code>" + text + "</code>" : text) + "</td>";
}

bool is_jpeg(const std::string& bytes) {
  return bytes.starts_with("\xff\xd8");
}

/// A picture as the address of an <img>.
std::string picture_address(const std::string& bytes) {
  return std::string("data:image/") + (is_jpeg(bytes) ? "jpeg" : "png") + ";base64," +
         base64(bytes);
}

/// Width and height of a PNG: big-endian in its first chunk (ISO/IEC 15948).
std::string size_attributes(const std::string& png) {
  constexpr std::size_t kWidthAt = 16, kHeightAt = 20, kHeader = 24;
  if (png.size() < kHeader || is_jpeg(png)) return "";
  const auto number_at = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      value = (value << 8) | static_cast<unsigned char>(png[at + i]);
    }
    return std::to_string(value);
  };
  return attribute("width", number_at(kWidthAt)) + attribute("height", number_at(kHeightAt));
}

class HtmlOf {
 public:
  HtmlOf(const Document& document, const ReadPicture& read_picture)
      : document_(document), read_picture_(read_picture) {}

  std::string operator()(const Heading& heading) const {
    return "<h2" + attribute("id", slug(heading.text)) + ">" + escaped(heading.text) + "</h2>\n";
  }
  std::string operator()(const Text& text) const { return html_of_markdown(text.markdown); }
  std::string operator()(const KeyFigures& figures) const {
    std::string html = "<dl class=\"key-figures\">\n";
    for (const KeyFigures::One& one : figures.all) {
      html += (one.failed ? "<div class=\"failed\"><dt>" : "<div><dt>") + escaped(one.title) +
              "</dt><dd><strong>" + escaped(one.value) + "</strong> " + escaped(one.unit) +
              "</dd><dd class=\"help\">" + escaped(one.help) + "</dd></div>\n";
    }
    return html + "</dl>\n";
  }
  std::string operator()(const Table& table) const {
    const std::string label = table.caption.empty() ? table.name : table.caption;
    std::string html = "<figure class=\"table\"" + attribute("id", "t-" + table.name) + ">\n" +
                       caption(table.caption) +
                       "<div class=\"scroll\" role=\"region\" tabindex=\"0\"" +
                       attribute("aria-label", label) + "><table>\n<thead><tr>";
    for (std::size_t i = 0; i < table.columns.size(); ++i) html += header_cell(table, i);
    html += "</tr></thead>\n<tbody>\n";
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      const std::string id = r < table.ids.size() ? table.ids[r] : "";
      html += id.empty() ? "<tr>" : "<tr" + attribute("data-id", id) + ">";
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        html += body_cell(table.rows[r][i], table.columns[i]);
      }
      html += "</tr>\n";
    }
    return html + "</tbody></table></div></figure>\n";
  }
  std::string operator()(const Figure& figure) const {
    std::string html = "<figure class=\"chart\"" + attribute("id", "c-" + figure.name) +
                       ">\n<div class=\"panels\">\n";
    for (const auto& panel : figure.panels) {
      html += std::visit(
          [&](const auto& chart) {
            const std::string& label = chart.title.empty() ? figure.caption : chart.title;
            return "<div class=\"panel\" role=\"img\"" + attribute("aria-label", label) + ">" +
                   script_json(specification(chart)) + "</div>\n";
          },
          panel);
    }
    html += "</div>\n";
    if (page_asset("charts.js").empty()) {
      html +=
          "<p class=\"no-charts\">This build draws no charts; the specification of this one "
          "(Vega-Lite) is <a" +
          attribute("href", chart_file(document_, figure)) + ">" +
          escaped(chart_file(document_, figure)) + "</a>.</p>\n";
    }
    return html + caption(figure.caption) + "</figure>\n";
  }
  std::string operator()(const Picture& picture) const {
    const std::string bytes = read_picture_(picture.file);
    return "<figure class=\"picture\">" + image(picture, bytes) + caption(said_of(picture, bytes)) +
           "</figure>\n";
  }
  std::string operator()(const PicturePair& both) const {
    const std::string left = read_picture_(both.left.file), right = read_picture_(both.right.file);
    return "<figure class=\"comparison\"><div class=\"pair\">" +
           image(both.left, left, " data-side=\"left\"") +
           image(both.right, right, " data-side=\"right\"") + "</div>\n<figcaption><span>" +
           escaped(said_of(both.left, left)) + "</span> <span>" +
           escaped(said_of(both.right, right)) + "</span></figcaption></figure>\n";
  }
  std::string operator()(const MapView& map) const {
    Json layers = Json::array(), classes = Json::array();
    for (const MapLayer& layer : map.layers) layers.push_back(layer_json(layer));
    for (const MapView::Class& one : map.classes) {
      classes.push_back({{"code", one.code}, {"name", one.name}, {"colour", one.colour}});
    }
    return "<figure class=\"map\"" + attribute("id", "m-" + map.name) + ">\n" +
           script_json({{"width", map.width},
                        {"height", map.height},
                        {"mm_per_pixel", map.mm_per_pixel},
                        {"layers", layers},
                        {"classes", classes},
                        {"class_codes", map.class_codes}}) +
           "\n" + caption(map.caption) + "</figure>\n";
  }
  std::string operator()(const Detail& detail) const {
    std::string html = "<template class=\"detail\"" + attribute("data-id", detail.id) + ">\n<h3>" +
                       escaped(detail.title) + "</h3>\n";
    if (!detail.command.empty()) {
      html += "<pre class=\"command\">" + escaped(detail.command) + "</pre>\n";
    }
    html += html_of_markdown(detail.text);
    if (!detail.picture_file.empty()) {
      html += image({detail.picture_file, detail.title}, read_picture_(detail.picture_file));
    }
    return html + "</template>\n";
  }
  std::string operator()(const Listing& listing) const {
    return "<details class=\"listing\"><summary>" + escaped(listing.title) +
           "</summary>\n<pre tabindex=\"0\">" + escaped(listing.text) + "</pre></details>\n";
  }
  std::string operator()(const CommandLine& command) const {
    return "<pre class=\"command\" tabindex=\"0\">" + escaped(command.text) + "</pre>\n";
  }

 private:
  static std::string image(const Picture& picture,
                           const std::string& bytes,
                           const char* more = "") {
    return "<img src=\"" + picture_address(bytes) + "\"" + attribute("alt", picture.caption) +
           size_attributes(bytes) + more + "><a class=\"blocked\"" +
           attribute("href", picture.file) + ">" + escaped(picture.file) + "</a>";
  }
  static std::string said_of(const Picture& picture, const std::string& bytes) {
    if (!is_jpeg(bytes)) return picture.caption;
    return picture.caption + " Compressed on this page; " + picture.file + " is exact.";
  }
  static Json layer_json(const MapLayer& layer) {
    return {{"name", layer.name},
            {"unit", layer.unit},
            {"colours", layer.colours == MapLayer::Colours::diverging ? "diverging" : "sequential"},
            {"low", layer.low},
            {"high", layer.high},
            {"first", layer.first},
            {"step", layer.step},
            {"codes", layer.codes}};
  }

  const Document& document_;
  const ReadPicture& read_picture_;
};

/// The bytes that hexadecimal digits stand for, as base64.
std::string base64_of_hex(std::string_view digits) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
  }
  return base64(bytes);
}

std::string source_of(std::string_view asset) {
  return "'sha256-" + base64_of_hex(page_asset_sha256(asset)) + "'";
}

bool has_figure(const Document& document) {
  for (const Block& block : document.blocks) {
    if (std::holds_alternative<Figure>(block)) return true;
  }
  return false;
}

std::string security_policy(bool with_charts) {
  return "default-src 'none'; img-src data: blob:; style-src " + source_of("page.css") +
         "; script-src " + source_of("page.js") +
         (with_charts ? " " + source_of("charts.js") : "") +
         "; base-uri 'none'; form-action 'none'";
}

/// Shown where a server, as those of CI do, forbids the style that hides it. Script and pictures
/// are then forbidden, too.
constexpr const char* kBlocked =
    "<p class=\"blocked\">The server of this page forbids its style, script and pictures: open the "
    "file from a disk, or see the pictures and tables (.md, .csv) beside it.</p>\n";

std::string script(std::string_view asset) {
  return "<script>" + std::string(page_asset(asset)) + "</script>\n";
}

}  // namespace

std::string html(const Document& document, const ReadPicture& read_picture) {
  const bool with_charts = has_figure(document) && !page_asset("charts.js").empty();
  std::string page =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
      security_policy(with_charts) + "\">\n<title>" + escaped(document.title) +
      "</title>\n<style>" + std::string(page_asset("page.css")) +
      "</style>\n</head>\n<body data-charts=\"" + (with_charts ? "yes" : "no") +
      "\">\n<header><h1>" + escaped(document.title) + "</h1></header>\n<main>\n" + kBlocked;
  const HtmlOf html_of(document, read_picture);
  for (const Block& block : document.blocks) page += std::visit(html_of, block);
  page += "</main>\n";
  if (with_charts) page += script("charts.js");
  return page + script("page.js") + "</body>\n</html>\n";
}

}  // namespace wobblebench::bench
