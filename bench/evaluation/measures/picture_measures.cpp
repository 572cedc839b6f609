#include "bench/evaluation/measures/picture_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "base/statistics.h"
#include "bench/results/error.h"
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

void describe(const NormalStatistics& normal,
              const std::array<const Measure*, 4>& as,
              Measurements& to) {
  to.add(*as[0], normal.mean_rad / kDegree);
  to.add(*as[1], normal.median_rad / kDegree);
  to.add(*as[2], normal.p95_rad / kDegree);
  to.add(*as[3], normal.n);
}

constexpr std::array kNormal = {
    &error::kNormalMean, &error::kNormalMedian, &error::kNormalP95, &error::kNormalPixels};
constexpr std::array kRawNormal = {&error::kRawNormalMean,
                                   &error::kRawNormalMedian,
                                   &error::kRawNormalP95,
                                   &error::kRawNormalPixels};

void describe(const DirectedDistance& distance, Measurements& to) {
  to.add(error::kDistanceMean, distance.mean_m / kMillimetre);
  to.add(error::kDistanceP95, distance.p95_m / kMillimetre);
  to.add(error::kDistanceMax, distance.max_m / kMillimetre);
  to.add(error::kDistancePixels, distance.n);
}

void describe(const SurfaceDistance& distance, Measurements& to) {
  to.add(error::kDistanceMean, distance.mean_m / kMillimetre);
  to.add(error::kDistanceP95, distance.p95_m / kMillimetre);
  to.add(error::kDistanceMax,
         std::max(distance.found_to_true.max_m, distance.true_to_found.max_m) / kMillimetre);
  to.add(error::kDistancePixels, distance.found_to_true.n + distance.true_to_found.n);
  to.add(error::kHausdorff95, distance.hausdorff95_m / kMillimetre);
  to.prefix("found_to_true");
  describe(distance.found_to_true, to);
  to.prefix("true_to_found");
  describe(distance.true_to_found, to);
  to.prefix("");
}

/// Whether a found surface where there is no true one is wrong.
bool counts_false(const DepthError& raw, const ExpectedSurface& expected) {
  return raw.surface_in_view() || (expected.in_phantom && raw.false_surface > 0);
}

/// What is said of a whole picture and of its regions. `has_false`: its false surface is counted.
template <class Part>
void describe_part(const Part& part,
                   int pixels,
                   bool has_false,
                   const ExpectedSurface& expected,
                   Measurements& to) {
  const auto percent = [&](bool formed, double value) {
    return expected.sought && formed ? value : kUnset;
  };
  const auto share = [&](int count) { return 100.0 * count / pixels; };
  describe(part.depth, to);
  to.add(error::kSurface, share(part.surface));
  to.add(error::kSurfaceArea, 1e4 * part.surface_m2);
  to.add(error::kMissed, percent(part.surface > 0, share(part.missed)));
  to.add(error::kMissedSurface, percent(part.surface > 0, part.missed_surface_percent()));
  to.add(error::kFalse, percent(has_false, share(part.false_surface)));
}

void describe_normals(const NormalStatistics& raw,
                      const NormalStatistics& filtered,
                      Measurements& to) {
  describe(filtered, kNormal, to);
  describe(raw, kRawNormal, to);
}

/// Without a surface there: no pixels, all NaN.
RegionError region_of(const PictureMeasures& measures,
                      const std::string& group,
                      const std::string& name) {
  const auto found = std::ranges::find_if(measures.regions, [&](const RegionError& region) {
    return region.group == group && region.name == name;
  });
  return found == measures.regions.end() ? RegionError{.depth = depth_statistics({})} : *found;
}

/// The pixels whose z was not found.
RegionGroup drawn_pixels(const Image<std::uint8_t>& drawn) {
  RegionGroup group{"outline", {"drawn"}, {drawn.width, drawn.height}};
  std::ranges::transform(
      drawn.pixels, group.index.pixels.begin(), [](int is) { return is == 1 ? 0 : 1; });
  return group;
}

struct FeatureMeasures {
  const char* name;
  const Measure *p95, *missed;
};
constexpr FeatureMeasures kFeatures[] = {{"mouth", &error::kMouthP95, &error::kMouthMissed},
                                         {"nose", &error::kNoseP95, &error::kNoseMissed},
                                         {"eyes", &error::kEyesP95, &error::kEyesMissed},
                                         {"ears", &error::kEarsP95, &error::kEarsMissed}};

