#include <algorithm>
#include <cmath>

#include "bench/studies/fit/fit_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kPanelWidth = 300;
/// Grey 0 and 1 of the maps; no error is 0.5.
constexpr double kShown_m = 5e-3;

Image<float> grey(const Image<float>& error_m) {
  Image<float> values(error_m.width, error_m.height, 0.0f);
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const double error = static_cast<double>(error_m.pixels[i]);
    if (!std::isfinite(error)) continue;
    values.pixels[i] = static_cast<float>(std::clamp(0.5 + 0.5 * error / kShown_m, 0.0, 1.0));
  }
  return values;
}

Picture3 draw_bins(const ModelStudy& study, const std::string& quantity, const std::string& label) {
  Chart chart{"", {label}, {"mean error (mm)"}};
  Series before{"found", {}, {}, Stroke::solid, Mark::disc};
  Series after{"corrected", {}, {}, Stroke::solid, Mark::square};
  for (const ResidualBin& bin : study.bins) {
    if (bin.quantity != quantity) continue;
    before.x.push_back(bin.at), before.y.push_back(bin.before_mm);
    after.x.push_back(bin.at), after.y.push_back(bin.after_mm);
  }
  if (before.x.empty()) return {};
  chart.series = {before, after};
  return draw(chart, {420, 340});
}

}  // namespace

std::vector<Figure> fit_figures(const ModelStudy& study) {
  std::vector<Figure> figures;
  std::vector<Picture3> charts;
  for (const auto& [quantity, label] : {std::pair{"incidence_deg", "incidence (deg)"},
                                        {"range_mm", "range (mm)"},
                                        {"contrast", "contrast (of full scale)"}}) {
    auto chart = draw_bins(study, quantity, label);
    if (!chart.pixels.empty()) charts.push_back(std::move(chart));
  }
  if (!charts.empty()) {
    figures.push_back({"fit_residuals",
                       "Mean error of all held-out pixels, found and corrected.",
                       side_by_side(charts)});
  }
  for (const ResidualPicture& picture : study.pictures) {
    const std::vector<GreyPanel> panels = {{"error", grey(picture.error_m)},
                                           {"model's bias", grey(picture.bias_m)},
                                           {"left", grey(picture.left_m)}};
    figures.push_back(
        {"fit_residuals_" + picture.name,
         "Held out (" + picture.name + "): error, the model's bias, what is left.",
         draw(panels, "black: 5 mm too near or no surface, white: 5 mm too far", kPanelWidth)});
  }
  return figures;
}

}  // namespace wobblebench::bench
