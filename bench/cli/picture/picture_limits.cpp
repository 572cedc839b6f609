#include "bench/cli/picture/picture_limits.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kFrameTime = "frame_ms";

bool is_limited(const Measure& measure) {
  return measure.worse == Worse::higher || measure.worse == Worse::away_from_zero;
}

/// `measures`: null: there are none. `why_none`: as timed_picture_figures() takes it.
std::vector<LimitedFigure> figures_of(const PictureMeasures* measures,
                                      const std::string& why_none) {
  const bool formed = measures != nullptr && why_none.empty();
  const Measurements found = formed ? described(*measures, ExpectedSurface()) : Measurements();
  const std::string why = formed ? why_no_surface(measures->raw) : why_none;
  std::vector<LimitedFigure> figures;
  for (const Measure* measure : picture_measures()) {
    if (is_limited(*measure)) figures.push_back({measure->key, found.value(*measure), why});
  }
  return figures;
}

}  // namespace

const std::vector<std::string>& picture_measure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& figure : figures_of(nullptr, "")) all.push_back(figure.name);
    return all;
  }();
  return names;
}

const std::vector<std::string>& timed_picture_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = picture_measure_names();
    all.emplace_back(kFrameTime);
    return all;
  }();
  return names;
}

std::vector<LimitedFigure> picture_figures(const PictureMeasures& measures) {
  return figures_of(&measures, "");
}

std::vector<LimitedFigure> timed_picture_figures(const PictureMeasures* measures,
                                                 double frame_ms,
                                                 const std::string& why_none) {
  std::vector<LimitedFigure> figures = figures_of(measures, why_none);
  figures.push_back({kFrameTime, frame_ms});
  return figures;
}

}  // namespace wobblebench::bench
