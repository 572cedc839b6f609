#include "bench/cli/picture/picture_limits.h"

#include <algorithm>
#include <limits>

#include "bench/studies/trade/trade_journal.h"

namespace wobblebench::bench {

namespace {

constexpr const char* kFrameTime = "frame_ms";
constexpr double kNotFormed = std::numeric_limits<double>::quiet_NaN();

/// More of these is better, or neither better nor worse.
bool is_limited(const std::string& name) {
  return name != "pixels" && name != "surface_percent" && name != "ssim";
}

/// Adds what the figures do not have yet.
void add(const std::vector<std::string>& names,
         const std::vector<double>& values,
         std::vector<LimitedFigure>& figures) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!is_limited(names[i])) continue;
    if (std::ranges::find(figures, names[i], &LimitedFigure::name) != figures.end()) continue;
    figures.push_back({names[i], values.empty() ? kNotFormed : values[i]});
  }
}

/// `measures`: null: there are none. `why_none`: as timed_picture_figures() takes it.
std::vector<LimitedFigure> figures_of(const PictureMeasures* measures,
                                      const std::string& why_none) {
  const bool formed = measures != nullptr && why_none.empty();
  std::vector<double> whole, traded;
  if (formed) {
    whole = measure_rows(*measures).front().values;
    traded = trade_measures(*measures);
  }
  std::vector<LimitedFigure> figures;
  add(trade_measure_names(), traded, figures);
  add(measure_names(), whole, figures);
  const std::string why = formed ? why_no_surface(measures->raw) : why_none;
  for (LimitedFigure& figure : figures) figure.because = why;
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
