#include "sim/speckle/line_covariance.h"

#include <algorithm>
#include <cmath>

#include "sim/math/fast_math.h"
#include "sim/optics/beam_row.h"

namespace wobblebench::sim {

namespace {

constexpr double kSmallWeight = 0.003;  ///< 1e-5 of a row's power

/// The largest lag at which any row has a weight that counts.
int longest_lag(const BandedMatrix& factor) {
  int longest = 0;
  for (int row = 0; row < factor.rows; ++row) {
    for (int lag = factor.band; lag > longest; --lag) {
      if (std::abs(factor.at(row, lag)) >= kSmallWeight) longest = lag;
    }
  }
  return longest;
}

BandedMatrix with_unit_rows(const BandedMatrix& factor, int band) {
  BandedMatrix unit(factor.rows, band);
  for (int row = 0; row < factor.rows; ++row) {
    double power = 0;
    for (int lag = 0; lag <= band; ++lag) power += factor.at(row, lag) * factor.at(row, lag);
    for (int lag = 0; lag <= band; ++lag) {
      unit.at(row, lag) = factor.at(row, lag) / std::sqrt(power);
    }
  }
  return unit;
}

}  // namespace

BandedMatrix cholesky_factor(const BandedMatrix& covariance, double noise_share) {
  BandedMatrix factor(covariance.rows, covariance.band);
  for (int row = 0; row < factor.rows; ++row) {
    const int first = std::max(0, row - factor.band);
    for (int column = first; column <= row; ++column) {
      double rest = covariance.at(row, row - column) + (column == row ? noise_share : 0);
      for (int k = std::max(first, column - factor.band); k < column; ++k) {
        rest -= factor.at(row, row - k) * factor.at(column, column - k);
      }
      // Rounding alone makes a pivot smaller than the noise.
      factor.at(row, row - column) = column == row ? std::sqrt(std::max(rest, 0.5 * noise_share))
                                                   : rest / factor.at(column, 0);
    }
  }
  return with_unit_rows(factor, longest_lag(factor));
}

namespace {

constexpr int kNodes = PulseBand::kNodes;
constexpr int kLeastPoints = 48;      ///< per side, within the reach of a line
constexpr double kMostReach_rad = 1;  ///< very near the face
/// Four lines per width of speckle at the focus: halfway between lines a Gaussian correlation is up
/// to 4 % too large, up to half of that width.
constexpr double kLinesPerCell = 2;
constexpr int kRanges = 32;  ///< at which cells are computed

double sine(double aperture_m, double range_m) {
  return 0.5 * aperture_m / std::hypot(range_m, 0.5 * aperture_m);
}

/// Smallest size of speckle across lines at a range: the inverse bandwidth of the two-way response
/// in spatial frequency. At the focus the full width at half maximum of speckle is 1.9 cells.
double cell_m(const ProbeOptics& optics, double range_m) {
  return 0.5 * optics.wavelength_m() /
         (sine(optics.transmit_aperture_m(range_m), range_m) +
          sine(optics.receive_aperture_m(range_m), range_m));
}

/// Step between sample points for which sums over them are integrals, by the sampling theorem for
/// the product of two responses at the upper end of the band.
double point_step_rad(const ProbeOptics& optics, double range_m, double reach_rad) {
  constexpr double kWithinLimit = 0.85;
  const double highest = 1 + 0.5 * optics.probe().fractional_bandwidth;
  const double limit_rad = cell_m(optics, range_m) / highest / (optics.probe().radius_m + range_m);
  return std::min(reach_rad / kLeastPoints, kWithinLimit * limit_rad);
}

/// Sample points for the positions of scatterers at a range, on an arc about the probe's centre of
/// curvature. Lines and points lie at multiples of one angle, so that lines with the same aperture
/// have the same responses.
class Arc {
 public:
  /// Points are at most `point_step_rad` apart.
  Arc(double radius_m,
      double range_m,
      double line_step_rad,
      double point_step_rad,
      double reach_rad)
      : radius_m_(radius_m), range_m_(range_m) {
    if (line_step_rad > point_step_rad) {
      per_line_ = static_cast<int>(std::ceil(line_step_rad / point_step_rad));
    } else {
      per_point_ = static_cast<int>(point_step_rad / line_step_rad);
    }
    unit_rad_ = line_step_rad / per_line_;
    reach_ = static_cast<int>(reach_rad / unit_rad_);
  }

