#include "bench/evaluation/measures/picture_measures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "base/statistics.h"
#include "render/reference/reference.h"

namespace wobblebench::bench {

namespace {

/// Grazing surfaces may be found or not, but where they are a picture has no hole.
Image<float> with_grazing(const Truth& truth) {
  Image<float> depth_m = truth.depth_m;
  for (std::size_t i = 0; i < truth.crossing_m.pixels.size(); ++i) {
    if (truth.kind.pixels[i] == TruthKind::grazing) depth_m.pixels[i] = truth.crossing_m.pixels[i];
  }
  return depth_m;
}

/// Side of the similarity index's window, pixels; smaller pictures have no index.
constexpr int kWindow = 11;

cv::Mat luminance(const Image<glm::vec3>& image) {
  cv::Mat1d grey(image.height, image.width);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const glm::dvec3 rgb(image.at(column, row));
      grey(row, column) = 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;  // Rec. 709
    }
  }
  return grey;
}

cv::Mat windowed(const cv::Mat& image) {
  cv::Mat mean;
  cv::GaussianBlur(image, mean, {kWindow, kWindow}, 1.5);
  return mean;
}

/// What a row is filled from: the whole picture, or one of its regions.
struct Source {
  const PictureMeasures& picture;
  const RegionError* region;  ///< null: the whole picture

  const DepthStatistics& depth() const { return region ? region->depth : picture.raw.depth; }
  const NormalStatistics& normal() const {
    return region ? region->normal : picture.filtered.normal;
  }
  const NormalStatistics& raw_normal() const {
    return region ? region->raw_normal : picture.raw.normal;
  }
  int surface() const { return region ? region->surface : picture.raw.surface; }
  int missed() const { return region ? region->missed : picture.raw.missed; }
  double share(int count) const { return 100.0 * count / picture.raw.pixels; }

  double missed_percent() const { return surface() > 0 ? share(missed()) : kUnset; }
  double missed_surface_percent() const {
    return region ? region->missed_surface_percent() : picture.raw.missed_surface_percent();
  }
  double false_percent() const {
    if (!picture.raw.surface_in_view()) return kUnset;
    if (!region) return picture.raw.false_percent();
    return region->group == "silhouette" ? share(region->false_surface) : kUnset;
  }
  double false_surface_percent() const {
    const bool formed = !region && picture.raw.surface_in_view();
    return formed ? picture.raw.false_surface_percent() : kUnset;
  }
  /// Percentage of the pixels that sticks graze.
  double grazing_missed_percent() const {
    const RegionError* grazing = region ? nullptr : picture.grazing();
    return grazing ? grazing->missed_pixels_percent() : kUnset;
  }
  double grazing_p95_m() const {
    const RegionError* grazing = region ? nullptr : picture.grazing();
    return grazing ? grazing->depth.p95_m : kUnset;
  }
  double distance(double SurfaceDistance::*member) const {
    return region || !picture.distance ? kUnset : *picture.distance.*member / kMillimetre;
  }
};

using Column = std::pair<std::string, std::function<double(const Source&)>>;

const std::vector<Column>& columns() {
  static const std::vector<Column> all = {
      {"bias_mm", [](const Source& s) { return s.depth().bias_m / kMillimetre; }},
      {"median_mm", [](const Source& s) { return s.depth().median_m / kMillimetre; }},
      {"rms_mm", [](const Source& s) { return s.depth().rms_m / kMillimetre; }},
      {"p95_mm", [](const Source& s) { return s.depth().p95_m / kMillimetre; }},
      {"max_mm", [](const Source& s) { return s.depth().max_m / kMillimetre; }},
      {"outliers_percent", [](const Source& s) { return 100 * s.depth().outlier_share; }},
      {"pixels", [](const Source& s) { return 1.0 * s.depth().n; }},
      {"surface_percent", [](const Source& s) { return s.share(s.surface()); }},
      {"missed_percent", [](const Source& s) { return s.missed_percent(); }},
      {"missed_surface_percent", [](const Source& s) { return s.missed_surface_percent(); }},
      {"false_percent", [](const Source& s) { return s.false_percent(); }},
      {"false_surface_percent", [](const Source& s) { return s.false_surface_percent(); }},
      {"grazing_missed_percent", [](const Source& s) { return s.grazing_missed_percent(); }},
      {"grazing_p95_mm", [](const Source& s) { return s.grazing_p95_m() / kMillimetre; }},
      {"normal_mean_deg", [](const Source& s) { return s.normal().mean_rad / kDegree; }},
      {"normal_median_deg", [](const Source& s) { return s.normal().median_rad / kDegree; }},
      {"normal_p95_deg", [](const Source& s) { return s.normal().p95_rad / kDegree; }},
      {"raw_normal_mean_deg", [](const Source& s) { return s.raw_normal().mean_rad / kDegree; }},
      {"raw_normal_median_deg",
       [](const Source& s) { return s.raw_normal().median_rad / kDegree; }},
      {"raw_normal_p95_deg", [](const Source& s) { return s.raw_normal().p95_rad / kDegree; }},
      {"distance_mean_mm", [](const Source& s) { return s.distance(&SurfaceDistance::mean_m); }},
      {"distance_p95_mm", [](const Source& s) { return s.distance(&SurfaceDistance::p95_m); }},
      {"hausdorff95_mm",
       [](const Source& s) { return s.distance(&SurfaceDistance::hausdorff95_m); }},
      {"ssim", [](const Source& s) { return s.region ? kUnset : s.picture.shaded.ssim; }}};
  return all;
}