void describe_regions(const PictureMeasures& measures,
                      const ExpectedSurface& expected,
                      Measurements& to) {
  const RegionError outside = region_of(measures, "silhouette", "outside");
  to.add(error::kOutsideRms, outside.depth.rms_m / kMillimetre);
  to.add(error::kOutsideP95, outside.depth.p95_m / kMillimetre);
  const RegionError grazing = region_of(measures, "unseen", "grazing");
  const bool formed = expected.sought && grazing.surface > 0;
  to.add(error::kGrazingMissed, formed ? grazing.missed_pixels_percent() : kUnset);
  to.add(error::kGrazingP95, grazing.depth.p95_m / kMillimetre);
  const RegionError drawn = region_of(measures, "outline", "drawn");
  to.add(error::kDrawn, 100.0 * measures.drawn / measures.raw.pixels);
  to.add(error::kDrawnFalse, 100.0 * drawn.false_surface / measures.raw.pixels);
  to.add(error::kDrawnP95, drawn.depth.p95_m / kMillimetre);
  for (const FeatureMeasures& one : kFeatures) {
    const RegionError feature = region_of(measures, "face", one.name);
    const bool is_seen = expected.sought && feature.surface > 0;
    to.add(*one.p95, feature.depth.p95_m / kMillimetre);
    to.add(*one.missed, is_seen ? feature.missed_pixels_percent() : kUnset);
  }
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
  std::vector<RegionGroup> groups = view.regions;
  if (!picture.drawn.pixels.empty()) groups.push_back(drawn_pixels(picture.drawn));
  measures.cut_by_box_percent = truth.cut_by_box_percent;
  measures.drawn = static_cast<int>(std::ranges::count(picture.drawn.pixels, 1));
  measures.regions =
      measure_regions(groups, truth, view.camera, picture.depth_m, measures.raw, measures.filtered);
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

void describe(const RegionError& region,
              const PictureMeasures& of,
              const ExpectedSurface& expected,
              Measurements& to) {
  const bool has_false =
      (region.group == "silhouette" || region.group == "outline") && counts_false(of.raw, expected);
  describe_part(region, of.raw.pixels, has_false, expected, to);
  describe_normals(region.raw_normal, region.normal, to);
}

void describe(const PictureMeasures& measures, const ExpectedSurface& expected, Measurements& to) {
  const DepthError& raw = measures.raw;
  const bool has_false = counts_false(raw, expected);
  describe_part(raw, raw.pixels, has_false, expected, to);
  to.add(error::kPicturePixels, raw.pixels);
  to.add(error::kFalseSurface, expected.sought && has_false ? raw.false_surface_percent() : kUnset);
  to.add(error::kMissedOrFalse, to.value(error::kMissed) + to.value(error::kFalse));
  to.add(error::kFoundArea, 1e4 * raw.found_m2);
  to.add(error::kOutsideField, 100.0 * raw.outside_field / raw.pixels);
  to.add(error::kGrazing, 100.0 * raw.grazing / raw.pixels);
  to.add(error::kShadowed, 100.0 * raw.shadowed / raw.pixels);
  to.add(error::kCutByBox, measures.cut_by_box_percent);
  describe_regions(measures, expected, to);
  describe_normals(raw.normal, measures.filtered.normal, to);
  describe(measures.distance.value_or(SurfaceDistance()), to);
  to.add(error::kSsim, measures.shaded.ssim);
  to.add(error::kPsnr, measures.shaded.psnr_db);
  to.prefix("filtered");
  describe(measures.filtered.depth, to);
}

namespace {

const Measurements& all_of_pictures() {
  static const Measurements all = described(PictureMeasures(), ExpectedSurface());
  return all;
}

}  // namespace

const std::vector<const Measure*>& picture_measures() {
  static const std::vector<const Measure*> different = [] {
    std::vector<const Measure*> found;
    for (const MeasuredValue& one : all_of_pictures()) {
      if (all_of_pictures().find(one.measure->key) == &one) found.push_back(one.measure);
    }
    return found;
  }();
  return different;
}

std::size_t measure_index(std::string_view key) {
  const auto& all = picture_measures();
  const auto found = std::ranges::find(all, key, [](const Measure* one) { return one->key; });
  if (found == all.end()) throw std::out_of_range("no measure " + std::string(key));
  return static_cast<std::size_t>(found - all.begin());
}

std::vector<MeasureRow> measure_rows(const PictureMeasures& measures) {
  const auto values = [](const Measurements& found) {
    std::vector<double> all;
    for (const Measure* measure : picture_measures()) all.push_back(found.value(*measure));
    return all;
  };
  const ExpectedSurface expected;
  std::vector<MeasureRow> rows = {{"picture", "all", values(described(measures, expected))}};
  for (const RegionError& region : measures.regions) {
    rows.push_back({region.group, region.name, values(described(region, measures, expected))});
  }
  return rows;
}

}  // namespace wobblebench::bench
