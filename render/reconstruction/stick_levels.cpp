#include "render/reconstruction/stick_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "render/reconstruction/stick_edges.h"

namespace wobblebench::render {
namespace {

constexpr double kTissueFrom_m = 0.5e-3, kTissueTo_m = 3.5e-3, kTissueMean_m = 1.5e-3;
/// Weights of a stick and of its neighbours in a frame, and so across frames: a binomial filter.
constexpr std::array<double, 5> kOfNeighbours = {1, 4, 6, 4, 1};
/// Standard deviation of the levels' filter, sticks and frames.
constexpr double kSmoothing = 2.5;
/// A level that is higher by all of the contrast weighs exp(2) times as much.
constexpr double kHigherWeighsMore = 2;
constexpr double kLeastBelow_db = 1, kMostBelow_db = 7.5;

/// Values of the sticks of a volume.
struct StickGrid {
  StickGrid(int frame_count, int line_count)
      : frames(frame_count),
        lines(line_count),
        values(static_cast<std::size_t>(frame_count) * static_cast<std::size_t>(line_count)) {}
  double& at(int frame, int line) { return values[index(frame, line)]; }
  double at(int frame, int line) const { return values[index(frame, line)]; }
  std::size_t index(int frame, int line) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(lines) +
           static_cast<std::size_t>(line);
  }

  int frames, lines;
  std::vector<double> values;
};

/// The samples of each stick from its edge on, into tissue.
class EdgeProfiles {
 public:
  EdgeProfiles(const hw::AcquisitionPlan& plan,
               const std::vector<std::vector<float>>& frames,
               const std::vector<double>& edges,
               EdgeSign sign)
      : edges_(edges),
        frames_(static_cast<int>(frames.size())),
        lines_(plan.acquisition().sticks_per_frame),
        length_(samples_in(kTissueTo_m, plan)),
        first_(std::min(samples_in(kTissueFrom_m, plan), length_ - 1)),
        window_(std::min(samples_in(kTissueMean_m, plan), length_ - first_)),
        values_(edges.size() * static_cast<std::size_t>(length_)) {
    const int samples = plan.acquisition().samples_per_stick;
    const int step = sign == EdgeSign::rising ? 1 : -1;
    parallel_rows(frames_, [&](int frame) {
      for (int line = 0; line < lines_; ++line) {
        const double edge_m = edge(frame, line);
        if (std::isnan(edge_m)) continue;
        const float* stick =
            frames[static_cast<std::size_t>(frame)].data() + std::ptrdiff_t{line} * samples;
        const int at = static_cast<int>(edge_m / plan.sample_spacing_m());
        float* profile = values_.data() + offset(frame, line);
        for (int k = 0; k < length_; ++k) {
          profile[k] = stick[std::clamp(at + step * k, 0, samples - 1)];
        }
      }
    });
  }

  /// The greatest mean of a window of the profile, averaged with the neighbours whose edges lie
  /// within kSupport_m of the stick's. NaN: it has no edge.
  double tissue(int frame, int line) const {
    if (std::isnan(edge(frame, line))) return kNoEdge;
    std::vector<double> profile(static_cast<std::size_t>(length_));
    double total = 0;
    constexpr int half = static_cast<int>(kOfNeighbours.size()) / 2;
    for (int f = std::max(frame - half, 0); f <= std::min(frame + half, frames_ - 1); ++f) {
      for (int l = std::max(line - half, 0); l <= std::min(line + half, lines_ - 1); ++l) {
        if (!(std::abs(edge(f, l) - edge(frame, line)) < kSupport_m)) continue;
        const double weight = kOfNeighbours[static_cast<std::size_t>(f - frame + half)] *
                              kOfNeighbours[static_cast<std::size_t>(l - line + half)];
        total += weight;
        const float* other = values_.data() + offset(f, l);
        for (std::size_t k = 0; k < profile.size(); ++k) profile[k] += weight * other[k];
      }
    }
    double greatest = 0;
    for (int k = first_; k + window_ <= length_; ++k) {
      double sum = 0;
      for (int i = k; i < k + window_; ++i) sum += profile[static_cast<std::size_t>(i)];
      greatest = std::max(greatest, sum / (total * window_));
    }
    return greatest;
  }

 private:
  double edge(int frame, int line) const {
    return edges_[static_cast<std::size_t>(frame) * static_cast<std::size_t>(lines_) +
                  static_cast<std::size_t>(line)];
  }
  std::ptrdiff_t offset(int frame, int line) const {
    return (std::ptrdiff_t{frame} * lines_ + line) * length_;
  }

