#include "bench/evaluation/measures/regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "bench/evaluation/truth/truth.h"

namespace wobblebench::bench {

namespace {

bool differs(const Truth& truth, int column, int row, int next_column, int next_row) {
  if (next_column >= truth.kind.width || next_row >= truth.kind.height) return false;
  const float here = truth.any_depth_m(column, row);
  const float there = truth.any_depth_m(next_column, next_row);
  if (std::isnan(here) != std::isnan(there)) return true;
  return std::abs(here - there) > static_cast<float>(kSurfaceJump_m);
}

/// Zero at the silhouettes, as cv::distanceTransform takes it.
cv::Mat1b away_from_silhouettes(const Truth& truth) {
  cv::Mat1b away(truth.kind.height, truth.kind.width, std::uint8_t{1});
  for (int row = 0; row < truth.kind.height; ++row) {
    for (int column = 0; column < truth.kind.width; ++column) {
      if (truth.kind.at(column, row) == TruthKind::grazing) away(row, column) = 0;
      for (const auto& [c, r] : {std::pair{column + 1, row}, std::pair{column, row + 1}}) {
        if (differs(truth, column, row, c, r)) away(row, column) = away(r, c) = 0;
      }
    }
  }
  return away;
}

/// Side of a pixel at its true surface; at the middle of the scene where there is none.
double side_m(const Truth& truth, const render::Camera& camera, int column, int row) {
  if (camera.projection == render::Projection::parallel) return camera.pixel_m();
  const auto depth_m = static_cast<double>(truth.any_depth_m(column, row));
  return camera.pixel_m() * (std::isnan(depth_m) ? 1 : depth_m / camera.eye_distance_m);
}

constexpr std::uint8_t kNone = std::numeric_limits<std::uint8_t>::max();
constexpr int kIncidenceBin_deg = 20;
constexpr int kRangeBin_mm = 20;

/// Bins of equal width from 0 to where values can be.
RegionGroup binned(const std::string& name,
                   const Image<float>& values,
                   double width,
                   int width_in_name,
                   double most) {
  RegionGroup group{name, {}, {values.width, values.height, kNone}};
  const int bins = std::min(static_cast<int>(std::ceil(most / width)), kNone - 1);
  for (int bin = 0; bin < bins; ++bin) {
    group.regions.push_back(std::to_string(bin * width_in_name) + "-" +
                            std::to_string((bin + 1) * width_in_name));
  }
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const auto value = static_cast<double>(values.pixels[i]);
    if (!(value >= 0)) continue;
    group.index.pixels[i] =
        static_cast<std::uint8_t>(std::min(static_cast<int>(value / width), bins - 1));
  }
  return group;
}

float largest(const Image<float>& values) {
  float most = 0;
  for (const float value : values.pixels) most = value > most ? value : most;
  return most;
}

RegionGroup by_part(const Truth& truth) {
  RegionGroup group{"part", {}, {truth.kind.width, truth.kind.height, kNone}};
  std::array<std::uint8_t, 256> index{};
  index.fill(kNone);
  for (const phantoms::LabelName& part : truth.parts) {
    index[part.label] = static_cast<std::uint8_t>(group.regions.size());
    group.regions.push_back(part.name);
  }
  std::ranges::transform(truth.part.pixels, group.index.pixels.begin(), [&](std::uint8_t label) {
    return index[label];
  });
  return group;
}

/// What a person looks at first in a face.
RegionGroup of_face(const Truth& truth) {
  using phantoms::Part;
  constexpr std::pair<Part, std::uint8_t> kLabels[] = {{Part::upper_lip, 0},
                                                       {Part::lower_lip, 0},
                                                       {Part::mouth, 0},
                                                       {Part::tongue, 0},
                                                       {Part::nose, 1},
                                                       {Part::eyelids, 2},
                                                       {Part::eye, 2},
                                                       {Part::ear, 3}};
  RegionGroup group{
      "face", {"mouth", "nose", "eyes", "ears"}, {truth.kind.width, truth.kind.height, kNone}};
  std::array<std::uint8_t, 256> index{};
  index.fill(kNone);
  for (const auto& [part, feature] : kLabels) index[static_cast<std::size_t>(part)] = feature;
  std::ranges::transform(truth.part.pixels, group.index.pixels.begin(), [&](std::uint8_t label) {
    return index[label];
  });
  return group;
}

RegionGroup unseen(const Truth& truth) {
  RegionGroup group{"unseen",
                    {"outside_field", "grazing", "shadowed"},
                    {truth.kind.width, truth.kind.height, kNone}};
  for (std::size_t i = 0; i < truth.kind.pixels.size(); ++i) {
    const auto kind = truth.kind.pixels[i];
    if (kind <= TruthKind::surface) continue;
    group.index.pixels[i] = static_cast<std::uint8_t>(static_cast<int>(kind) -
                                                      static_cast<int>(TruthKind::outside_field));
  }
  return group;
}

/// What the pixels of one region add up to.
struct Sums {
  RegionError error;
  std::vector<double> depths_m, raw_normals_rad, normals_rad;
};

class RegionSums {
 public:
  RegionSums(const RegionGroup& group,
             const Truth& truth,
             const Image<float>& depth_m,
             const DepthError& raw,
             const DepthError& filtered)
      : group_(group),
        truth_(truth),
        depth_m_(depth_m),
        raw_(raw),
        filtered_(filtered),
        is_unseen_(group.name == "unseen"),
        sums_(group.regions.size()) {}

