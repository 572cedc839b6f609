#include "tests/bench/evaluation/bound/beam_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

namespace wobblebench::bench {

namespace {

constexpr double kBin_m = 20e-6;
constexpr double kReachSigmas = 4.5;  ///< of the pulse, as the rung has it
constexpr std::size_t kNodes = sim::PulseBand::kNodes;

/// Response at a point across the stick, and by how much later than the axis it meets the surface.
struct Part {
  double reach = 0;  ///< offset from the axis, 1 at the beam's rim
  double later_m = 0;
  sim::PulseBand::Values response = {};
};

/// One direction across the beam. Of a table of one side, the other is its mirror image.
class Across {
 public:
  Across(const sim::BeamTable& beam, const sim::BeamTable::Direction& direction)
      : beam_(beam),
        direction_(direction),
        both_sides_(direction.part_columns == 2 * beam.columns()) {}

  /// Points on the surface, which lie elsewhere in the table than the axis does.
  std::vector<Part> parts(double range_m, double slope) const {
    const double reach_m = beam_.reach_m(direction_, beam_.row(range_m));
    const double step_m = reach_m / beam_.columns();
    std::vector<Part> result;
    const int side = static_cast<int>(kWidest * beam_.columns());
    for (int i = -side; i < side; ++i) {
      const double offset_m = (i + 0.5) * step_m;
      const double at_m = range_m + slope * offset_m;
      const double reach = std::abs(offset_m) / beam_.reach_m(direction_, beam_.row(at_m));
      if (reach < 1) result.push_back(part(at_m, offset_m, slope, reach));
    }
    return result;
  }

 private:
  Part part(double range_m, double offset_m, double slope, double reach) const {
    const int row = beam_.row(range_m);
    const auto line = [&](float sim::BeamRow::*member) {
      const auto value = [&](std::size_t i) { return direction_.rows[i].*member; };
      return sim::line_around(row, beam_.rows(), beam_.rows_per_m(), value).at(range_m);
    };
    const double delay_m =
        line(&sim::BeamRow::delay_m) +
        (line(&sim::BeamRow::tilt) + line(&sim::BeamRow::curvature_per_m) * offset_m) * offset_m;
    Part result{reach, slope * offset_m + delay_m};
    const double column =
        (both_sides_ ? offset_m : std::abs(offset_m)) * line(&sim::BeamRow::columns_per_m) +
        (both_sides_ ? beam_.columns() : 0);
    const sim::BandValues& value =
        direction_.at(row,
                      beam_.part(range_m, direction_.parts),
                      std::clamp(static_cast<int>(column), 0, direction_.part_columns - 1));
    for (std::size_t n = 0; n < result.response.size(); ++n) {
      result.response[n] = std::complex<double>(value.re[n], value.im[n]);
    }
    return result;
  }

  static constexpr double kWidest = 1.5;  ///< over its reach at the axis
  const sim::BeamTable& beam_;
  const sim::BeamTable::Direction& direction_;
  bool both_sides_;
};

/// Products of the responses at two nodes, [node * nodes + other node].
using Products = std::array<std::complex<double>, kNodes * kNodes>;

std::complex<double> weighted(const Products& a, const Products& b, std::size_t nodes) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < nodes * nodes; ++i) sum += a[i] * b[i];
  return sum;
}

/// Sums of the products over all points of the cross-section, by how late they meet the surface.
struct Footprint {
  std::size_t nodes;
  double first_m = 0;
  std::vector<Products> bins;

  Footprint(const std::vector<Part>& lateral,
            const std::vector<Part>& elevation,
            std::size_t band_nodes)
      : nodes(band_nodes) {
    const auto later = [](const Part& a, const Part& b) { return a.later_m < b.later_m; };
    const auto [low_l, high_l] = std::minmax_element(lateral.begin(), lateral.end(), later);
    const auto [low_e, high_e] = std::minmax_element(elevation.begin(), elevation.end(), later);
    first_m = low_l->later_m + low_e->later_m;
    const double length_m = high_l->later_m + high_e->later_m - first_m;
    bins.resize(static_cast<std::size_t>(length_m / kBin_m) + 2);
    for (const Part& l : lateral) {
      for (const Part& e : elevation) {
        if (l.reach * l.reach + e.reach * e.reach < 1) add(l, e);  // sim::BeamRim::ellipse
      }
    }
  }

 private:
  void add(const Part& l, const Part& e) {
    const double bin = (l.later_m + e.later_m - first_m) / kBin_m;
    Products& sums = bins[static_cast<std::size_t>(std::lround(bin))];
    for (std::size_t i = 0; i < nodes; ++i) {
      for (std::size_t j = 0; j < nodes; ++j) {
        sums[i * nodes + j] +=
            l.response[i] * e.response[i] * std::conj(l.response[j] * e.response[j]);
      }
    }
  }
};