  const std::vector<double>& edges_;
  int frames_, lines_;
  int length_, first_, window_;  ///< samples
  std::vector<float> values_;
};

std::vector<double> gaussian_taps() {
  const int half = static_cast<int>(std::ceil(3 * kSmoothing));
  std::vector<double> taps;
  for (int k = -half; k <= half; ++k) {
    taps.push_back(std::exp(-0.5 * k * k / (kSmoothing * kSmoothing)));
  }
  return taps;
}

/// Sums weighted by the distance in sticks and frames; what lies outside is 0.
StickGrid gaussian_sums(const StickGrid& of) {
  const std::vector<double> taps = gaussian_taps();
  const int half = static_cast<int>(taps.size()) / 2;
  StickGrid along_lines(of.frames, of.lines), result(of.frames, of.lines);
  const auto sum = [&](int middle, int count, const auto& value) {
    double total = 0;
    for (int k = std::max(middle - half, 0); k <= std::min(middle + half, count - 1); ++k) {
      total += taps[static_cast<std::size_t>(k - middle + half)] * value(k);
    }
    return total;
  };
  parallel_rows(of.frames, [&](int f) {
    for (int l = 0; l < of.lines; ++l) {
      along_lines.at(f, l) = sum(l, of.lines, [&](int k) { return of.at(f, k); });
    }
  });
  parallel_rows(of.frames, [&](int f) {
    for (int l = 0; l < of.lines; ++l) {
      result.at(f, l) = sum(f, of.frames, [&](int k) { return along_lines.at(k, l); });
    }
  });
  return result;
}

/// The greater distance to the next stick and to the next frame at a range.
double spacing_m(const hw::AcquisitionPlan& plan, double range_m) {
  const hw::ProbeGeometry geometry = plan.geometry();
  return std::max((geometry.radius_m() + range_m) * plan.theta_step_rad(),
                  (geometry.wobble_radius_m() + range_m) * plan.phi_step_rad());
}

double below_tissue_db(const hw::AcquisitionPlan& plan,
                       const hw::BeamWidths& beam,
                       double range_m,
                       double db) {
  const hw::BeamWidth width = beam.at(range_m);
  const double widest_m = std::max(width.lateral_m, width.elevation_m);
  // As of the beam for which the option says it, where no beam is known.
  const double of_beam_db = widest_m > 0 ? db * kWidthOfLevel_m / widest_m : db;
  const double sparse = std::max(spacing_m(plan, range_m) / kSparse_m, 1.0);
  return std::clamp(of_beam_db, kLeastBelow_db, kMostBelow_db) * sparse * sparse;
}

}  // namespace

std::vector<double> find_stick_levels(const hw::AcquisitionPlan& plan,
                                      const std::vector<std::vector<float>>& frames,
                                      const std::vector<double>& edges,
                                      const EchoLevels& levels,
                                      const hw::BeamWidths& beam,
                                      const RenderOptions& options) {
  const EdgeProfiles profiles(plan, frames, edges, options.ray_casting.edge);
  const int lines = plan.acquisition().sticks_per_frame;
  const double lowest =
      levels.at(std::lerp(kLowestLevel, kLowestOfWhite, std::min(levels.white / kMuchWhite, 1.0)));
  StickGrid weights(static_cast<int>(frames.size()), lines);
  StickGrid weighted(weights.frames, lines);
  parallel_rows(weights.frames, [&](int f) {
    for (int l = 0; l < lines; ++l) {
      const double tissue = profiles.tissue(f, l);
      if (std::isnan(tissue)) continue;
      const double below =
          below_tissue_db(
              plan, beam, edges[weights.index(f, l)], options.ray_casting.below_tissue_db) /
          options.reconstruction.display_range_db;
      const double level = std::max(std::min(tissue, levels.tissue) - below, lowest);
      const double share = (level - levels.fluid) / (levels.tissue - levels.fluid);
      weights.at(f, l) = std::exp(kHigherWeighsMore * share);
      weighted.at(f, l) = weights.at(f, l) * level;
    }
  });
  const StickGrid total = gaussian_sums(weights), sum = gaussian_sums(weighted);
  std::vector<double> result(edges.size(), levels.at(kIsoLevel));
  for (std::size_t stick = 0; stick < result.size(); ++stick) {
    if (total.values[stick] > 0) result[stick] = sum.values[stick] / total.values[stick];
  }
  return result;
}

std::vector<std::vector<float>> level_sticks(const hw::AcquisitionPlan& plan,
                                             const std::vector<std::vector<float>>& frames,
                                             const std::vector<double>& stick_levels,
                                             const EchoLevels& levels,
                                             double level) {
  const auto lines = static_cast<std::size_t>(plan.acquisition().sticks_per_frame);
  const auto samples = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  const auto fluid = static_cast<float>(levels.fluid);
  std::vector<std::vector<float>> levelled(frames.size());
  parallel_rows(static_cast<int>(frames.size()), [&](int frame) {
    const auto f = static_cast<std::size_t>(frame);
    levelled[f].resize(frames[f].size());
    for (std::size_t line = 0; line < lines; ++line) {
      const auto factor = static_cast<float>((level - levels.fluid) /
                                             (stick_levels[f * lines + line] - levels.fluid));
      const float* from = frames[f].data() + line * samples;
      float* to = levelled[f].data() + line * samples;
      for (std::size_t k = 0; k < samples; ++k) {
        to[k] = std::clamp(fluid + factor * (from[k] - fluid), 0.0f, 1.0f);
      }
    }
  });
  return levelled;
}

}  // namespace wobblebench::render