  /// Reach on either side of a line, in units.
  int reach() const { return reach_; }
  /// The point `units` from a line, in the line's plane.
  PlanePoint point(int units) const {
    const double angle = units * unit_rad_, r = radius_m_ + range_m_;
    return {r * std::cos(angle) - radius_m_, r * std::sin(angle)};
  }
  /// The first point within reach of a line, counted from the first line.
  int first_point(int line) const {
    const int units = line * per_line_ - reach_;
    return units >= 0 ? (units + per_point_ - 1) / per_point_ : -(-units / per_point_);
  }
  /// Units from a line to a point.
  int units(int point, int line) const { return point * per_point_ - line * per_line_; }
  /// Number of lines on one side that have points in common with a line.
  int neighbours() const { return 2 * reach_ / per_line_; }

 private:
  double radius_m_, range_m_;
  double unit_rad_ = 0;
  int per_line_ = 1, per_point_ = 1, reach_ = 0;
};

/// Responses of a line to the points from `first` on, normalised to unit power.
struct LineResponse {
  int first = 0;
  std::vector<float> re, im;  ///< [point][node]

  int end() const { return first + static_cast<int>(re.size()) / kNodes; }
};

/// Adds, at each frequency, the products of one line's responses and the other's conjugate ones.
WOBBLEBENCH_SIMD void add_products(const float* re1,
                                   const float* im1,
                                   const float* re2,
                                   const float* im2,
                                   int points,
                                   float* __restrict re,
                                   float* __restrict im) {
  for (int i = 0; i < points; ++i) {
    for (int n = 0; n < kNodes; ++n) {
      const int at = i * kNodes + n;
      re[n] += re1[at] * re2[at] + im1[at] * im2[at];
      im[n] += im1[at] * re2[at] - re1[at] * im2[at];
    }
  }
}

std::complex<double> overlap(const LineResponse& one, const LineResponse& other) {
  const int first = std::max(one.first, other.first);
  const int points = std::min(one.end(), other.end()) - first;
  if (points <= 0) return 0;
  const auto in_one = static_cast<std::ptrdiff_t>(first - one.first) * kNodes;
  const auto in_other = static_cast<std::ptrdiff_t>(first - other.first) * kNodes;
  float re[kNodes] = {}, im[kNodes] = {};
  add_products(one.re.data() + in_one,
               one.im.data() + in_one,
               other.re.data() + in_other,
               other.im.data() + in_other,
               points,
               re,
               im);
  std::complex<double> sum = 0;
  for (int n = 0; n < kNodes; ++n) sum += std::complex<double>(re[n], im[n]);
  return sum;
}

/// Computes the responses of lines at one range.
class LineResponses {
 public:
  LineResponses(const ProbeOptics& optics, const Arc& arc, double range_m)
      : arc_(arc), range_m_(range_m) {
    const PulseBand& band = optics.band();
    const auto powers = ElevationRow(optics, range_m).row.node_powers();
    std::vector<PlanePoint> points;
    for (int units = -arc.reach(); units <= arc.reach(); ++units) {
      points.push_back(arc.point(units));
      const double path_m = 2 * (points.back().axial_m - range_m);
      factors_.emplace_back();
      for (std::size_t n = 0; n < kNodes; ++n) {
        const int node = static_cast<int>(n);
        factors_.back()[n] = std::polar(std::sqrt(powers[n] * band.weight(node)),
                                        -path_m * band.wavenumber_per_m(node));
      }
    }
    whole_values_ = PlaneResponse::lateral(StickAperture(optics, 0), range_m).at(points);
  }

  LineResponse of(int line, const StickAperture& aperture) const {
    const bool whole = aperture.whole(range_m_);
    const int first = arc_.first_point(line);
    std::vector<int> units;
    std::vector<PlanePoint> points;
    std::vector<PulseBand::Values> values;
    for (int point = first; arc_.units(point, line) <= arc_.reach(); ++point) {
      units.push_back(arc_.units(point, line));
      if (whole) {
        values.push_back(whole_values_[from_first(units.back())]);
      } else {
        points.push_back(arc_.point(units.back()));
      }
    }
    if (!whole) values = PlaneResponse::lateral(aperture, range_m_).at(points);
    return normalised(first, units, values);
  }

 private:
  std::size_t from_first(int units) const { return static_cast<std::size_t>(units + arc_.reach()); }

