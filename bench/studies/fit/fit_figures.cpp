#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "base/statistics.h"
#include "base/units.h"
#include "bench/output/picture/error_picture.h"
#include "bench/studies/fit/fit_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kPanelWidth = 300;
/// Share of the errors that the colours of a map tell apart.
constexpr double kShownShare = 0.98;

const Image<float>* maps_of(const ResidualPicture& picture, std::size_t number) {
  const Image<float>* const maps[] = {&picture.error_m, &picture.bias_m, &picture.left_m};
  return maps[number];
}

/// The sizes of all values of a picture's three maps, mm.
std::vector<double> sizes_mm(const ResidualPicture& picture) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const float value_m : maps_of(picture, i)->pixels) {
      const double size = std::abs(static_cast<double>(value_m)) / kMillimetre;
      if (std::isfinite(size)) sizes.push_back(size);
    }
  }
  return sizes;
}

/// Rounded up to one digit: 1.83 becomes 2, 0.031 becomes 0.04.
double rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)));
  return std::ceil(value / unit - 1e-9) * unit;
}

Panel residual_panel(const Image<float>& values_m,
                     double limit_mm,
                     const std::string& title,
                     const std::string& label) {
  Panel panel = error_panel(values_m, {}, limit_mm);
  panel.title = title;
  panel.bar->label = label;
  panel.names = {{display_colour(kNothing), "no surface to compare"}};
  return panel;
}

Chart bins_chart(const ModelStudy& study, const std::string& quantity, const std::string& label) {
  Chart chart{.title = "", .x = {.label = label}, .y = {.label = "mean error (mm)"}};
  Series before{.name = "found", .mark = Mark::ring, .colour = 1};
  Series after{.name = "corrected", .stroke = Stroke::dashed, .mark = Mark::disc, .colour = 0};
  for (const ResidualBin& bin : study.bins) {
    if (bin.quantity != quantity) continue;
    const std::string note = std::to_string(bin.pixels) + " pixels";
    before.add(bin.at, bin.before_mm);
    before.notes.push_back(note);
    after.add(bin.at, bin.after_mm);
    after.notes.push_back(note);
  }
  chart.series = {before, after};
  return chart;
}

}  // namespace

std::vector<Figure> fit_figures(const ModelStudy& study) {
  Figure figure{"residuals", "Mean error of all held-out pixels, found and corrected.", {}};
  for (const auto& [quantity, label] : {std::pair{"incidence_deg", "incidence (deg)"},
                                        {"range_mm", "range (mm)"},
                                        {"contrast", "contrast (of full scale)"}}) {
    Chart chart = bins_chart(study, quantity, label);
    if (!chart.series.front().x.empty()) figure.panels.emplace_back(std::move(chart));
  }
  if (figure.panels.empty()) return {};
  return {figure};
}

std::string residuals_file(const ResidualPicture& picture) {
  return "fit_residuals_" + picture.name + ".png";
}

double residuals_limit_mm(const ResidualPicture& picture) {
  const auto sizes = sizes_mm(picture);
  const double shown_mm = sizes.empty() ? 0 : quantile(sizes, kShownShare);
  return shown_mm > 0 ? rounded_up(shown_mm) : 1;
}

std::string residuals_caption(const ResidualPicture& picture) {
  const std::string scans = "Held out (" + picture.name + "): ";
  if (sizes_mm(picture).empty()) {
    return scans + "nothing is found near a true surface, so there is no error to show.";
  }
  constexpr int kDigits = 1;
  return scans +
         "error along the ray, the model's bias, and what is left without it. Colours end at ±" +
         significant(residuals_limit_mm(picture), kDigits) +
         " mm, which is the 98th percentile of the sizes in the three maps, rounded up.";
}

Image<glm::vec3> residuals_picture(const ResidualPicture& picture) {
  const double limit_mm = residuals_limit_mm(picture);
  std::vector<Panel> panels = {
      residual_panel(picture.error_m, limit_mm, "error", "found minus true (mm)"),
      residual_panel(picture.bias_m, limit_mm, "model's bias", "bias (mm)"),
      residual_panel(picture.left_m, limit_mm, "left", "error minus bias (mm)")};
  for (Panel& panel : panels) {
    if (sizes_mm(picture).empty()) panel.instead = "no surface to compare";
  }
  return draw_panels(panels, kPanelWidth);
}

}  // namespace wobblebench::bench