/// Products of the nodes' pulses at two samples `distance_m` apart, by the distance of their middle
/// behind the scatterer, and their integrals up to there.
struct PulsePairs {
  std::ptrdiff_t half = 0;  ///< entry `half` is at distance 0
  std::vector<Products> product;
  std::vector<Products> integral;

  PulsePairs(const sim::PulseBand& band, double distance_m) {
    const auto nodes = static_cast<std::size_t>(band.nodes());
    half = static_cast<std::ptrdiff_t>(kReachSigmas * band.sigma_m() / kBin_m);
    for (std::ptrdiff_t k = -half; k <= half; ++k) {
      const double middle_m = static_cast<double>(k) * kBin_m;
      Products& at = product.emplace_back();
      const sim::PulseBand::Values before = band.pulses(middle_m - 0.5 * distance_m);
      const sim::PulseBand::Values behind = band.pulses(middle_m + 0.5 * distance_m);
      for (std::size_t i = 0; i < nodes; ++i) {
        for (std::size_t j = 0; j < nodes; ++j) {
          at[i * nodes + j] = before[i] * std::conj(behind[j]);
        }
      }
      integrate();
    }
  }

 private:
  /// By the trapezoidal rule.
  void integrate() {
    Products sum = {};
    if (!integral.empty()) {
      const Products &last = product[product.size() - 2], &next = product.back();
      sum = integral.back();
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += 0.5 * kBin_m * (last[i] + next[i]);
    }
    integral.push_back(sum);
  }
};

/// Pairs at one distance, at steps of kBin_m; constant beyond both ends.
struct PairTable {
  double low_m = 0;
  std::vector<PairValue> values;

  PairTable(const Footprint& footprint, const PulsePairs& pulses)
      : low_m(footprint.first_m - static_cast<double>(pulses.half) * kBin_m) {
    const auto bins = static_cast<std::ptrdiff_t>(footprint.bins.size());
    std::complex<double> passed = 0;  // of the bins whose pulses are over
    for (std::ptrdiff_t i = 0; i < bins + 2 * pulses.half; ++i) {
      const std::ptrdiff_t middle = i - pulses.half, over = middle - pulses.half - 1;
      if (over >= 0 && over < bins)
        passed += weighted(at(footprint, over), pulses.integral.back(), footprint.nodes);
      PairValue sum{passed, 0};
      const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, over + 1);
      for (std::ptrdiff_t b = from; b < std::min(bins, middle + pulses.half + 1); ++b) {
        const auto behind = static_cast<std::size_t>(middle - b + pulses.half);
        sum.covariance += weighted(at(footprint, b), pulses.integral[behind], footprint.nodes);
        sum.slope_per_m += weighted(at(footprint, b), pulses.product[behind], footprint.nodes);
      }
      values.push_back(sum);
    }
  }

  PairValue at(double behind_m) const {
    const double position = (behind_m - low_m) / kBin_m;
    if (position <= 0) return {};
    if (position >= static_cast<double>(values.size() - 1)) return {values.back().covariance, 0};
    const auto i = static_cast<std::size_t>(position);
    const double share = position - static_cast<double>(i);
    const PairValue &a = values[i], &b = values[i + 1];
    return {a.covariance + share * (b.covariance - a.covariance),
            a.slope_per_m + share * (b.slope_per_m - a.slope_per_m)};
  }

 private:
  static const Products& at(const Footprint& footprint, std::ptrdiff_t bin) {
    return footprint.bins[static_cast<std::size_t>(bin)];
  }
};

}  // namespace

EdgePair beam_pair(const sim::BeamTable& beam,
                   const sim::PulseBand& band,
                   const hw::PolarPoint& point,
                   const StickSlope& slope,
                   double spacing_m) {
  // Lateral offsets count away from the middle of the sector.
  const double side = point.theta_rad < 0 ? -1 : 1;
  const Across lateral(beam, beam.lateral()[beam.lateral_of(point.theta_rad)]);
  const Across elevation(beam, beam.elevation());
  const Footprint footprint(lateral.parts(point.range_m, side * slope.lateral),
                            elevation.parts(point.range_m, slope.elevation),
                            static_cast<std::size_t>(band.nodes()));
  const int lags = static_cast<int>(2 * kReachSigmas * band.sigma_m() / spacing_m);
  const auto tables = std::make_shared<std::vector<PairTable>>();
  for (int lag = 0; lag <= lags; ++lag) {
    tables->emplace_back(footprint, PulsePairs(band, lag * spacing_m));
  }
  const double power = tables->front().values.back().covariance.real();
  return [tables, power, spacing_m](double behind_m, double distance_m) -> PairValue {
    const auto lag = static_cast<std::size_t>(std::lround(distance_m / spacing_m));
    if (lag >= tables->size()) return {};
    const PairValue value = (*tables)[lag].at(behind_m);
    return {value.covariance / power, value.slope_per_m / power};
  };
}

}  // namespace wobblebench::bench