MeasureRow row_of(const std::string& group, const std::string& region, const Source& source) {
  MeasureRow row{group, region, {}};
  for (const auto& [name, value] : columns()) row.values.push_back(value(source));
  return row;
}

}  // namespace

ImageSimilarity compare_images(const Image<glm::vec3>& a, const Image<glm::vec3>& b) {
  if (a.width != b.width || a.height != b.height || std::min(a.width, a.height) < kWindow) {
    throw std::invalid_argument(
        "compare_images: pictures must be of one size, 11 pixels a side or more");
  }
  const cv::Mat x = luminance(a), y = luminance(b);
  const double mse = cv::norm(x, y, cv::NORM_L2SQR) / static_cast<double>(x.total());
  const cv::Mat mx = windowed(x), my = windowed(y);
  const cv::Mat vx = windowed(x.mul(x)) - mx.mul(mx);
  const cv::Mat vy = windowed(y.mul(y)) - my.mul(my);
  const cv::Mat vxy = windowed(x.mul(y)) - mx.mul(my);
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  const cv::Mat top = (2 * mx.mul(my) + kC1).mul(2 * vxy + kC2);
  const cv::Mat bottom = (mx.mul(mx) + my.mul(my) + kC1).mul(vx + vy + kC2);
  return {cv::mean(cv::Mat(top / bottom))[0], -10 * std::log10(mse)};
}

Image<glm::vec3> shade_truth(const Truth& truth,
                             const render::RenderOptions& options,
                             const Image<glm::vec3>& volume) {
  if (options.ray_casting.image_size < kWindow) return {};
  return render::shade_depth(with_grazing(truth), options, volume).surface;
}

PictureMeasures measure_picture(const render::Picture& picture,
                                const TrueView& view,
                                const render::RenderOptions& options,
                                const MeasureChoice& choice,
                                const Image<glm::vec3>* shaded_truth) {
  PictureMeasures measures;
  const Truth& truth = view.truth;
  measures.raw = measure_depth_error(picture.depth_m, truth, view.camera);
  measures.filtered = measure_depth_error(picture.filtered_depth_m, truth, view.camera);
  measures.regions = measure_regions(
      view.regions, truth, view.camera, picture.depth_m, measures.raw, measures.filtered);
  measures.shaded = {kUnset, kUnset};
  if (choice.shaded) {
    const Image<glm::vec3> made =
        shaded_truth ? Image<glm::vec3>() : shade_truth(truth, options, picture.volume);
    const Image<glm::vec3>& shaded = shaded_truth ? *shaded_truth : made;
    if (!shaded.pixels.empty()) measures.shaded = compare_images(picture.surface, shaded);
  }
  if (choice.distance) {
    measures.distance = surface_distance(picture.depth_m, truth, view.camera);
  }
  return measures;
}

const RegionError* PictureMeasures::grazing() const {
  const auto found = std::ranges::find_if(regions, [](const RegionError& region) {
    return region.group == "unseen" && region.name == "grazing" && region.surface > 0;
  });
  return found == regions.end() ? nullptr : &*found;
}

std::string why_no_surface(const DepthError& error) {
  if (error.surface_in_view()) return "";
  const int unseen = error.outside_field + error.grazing + error.shadowed;
  if (unseen == 0) return "the phantom has none in render.volume_of_interest";
  if (error.outside_field == unseen) {
    return "the phantom's lie outside sector, fan or depth of the scan";
  }
  return "the probe cannot see the phantom's: of their pixels " +
         std::to_string(error.outside_field) + " are outside its field, " +
         std::to_string(error.grazing) + " grazing and " + std::to_string(error.shadowed) +
         " shadowed";
}

const std::vector<std::string>& measure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, value] : columns()) all.push_back(name);
    return all;
  }();
  return names;
}

std::vector<MeasureRow> measure_rows(const PictureMeasures& measures) {
  std::vector<MeasureRow> rows = {row_of("picture", "all", {measures, nullptr})};
  for (const RegionError& region : measures.regions) {
    rows.push_back(row_of(region.group, region.name, {measures, &region}));
  }
  return rows;
}

}  // namespace wobblebench::bench