  LineResponse normalised(int first,
                          const std::vector<int>& units,
                          const std::vector<PulseBand::Values>& values) const {
    LineResponse response{first, {}, {}};
    double power = 0;
    for (std::size_t i = 0; i < units.size(); ++i) {
      const PulseBand::Values& factors = factors_[from_first(units[i])];
      for (std::size_t n = 0; n < kNodes; ++n) {
        const std::complex<double> one = times(values[i][n], factors[n]);
        power += std::norm(one);
        response.re.push_back(static_cast<float>(one.real()));
        response.im.push_back(static_cast<float>(one.imag()));
      }
    }
    const auto scale = static_cast<float>(power > 0 ? 1 / std::sqrt(power) : 0);
    for (float& part : response.re) part *= scale;
    for (float& part : response.im) part *= scale;
    return response;
  }

  const Arc& arc_;
  double range_m_;
  // By the distance from the line, in units.
  std::vector<PulseBand::Values> factors_;       ///< root of the node's power, phase of the path
  std::vector<PulseBand::Values> whole_values_;  ///< of a line whose aperture is whole
};

/// Each line's phase is chosen so that its covariance with the line before it is real; of the other
/// covariances the real part is kept.
BandedMatrix covariance_of(const std::vector<LineResponse>& responses, int band) {
  const int lines = static_cast<int>(responses.size());
  BandedMatrix covariance(lines, band);
  std::vector<std::complex<double>> phasors;
  for (int line = 0; line < lines; ++line) {
    covariance.at(line, 0) = 1;
    phasors.emplace_back(line == 0 ? 1 : phasors.back());
    for (int lag = 1; lag <= std::min(line, band); ++lag) {
      const auto at = static_cast<std::size_t>(line), other = at - static_cast<std::size_t>(lag);
      const std::complex<double> sum = overlap(responses[at], responses[other]);
      const double magnitude = std::abs(sum);
      if (lag == 1 && magnitude > 0) phasors[at] = times(phasors[other], sum / magnitude);
      const std::complex<double> turn = times(phasors[other], std::conj(phasors[at]));
      covariance.at(line, lag) = times(sum, turn).real();
    }
  }
  return covariance;
}

}  // namespace

UniformLines UniformLines::of(const hw::AcquisitionPlan& plan) {
  return {plan.acquisition().sticks_per_frame, plan.theta_rad(0), plan.theta_step_rad()};
}

UniformLines UniformLines::needed(const ProbeOptics& optics) {
  const auto& plan = optics.plan();
  const UniformLines all = of(plan);
  if (all.count == 1) return all;
  double cell_rad = HUGE_VAL;
  for (int i = 0; i < kRanges; ++i) {
    const double range_m = plan.acquisition().depth_m * (i + 0.5) / kRanges;
    cell_rad = std::min(cell_rad, cell_m(optics, range_m) / (plan.probe().radius_m + range_m));
  }
  const double sector_rad = (all.count - 1) * all.step_rad;
  const double steps = std::max(1.0, std::ceil(sector_rad * kLinesPerCell / cell_rad));
  if (steps >= all.count - 1) return all;
  const int count = 1 + static_cast<int>(steps);
  return {count, all.first_rad, sector_rad / (count - 1)};
}

LineCovariance::LineCovariance(const ProbeOptics& optics, const UniformLines& lines)
    : optics_(optics), lines_(lines) {
  for (int line = 0; line < lines.count; ++line) {
    apertures_.emplace_back(optics, lines.first_rad + line * lines.step_rad);
  }
}

BandedMatrix LineCovariance::at(double range_m) const {
  const double radius_m = optics_.probe().radius_m;
  const double reach_rad =
      std::min(lateral_row_reach_m(optics_, range_m) / (radius_m + range_m), kMostReach_rad);
  if (lines_.count == 1 || lines_.step_rad > 2 * reach_rad) {
    BandedMatrix alone(lines_.count, 0);
    std::fill(alone.values.begin(), alone.values.end(), 1);
    return alone;
  }
  const Arc arc(
      radius_m, range_m, lines_.step_rad, point_step_rad(optics_, range_m, reach_rad), reach_rad);
  const LineResponses at_range(optics_, arc, range_m);
  std::vector<LineResponse> responses;
  for (int line = 0; line < lines_.count; ++line) {
    responses.push_back(at_range.of(line, apertures_[static_cast<std::size_t>(line)]));
  }
  return covariance_of(responses, std::min(lines_.count - 1, arc.neighbours()));
}

}  // namespace wobblebench::sim
