// What a command has found, for people: text, tables, charts and pictures in reading order. It is
// written as Markdown (NAME.md) and as a page (report.html).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "bench/output/document/chart.h"
#include "bench/output/document/table.h"

namespace wobblebench::bench {

struct Heading {
  std::string text;
};

/// Plain text in Markdown's syntax, of which pages know paragraphs (parted by an empty line), lists
/// ("- " at the start of a line), `code`, **strong** and [text](link).
struct Text {
  std::string markdown;
};

/// The figures that answer what was asked, large.
struct KeyFigures {
  struct One {
    std::string title;    ///< "P95"
    std::string value;    ///< "1.31"
    std::string unit;     ///< "mm"; empty: none
    std::string help;     ///< what it is, or what it is held against, in one sentence
    bool failed = false;  ///< it is not as was asked
  };
  std::vector<One> all;

  /// With the unit and the digits of a measure's key ("p95_mm"). What is not formed is left out,
  /// or "none" where that fails.
  KeyFigures& add(
      std::string title, double value, std::string_view key, std::string help, bool failed = false);
};
/// Those of `measures` that are formed.
KeyFigures key_figures(const Measurements& found, Chosen measures);

/// A PNG that the command stages.
struct Picture {
  std::string file;     ///< name in the output folder
  std::string caption;  ///< one sentence
};

/// Two pictures of one size that the page lays over each other: swipe, side by side, difference.
struct PicturePair {
  Picture left, right;
};

/// One quantity of a MapView, a value a pixel.
struct MapLayer {
  enum class Colours { diverging, sequential };
  std::string name;  ///< "signed error"
  std::string unit;  ///< "mm"
  Colours colours = Colours::sequential;
  double low = 0;   ///< value at the first colour …
  double high = 1;  ///< … and at the last
  /// value = first + step * code: `codes` is the base64 text of zlib's compressed little-endian
  /// uint16, row by row from the top; 65535: no value.
  double first = 0;
  double step = 1;
  std::string codes;
};

/// Maps of one size whose values the page shows under the pointer, and in which it marks classes of
/// pixels (missed, false surface) in colours of their own. Not in Markdown.
struct MapView {
  std::string name;  ///< of [a-z0-9_]
  std::string caption;
  int width = 0, height = 0;
  double mm_per_pixel = 0;  ///< for a scale bar of 10 mm; 0: none
  std::vector<MapLayer> layers;
  struct Class {
    int code;
    std::string name;    ///< "missed"
    std::string colour;  ///< "#d55e00"
  };
  std::vector<Class> classes = {};
  std::string class_codes = {};  ///< base64 text of zlib's compressed uint8; 0: none of them
};

/// What the page shows when the point of a chart, or the row of a table, with this id is chosen.
struct Detail {
  std::string id;
  std::string title;
  std::string command = {};       ///< makes it again; empty: none
  std::string text = {};          ///< as Text
  std::string picture_file = {};  ///< as Picture; empty: none
};

/// Long text that the page shows on demand, set in type of one width. Not in Markdown.
struct Listing {
  std::string title;
  std::string text;
};

/// A line of a shell that a reader may copy.
struct CommandLine {
  std::string text;
};

using Block = std::variant<Heading,
                           Text,
                           KeyFigures,
                           Table,
                           Figure,
                           Picture,
                           PicturePair,
                           MapView,
                           Detail,
                           Listing,
                           CommandLine>;

/// A table that is a file of its own.
struct DataFile {
  std::string file;  ///< "accuracy.csv"
  Table table;
};

struct Document {
  std::string title;
  /// Of its files: NAME.md, and NAME_FIGURE.vl.json of each figure. Empty: a page alone.
  std::string name = {};
  std::vector<Block> blocks = {};
  std::vector<DataFile> data = {};

  Document& add(Block block) {
    blocks.push_back(std::move(block));
    return *this;
  }
};

/// NAME_FIGURE.vl.json.
std::string chart_file(const Document& document, const Figure& figure);

/// Its tables by their names, for report.json.
nlohmann::ordered_json tables_json(const Document& document);

/// Charts are links to their files, which script/charts draws. Details, maps and listings are left
/// out.
std::string markdown(const Document& document);

}  // namespace wobblebench::bench
