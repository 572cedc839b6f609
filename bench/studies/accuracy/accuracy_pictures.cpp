#include <algorithm>
#include <utility>

#include "bench/output/image_io.h"
#include "bench/output/picture/canvas.h"
#include "bench/studies/accuracy/accuracy_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kSide = 150, kGap = 6, kTop = 26, kLeft = 120;
constexpr double kText = 13;

/// In the order of their first picture, the truth last.
std::vector<std::string> columns_of(const AccuracyResults& results) {
  std::vector<std::string> names;
  for (const AccuracyPicture& picture : results.pictures) {
    if (picture.setting == "truth") continue;
    if (std::find(names.begin(), names.end(), picture.setting) == names.end()) {
      names.push_back(picture.setting);
    }
  }
  names.emplace_back("truth");
  return names;
}

std::vector<std::pair<std::string, std::string>> rows_of(const AccuracyResults& results) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const AccuracyPicture& picture : results.pictures) {
    const std::pair row{picture.scene, picture.rung};
    if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
  }
  return rows;
}

template <class Values, class Value>
int number_of(const Values& values, const Value& value) {
  return static_cast<int>(std::find(values.begin(), values.end(), value) - values.begin());
}

}  // namespace

std::string accuracy_picture_file(const AccuracyPicture& picture) {
  return "accuracy_" + picture.scene + "_" + picture.rung + "_" + picture.setting + ".png";
}

Image<glm::vec3> accuracy_sheet(const AccuracyResults& results) {
  const auto columns = columns_of(results);
  const auto rows = rows_of(results);
  const auto at = [](int number) { return number * (kSide + kGap); };
  Canvas canvas(kLeft + at(static_cast<int>(columns.size())),
                kTop + at(static_cast<int>(rows.size())));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double middle = kLeft + at(static_cast<int>(i)) + 0.5 * kSide;
    canvas.text({middle, 0.5 * kTop}, columns[i], {.size = kText, .across = 0.5});
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double middle = kTop + at(static_cast<int>(i)) + 0.5 * kSide;
    canvas.text({kGap, middle - 10}, rows[i].first, {.size = kText});
    canvas.text({kGap, middle + 10}, rows[i].second, {.size = kText});
  }
  for (const AccuracyPicture& picture : results.pictures) {
    const Point2 corner(kLeft + at(number_of(columns, picture.setting)),
                        kTop + at(number_of(rows, std::pair(picture.scene, picture.rung))));
    canvas.picture({corner, corner + Point2(kSide, kSide)}, encoded(picture.surface));
  }
  return canvas.finish();
}

}  // namespace wobblebench::bench
