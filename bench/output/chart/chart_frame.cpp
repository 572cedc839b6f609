#include "bench/output/chart/chart_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

constexpr double kEdge = 14;  // of the picture
constexpr double kTickLength = 5;
constexpr double kLegendRow = 20;
constexpr double kLegendSample = 30;  // length of the line before a name
constexpr double kLineWidth = 1.1;

double legend_width(const std::vector<LegendEntry>& legend) {
  double widest = 0;
  for (const auto& entry : legend) {
    widest = std::max(widest, Canvas::text_width(entry.name, kTickText));
  }
  return legend.empty() ? 0 : widest + kLegendSample + 20;
}

/// Margin beyond the data at each end, as a fraction of the axis.
constexpr double kMargin = 0.04;

/// Digits after the decimal point that distinguish multiples of a step.
int digits_of(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
}

double nice_step(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  }
  return 10 * decade;
}

}  // namespace

ChartFrame::ChartFrame(Canvas& canvas,
                       PictureSize size,
                       const std::string& title,
                       const std::vector<LegendEntry>& legend,
                       double left_margin,
                       bool y_label)
    : canvas_(canvas) {
  const double label = y_label ? kLabelText + 14 : 0;
  plot_.low = {kEdge + label + left_margin + kTickLength + 4, kEdge + (title.empty() ? 4 : 28)};
  plot_.high = {size.width - kEdge - legend_width(legend) - 6,
                size.height - kEdge - kTickText - kLabelText - 22};
  if (!title.empty()) {
    canvas.text({plot_.low.x, kEdge}, title, {.size = kTitleText, .down = 0});
  }
  draw_legend(legend, {plot_.high.x + 14, plot_.low.y + 10});
}

void ChartFrame::draw_legend(const std::vector<LegendEntry>& legend, Point2 at) {
  for (const LegendEntry& entry : legend) {
    const Point2 end = at + Point2(kLegendSample - 6, 0);
    if (entry.filled) {
      canvas_.fill(Box2{at - Point2(0, 6), end + Point2(0, 6)}, entry.colour);
    } else {
      canvas_.line({at, end}, entry.colour, 1.8, entry.stroke);
      canvas_.mark(0.5 * (at + end), entry.mark, entry.colour, 8);
    }
    canvas_.text({at.x + kLegendSample, at.y}, entry.name, {.size = kTickText});
    at.y += kLegendRow;
  }
}

void ChartFrame::draw_x_axis(const Ruler& ruler, const std::string& label) {
  for (const Tick& tick : ruler.ticks(kMostTicks)) {
    const double x = plot_.low.x + ruler.fraction(tick.value) * plot_.width();
    canvas_.line({{x, plot_.low.y}, {x, plot_.high.y}}, kGridInk, 1, Stroke::solid);
    canvas_.line({{x, plot_.high.y}, {x, plot_.high.y + kTickLength}}, kInk, 1, Stroke::solid);
    canvas_.text({x, plot_.high.y + kTickLength + 5},
                 tick.text,
                 {.size = kTickText, .across = 0.5, .down = 0});
  }
  canvas_.text({0.5 * (plot_.low.x + plot_.high.x), plot_.high.y + kTickLength + kTickText + 13},
               label,
               {.size = kLabelText, .across = 0.5, .down = 0});
}

void ChartFrame::draw_y_axis(const Ruler& ruler, const std::string& label) {
  for (const Tick& tick : ruler.ticks(kMostTicks)) {
    const double y = plot_.high.y - ruler.fraction(tick.value) * plot_.height();
    canvas_.line({{plot_.low.x, y}, {plot_.high.x, y}}, kGridInk, 1, Stroke::solid);
    canvas_.line({{plot_.low.x - kTickLength, y}, {plot_.low.x, y}}, kInk, 1, Stroke::solid);
    canvas_.text({plot_.low.x - kTickLength - 4, y}, tick.text, {.size = kTickText, .across = 1});
  }
  canvas_.text({kEdge + 0.5 * kLabelText, 0.5 * (plot_.low.y + plot_.high.y)},
               label,
               {.size = kLabelText, .across = 0.5, .upwards = true});
}

void ChartFrame::draw_border() {
  canvas_.line(
      {plot_.low, {plot_.high.x, plot_.low.y}, plot_.high, {plot_.low.x, plot_.high.y}, plot_.low},
      kInk,
      kLineWidth,
      Stroke::solid);
}

Ruler::Ruler(const Axis& axis, const std::vector<double>& values)
    : scale_(axis.scale), ticks_(axis.ticks) {
  const bool log = scale_ == Scale::logarithmic;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value) || (log && value <= 0)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  low_ = axis.low.value_or(low);
  high_ = axis.high.value_or(high);
  if (!std::isfinite(low_) || !std::isfinite(high_) || (log && low_ <= 0) || low_ > high_) {
    throw std::invalid_argument("axis " + axis.label + ": no values to show");
  }
  if (log) {
    const double margin = low_ == high_ ? 2 : std::pow(high_ / low_, kMargin);
    if (!axis.low) low_ /= margin;
    if (!axis.high) high_ *= margin;
    return;
  }
  double margin = kMargin * (high_ - low_);
  if (margin == 0) margin = high_ == 0 ? 1 : 0.1 * std::abs(high_);
  if (!axis.low) low_ -= margin;
  if (!axis.high) high_ += margin;
}

double Ruler::fraction(double value) const {
  if (scale_ == Scale::linear) return (value - low_) / (high_ - low_);
  return std::log(value / low_) / std::log(high_ / low_);
}

std::vector<Tick> Ruler::ticks(int most) const {
  if (!ticks_.empty()) return ticks_;
  return scale_ == Scale::linear ? linear_ticks(most) : logarithmic_ticks(most);
}

std::vector<Tick> Ruler::linear_ticks(int most) const {
  const double step = nice_step((high_ - low_) / most);
  std::vector<Tick> ticks;
  for (double n = std::ceil(low_ / step - 1e-6); n * step <= high_ + 1e-6 * step; ++n) {
    const double value = n == 0 ? 0 : n * step;  // no minus before a zero
    ticks.push_back({value, fixed(value, digits_of(step))});
  }
  return ticks;
}

std::vector<Tick> Ruler::logarithmic_ticks(int most) const {
  const double decades = std::log10(high_ / low_);
  if (decades < 0.7) return linear_ticks(most);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / most)));
  const bool between = 3 * decades <= most + 1;
  std::vector<Tick> ticks;
  for (int p = static_cast<int>(std::floor(std::log10(low_))); std::pow(10.0, p) <= high_; ++p) {
    if (p % every != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1 && !between) break;
      const double value = factor * std::pow(10.0, p);
      if (contains(value * (1 + 1e-9)) || contains(value * (1 - 1e-9))) {
        ticks.push_back({value, fixed(value, std::max(0, -p))});
      }
    }
  }
  return ticks;
}

}  // namespace wobblebench::bench
