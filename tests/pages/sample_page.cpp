// sample_page FOLDER: writes sample.html, a page with every kind of block, values that are known,
// and names that hold markup; and long.html, with a table of ten thousand rows.
#include <cstdlib>
#include <fstream>
#include <glm/vec3.hpp>
#include <iterator>
#include <limits>
#include <string>

#include "base/image.h"
#include "bench/output/document/document.h"
#include "bench/output/image_io.h"
#include "bench/output/page/page.h"

namespace wobblebench::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const std::string kMarkup = "<img src=x onerror=\"window.ran=1\">";
const std::string kScriptEnd = "</script><script>window.ran=1</script>";

std::string id(int point) {
  return "point " + std::to_string(point);
}

// Made by Python's zlib: of pixel (column, row) of 8 by 6, the code 100 * row + column, none at (2,
// 1); and class 1 at (2, 1), class 2 at (5, 4).
const std::string kCodes =
    "eJwFwesZgQAAQNF7UZYJqZXyhZaRPFYiZBmVx4+"
    "cAzJizISAkCkZK4YhZ82GLQUXrtTcuPOg4UnkzLkLY5cmpu4s3Vt58OjJsy9bO3vffvz68w/O/hk5";
const std::string kClasses = "eJxjYIABRgacgAnBBAAAbAAE";

/// Twelve points whose detail holds a command; of some, a value is not finite.
Figure front() {
  Series points{.name = "settings " + kMarkup, .stroke = Stroke::none, .mark = Mark::disc};
  for (int i = 0; i < 12; ++i) {
    points.add(100.0 * (i + 1), i == 4 ? kNone : 3.0 / (i + 1));
    points.ids.push_back(id(i));
    points.notes.push_back(kScriptEnd);
  }
  return {"front",
          "Error against time.",
          {Chart{.title = "Front",
                 .x = {.label = "time (ms)", .scale = Scale::logarithmic},
                 .y = {.label = "error (mm)"},
                 .series = {points}}}};
}

Figure figure_of(std::string name, double x, double y) {
  Series series{.name = "only", .mark = Mark::disc};
  series.add(x, y);
  return {std::move(name),
          "One point.",
          {Chart{.title = "One", .x = {.label = "x"}, .y = {.label = "y"}, .series = {series}}}};
}

Table points_table() {
  Table table{.name = "points",
              .caption = "Points of the front",
              .columns = {{"name"}, {"time_ms", "time", "ms", 0}, {"error_mm", "error", "mm", 2}}};
  for (int i = 0; i < 12; ++i) {
    table.add({i == 3 ? kMarkup : id(i), 100.0 * (i * 5 % 12 + 1), i == 4 ? kNone : 3.0 / (i + 1)},
              id(i));
  }
  return table;
}

Document long_table() {
  Table table{.name = "long", .caption = "Ten thousand rows", .columns = {{"row"}, {"value"}}};
  for (int i = 0; i < 10'000; ++i) table.add({"row " + std::to_string(i), i * 7919 % 10'000});
  return Document{.title = "Long"}.add(table);
}

MapView map_view() {
  return {
      .name = "error",
      .caption = "Known values.",
      .width = 8,
      .height = 6,
      .mm_per_pixel = 5,
      .layers = {{"signed error", "mm", MapLayer::Colours::diverging, -3, 3, -2.5, 0.01, kCodes},
                 {"depth", "mm", MapLayer::Colours::sequential, 0, 600, 50, 1, kCodes}},
      .classes = {{1, "missed", "#d55e00"}, {2, "false surface", "#009e73"}},
      .class_codes = kClasses};
}

Document sample() {
  Document page{.title = "Sample " + kMarkup};
  page.add(Heading{"Text"})
      .add(Text{"A **strong** word, `code`, " + kMarkup + " and\n\n- one\n- two"});
  page.add(Heading{"Pictures"}).add(PicturePair{{"left.png", "Red"}, {"right.png", "Blue"}});
  page.add(map_view());
  page.add(Heading{"Charts"})
      .add(front())
      .add(figure_of("one", 1, 2))
      .add(figure_of("none", kNone, kNone));
  page.add(points_table());
  for (int i = 0; i < 12; ++i) {
    page.add(Detail{.id = id(i),
                    .title = "Setting " + id(i) + kMarkup,
                    .command = "wobblebench run --set x=" + std::to_string(i),
                    .text = kMarkup,
                    .picture_file = i == 3 ? "left.png" : ""});
  }
  page.add(Listing{"Scene " + kMarkup, kScriptEnd});
  return page;
}

void write_pictures(const std::filesystem::path& folder) {
  for (const auto& [name, colour] :
       {std::pair{"left.png", glm::vec3{1, 0, 0}}, std::pair{"right.png", glm::vec3{0, 0, 1}}}) {
    write_png(folder / name, Image<glm::vec3>(200, 150, colour));
  }
}

}  // namespace
}  // namespace wobblebench::bench

int main(int argc, char** argv) {
  using namespace wobblebench::bench;
  if (argc != 2) return EXIT_FAILURE;
  const std::filesystem::path folder = argv[1];
  write_pictures(folder);
  const auto bytes_of = [&](const std::string& file) {
    std::ifstream picture(folder / file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(picture), {});
  };
  std::ofstream(folder / "sample.html") << html(sample(), bytes_of);
  std::ofstream(folder / "long.html") << html(long_table(), bytes_of);
}