  void add(std::size_t i, const std::vector<float>& area_m2) {
    const std::size_t region = group_.index.pixels[i];
    if (region >= sums_.size()) return;
    Sums& sums = sums_[region];
    const TruthKind kind = truth_.kind.pixels[i];
    const bool found = std::isfinite(depth_m_.pixels[i]);
    if (kind == TruthKind::none) {
      sums.error.false_surface += found;
      return;
    }
    if ((kind != TruthKind::surface) != is_unseen_) return;
    ++sums.error.surface;
    sums.error.surface_m2 += static_cast<double>(area_m2[i]);
    if (!found) {
      ++sums.error.missed;
      sums.error.missed_m2 += static_cast<double>(area_m2[i]);
      return;
    }
    append((is_unseen_ ? raw_.unseen_map_m : raw_.map_m).pixels[i], sums.depths_m);
    append(raw_.normal_rad.pixels[i], sums.raw_normals_rad);
    append(filtered_.normal_rad.pixels[i], sums.normals_rad);
  }

  std::vector<RegionError> errors() {
    std::vector<RegionError> result;
    for (std::size_t region = 0; region < sums_.size(); ++region) {
      Sums& sums = sums_[region];
      if (sums.error.surface == 0 && sums.error.false_surface == 0) continue;
      sums.error.group = group_.name;
      sums.error.name = group_.regions[region];
      sums.error.depth = depth_statistics(std::move(sums.depths_m));
      sums.error.raw_normal = normal_statistics(std::move(sums.raw_normals_rad));
      sums.error.normal = normal_statistics(std::move(sums.normals_rad));
      result.push_back(std::move(sums.error));
    }
    return result;
  }

 private:
  static void append(float value, std::vector<double>& values) {
    if (!std::isnan(value)) values.push_back(static_cast<double>(value));
  }

  const RegionGroup& group_;
  const Truth& truth_;
  const Image<float>& depth_m_;
  const DepthError& raw_;
  const DepthError& filtered_;
  bool is_unseen_;
  std::vector<Sums> sums_;
};

/// Area of each pixel with a true surface, seen or not.
std::vector<float> areas_m2(const Truth& truth, const render::Camera& camera) {
  Image<float> area(truth.kind.width, truth.kind.height, 0);
  parallel_rows(area.height, [&](int row) {
    for (int column = 0; column < area.width; ++column) {
      if (truth.kind.at(column, row) == TruthKind::none) continue;
      area.at(column, row) = static_cast<float>(pixel_area_m2(truth, camera, column, row));
    }
  });
  return area.pixels;
}

}  // namespace

Image<std::uint8_t> silhouette_band(const Truth& truth,
                                    const render::Camera& camera,
                                    double width_m) {
  const int width = truth.kind.width, height = truth.kind.height;
  const cv::Mat1b away = away_from_silhouettes(truth);
  Image<std::uint8_t> band(width, height, 0);
  if (cv::countNonZero(away) == width * height) return band;  // no silhouette in the picture
  cv::Mat1f pixels;
  cv::distanceTransform(away, pixels, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      // A silhouette runs between two pixels, half a pixel from the middle of each.
      const double across_m =
          (0.5 + static_cast<double>(pixels(row, column))) * side_m(truth, camera, column, row);
      band.at(column, row) = across_m <= width_m * (1 + 1e-9) ? 1 : 0;
    }
  }
  return band;
}

std::vector<RegionGroup> region_groups(const Truth& truth, const render::Camera& camera) {
  std::vector<RegionGroup> groups = {
      {"silhouette", {"outside", "within"}, silhouette_band(truth, camera)}};
  if (truth.crossing_m.pixels.empty()) return groups;
  groups.push_back(binned(
      "incidence", truth.incidence_rad, kIncidenceBin_deg * kDegree, kIncidenceBin_deg, kPi));
  groups.push_back(binned("range",
                          truth.range_m,
                          kRangeBin_mm * kMillimetre,
                          kRangeBin_mm,
                          1e-9 + static_cast<double>(largest(truth.range_m))));
  if (!truth.parts.empty()) groups.push_back(by_part(truth));
  groups.push_back(unseen(truth));
  if (!truth.parts.empty()) groups.push_back(of_face(truth));
  return groups;
}

std::vector<RegionError> measure_regions(const std::vector<RegionGroup>& groups,
                                         const Truth& truth,
                                         const render::Camera& camera,
                                         const Image<float>& depth_m,
                                         const DepthError& raw,
                                         const DepthError& filtered) {
  const std::vector<float> area_m2 = areas_m2(truth, camera);
  std::vector<std::vector<RegionError>> of_group(groups.size());
  parallel_rows(static_cast<int>(groups.size()), [&](int group) {
    const auto g = static_cast<std::size_t>(group);
    RegionSums sums(groups[g], truth, depth_m, raw, filtered);
    for (std::size_t i = 0; i < area_m2.size(); ++i) sums.add(i, area_m2);
    of_group[g] = sums.errors();
  });
  std::vector<RegionError> all;
  for (const auto& errors : of_group) all.insert(all.end(), errors.begin(), errors.end());
  return all;
}

}  // namespace wobblebench::bench
