#include "bench/studies/fit/judgement.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/statistics.h"
#include "base/units.h"

namespace wobblebench::bench {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Sums of errors in bins of equal width.
class Bins {
 public:
  Bins(std::string quantity, double low, double high, int count)
      : quantity_(std::move(quantity)), low_(low), width_((high - low) / count) {
    bins_.resize(static_cast<std::size_t>(count));
  }
  void add(double at, double before_mm, double after_mm) {
    const double place = (at - low_) / width_;
    if (!(place >= 0) || place >= static_cast<double>(bins_.size())) return;
    ResidualBin& bin = bins_[static_cast<std::size_t>(place)];
    ++bin.pixels;
    bin.before_mm += before_mm;
    bin.after_mm += after_mm;
  }
  void finish(std::vector<ResidualBin>& all) {
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      ResidualBin bin = bins_[i];
      if (bin.pixels < kLeastPixels) continue;
      bin.quantity = quantity_;
      bin.at = low_ + (static_cast<double>(i) + 0.5) * width_;
      bin.before_mm /= bin.pixels;
      bin.after_mm /= bin.pixels;
      all.push_back(bin);
    }
  }

 private:
  static constexpr int kLeastPixels = 50;
  std::string quantity_;
  double low_, width_;
  std::vector<ResidualBin> bins_;
};

/// Over the pixels that both have; NaN where one does not vary.
double picture_correlation(const Image<float>& one, const Image<float>& other) {
  std::vector<double> a, b;
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    if (!std::isfinite(one.pixels[i]) || !std::isfinite(other.pixels[i])) continue;
    a.push_back(static_cast<double>(one.pixels[i]));
    b.push_back(static_cast<double>(other.pixels[i]));
  }
  return correlation(a, b);
}

}  // namespace

void PictureEffect::add(const PictureMeasures& measures, double share) {
  median_mm += share * measures.raw.depth.median_m / kMillimetre;
  p95_mm += share * measures.raw.depth.p95_m / kMillimetre;
  missed_percent += share * measures.raw.missed_percent();
  false_percent += share * measures.raw.false_percent();
  for (const RegionError& region : measures.regions) {
    if (region.group != "silhouette" || region.name != "outside") continue;
    outside_rms_mm += share * region.depth.rms_m / kMillimetre;
  }
}

double reproducible_variance(const std::vector<ScannedErrors>& scans) {
  double sum = 0, pairs = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (std::size_t j = i + 1; j < scans.size(); ++j, ++pairs) {
      sum += picture_correlation(scans[i].error_m, scans[j].error_m);
    }
  }
  return pairs > 0 ? sum / pairs : kNone;
}

Judgement judge(const std::string& name,
                const std::string& of,
                const std::vector<ErrorRow>& rows,
                const DetectionModel& model) {
  Judgement result{.name = name, .of = of, .pixels = static_cast<int>(rows.size())};
  if (rows.empty()) return result;
  const auto n = static_cast<double>(rows.size());
  double sum = 0, squares = 0, left_sum = 0, left_squares = 0, one = 0, two = 0;
  for (const ErrorRow& row : rows) {
    const double e = static_cast<double>(row.error_m) / kMillimetre;
    const double left = e - model.bias_m(row.pixel) / kMillimetre;
    const double spread = model.spread_m(row.pixel) / kMillimetre;
    sum += e, squares += e * e, left_sum += left, left_squares += left * left;
    one += std::abs(left) <= spread, two += std::abs(left) <= 2 * spread;
  }
  result.mean_before_mm = sum / n;
  result.mean_after_mm = left_sum / n;
  result.rms_before_mm = std::sqrt(squares / n);
  result.rms_after_mm = std::sqrt(left_squares / n);
  result.explained_variance = 1 - left_squares / (squares - sum * sum / n);
  result.removed_mean_square = 1 - left_squares / squares;
  result.reproducible_variance = kNone;
  result.within_one_percent = 100 * one / n;
  result.within_two_percent = 100 * two / n;
  return result;
}

ResidualPicture residual_picture(const std::string& name,
                                 const ScannedErrors& scan,
                                 const DetectionModel& model) {
  ResidualPicture result{name, scan.error_m, scan.error_m, scan.error_m};
  for (std::size_t i = 0; i < scan.error_m.pixels.size(); ++i) {
    if (!std::isfinite(scan.error_m.pixels[i])) continue;
    result.bias_m.pixels[i] = static_cast<float>(model.bias_m(scan.terms.pixels[i]));
    result.left_m.pixels[i] = scan.error_m.pixels[i] - result.bias_m.pixels[i];
  }
  return result;
}

std::vector<ResidualBin> residual_bins(const std::vector<ErrorRow>& rows,
                                       const DetectionModel& model) {
  Bins incidence("incidence_deg", 0, 75, 15), range("range_mm", 20, 160, 14),
      contrast("contrast", 0, 0.45, 9);
  for (const ErrorRow& row : rows) {
    const double before = static_cast<double>(row.error_m) / kMillimetre;
    const double after = before - model.bias_m(row.pixel) / kMillimetre;
    incidence.add(static_cast<double>(row.pixel.incidence_rad) / kDegree, before, after);
    range.add(static_cast<double>(row.pixel.x[kDepthTerm]) + 75, before, after);
    contrast.add(static_cast<double>(row.pixel.x[kContrastTerm]), before, after);
  }
  std::vector<ResidualBin> all;
  for (Bins* bins : {&incidence, &range, &contrast}) bins->finish(all);
  return all;
}

}  // namespace wobblebench::bench
