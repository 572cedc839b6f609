#include "sim/speckle/line_covariance.h"

#include <algorithm>
#include <cmath>

#include "sim/math/complex.h"
#include "sim/math/simd.h"
#include "sim/optics/point_spread.h"
#include "sim/speckle/field_correlation.h"

namespace wobblebench::sim {

namespace {

constexpr int kNodes = PulseBand::kNodes;
constexpr int kPlaces = 48;           ///< a side, within the reach of a line, at least
constexpr double kMostReach_rad = 1;  ///< very near the face
/// Four over the width of speckle at the focus: a Gaussian correlation is up to 4 % too large, up
/// to half of that width, between lines that lie halfway.
constexpr double kLinesPerCell = 2;
constexpr int kRanges = 32;  ///< at which cells are looked at

double sine(double aperture_m, double range_m) {
  return 0.5 * aperture_m / std::hypot(range_m, 0.5 * aperture_m);
}

/// Speckle across lines is no finer at a range: one over the spatial frequencies of which the
/// two-way response consists. At the focus its full width at half maximum is 1.9 cells.
double cell_m(const hw::AcquisitionPlan& plan, double range_m) {
  return 0.5 * wavelength_m(plan) /
         (sine(transmit_aperture_m(plan, range_m), range_m) +
          sine(receive_aperture_m(plan, range_m), range_m));
}

/// Between places, so that sums over them are integrals: the sampling theorem for the product of
/// two responses at the upper end of the band.
double place_step_rad(const hw::AcquisitionPlan& plan, double range_m, double reach_rad) {
  constexpr double kWithinLimit = 0.85;
  const double highest = 1 + 0.5 * plan.probe().fractional_bandwidth;
  const double limit_rad = cell_m(plan, range_m) / highest / (plan.probe().radius_m + range_m);
  return std::min(reach_rad / kPlaces, kWithinLimit * limit_rad);
}

/// Places of scatterers at a range, on an arc about the probe's centre of curvature. Lines and
/// places lie at multiples of one angle, so that lines with the same aperture hear the same.
class Arc {
 public:
  /// Places at most `place_step_rad` apart.
  Arc(double radius_m,
      double range_m,
      double line_step_rad,
      double place_step_rad,
      double reach_rad)
      : radius_m_(radius_m), range_m_(range_m) {
    if (line_step_rad > place_step_rad) {
      per_line_ = static_cast<int>(std::ceil(line_step_rad / place_step_rad));
    } else {
      per_place_ = static_cast<int>(place_step_rad / line_step_rad);
    }
    unit_rad_ = line_step_rad / per_line_;
    reach_ = static_cast<int>(reach_rad / unit_rad_);
  }

  /// On either side of a line, in units.
  int reach() const { return reach_; }
  /// In the plane of a line, so many units from it.
  PlanePoint place(int units) const {
    const double angle = units * unit_rad_, r = radius_m_ + range_m_;
    return {r * std::cos(angle) - radius_m_, r * std::sin(angle)};
  }
  /// The first place within reach of a line, counted from the first line.
  int first_place(int line) const {
    const int units = line * per_line_ - reach_;
    return units >= 0 ? (units + per_place_ - 1) / per_place_ : -(-units / per_place_);
  }
  /// From a line to a place.
  int units(int place, int line) const { return place * per_place_ - line * per_line_; }
  /// Lines on one side that hear places which a line hears.
  int neighbours() const { return 2 * reach_ / per_line_; }

 private:
  double radius_m_, range_m_;
  double unit_rad_ = 0;
  int per_line_ = 1, per_place_ = 1, reach_ = 0;
};

/// What a line hears of the places from `first` on, in units in which its power is 1.
struct Heard {
  int first = 0;
  std::vector<float> re, im;  ///< [place][node]

  int end() const { return first + static_cast<int>(re.size()) / kNodes; }
};

/// The sum over places and frequencies of one line's times the other's conjugate.
WOBBLEBENCH_SIMD void add_products(const float* re1,
                                   const float* im1,
                                   const float* re2,
                                   const float* im2,
                                   int places,
                                   float* __restrict re,
                                   float* __restrict im) {
  for (int i = 0; i < places; ++i) {
    for (int n = 0; n < kNodes; ++n) {
      const int at = i * kNodes + n;
      re[n] += re1[at] * re2[at] + im1[at] * im2[at];
      im[n] += im1[at] * re2[at] - re1[at] * im2[at];
    }
  }
}

std::complex<double> overlap(const Heard& one, const Heard& other) {
  const int first = std::max(one.first, other.first);
  const int places = std::min(one.end(), other.end()) - first;
  if (places <= 0) return 0;
  const auto in_one = static_cast<std::ptrdiff_t>(first - one.first) * kNodes;
  const auto in_other = static_cast<std::ptrdiff_t>(first - other.first) * kNodes;
  float re[kNodes] = {}, im[kNodes] = {};
  add_products(one.re.data() + in_one,
               one.im.data() + in_one,
               other.re.data() + in_other,
               other.im.data() + in_other,
               places,
               re,
               im);
  std::complex<double> sum = 0;
  for (int n = 0; n < kNodes; ++n) sum += std::complex<double>(re[n], im[n]);
  return sum;
}

/// What lines hear at one range.
class LineResponses {
 public:
  LineResponses(const hw::AcquisitionPlan& plan,
                Apodisation apodisation,
                const Arc& arc,
                double range_m)
      : plan_(plan), band_(plan), arc_(arc), range_m_(range_m) {
    const auto powers = node_powers(ElevationPlane(plan, band_, apodisation, range_m).row);
    std::vector<PlanePoint> places;
    for (int units = -arc.reach(); units <= arc.reach(); ++units) {
      places.push_back(arc.place(units));
      const double way_m = 2 * (places.back().axial_m - range_m);
      factors_.emplace_back();
      for (std::size_t n = 0; n < kNodes; ++n) {
        const int node = static_cast<int>(n);
        factors_.back()[n] = std::polar(std::sqrt(powers[n] * band_.weight(node)),
                                        -way_m * band_.wavenumber_per_m(node));
      }
    }
    whole_values_ = response(StickAperture(plan, apodisation, 0)).at(places);
  }

  Heard of(int line, const StickAperture& aperture) const {
    const bool whole = aperture.whole(range_m_);
    const int first = arc_.first_place(line);
    std::vector<int> units;
    std::vector<PlanePoint> places;
    std::vector<PulseBand::Values> values;
    for (int place = first; arc_.units(place, line) <= arc_.reach(); ++place) {
      units.push_back(arc_.units(place, line));
      if (whole) {
        values.push_back(whole_values_[from_first(units.back())]);
      } else {
        places.push_back(arc_.place(units.back()));
      }
    }
    if (!whole) values = response(aperture).at(places);
    return normalised(first, units, values);
  }

 private:
  std::size_t from_first(int units) const { return static_cast<std::size_t>(units + arc_.reach()); }
  PlaneResponse response(const StickAperture& aperture) const {
    return PlaneResponse::lateral(aperture, plan_, band_, range_m_);
  }

  Heard normalised(int first,
                   const std::vector<int>& units,
                   const std::vector<PulseBand::Values>& values) const {
    Heard heard{first, {}, {}};
    double power = 0;
    for (std::size_t i = 0; i < units.size(); ++i) {
      const PulseBand::Values& factors = factors_[from_first(units[i])];
      for (std::size_t n = 0; n < kNodes; ++n) {
        const std::complex<double> one = times(values[i][n], factors[n]);
        power += std::norm(one);
        heard.re.push_back(static_cast<float>(one.real()));
        heard.im.push_back(static_cast<float>(one.imag()));
      }
    }
    const auto scale = static_cast<float>(power > 0 ? 1 / std::sqrt(power) : 0);
    for (float& part : heard.re) part *= scale;
    for (float& part : heard.im) part *= scale;
    return heard;
  }

  const hw::AcquisitionPlan& plan_;
  PulseBand band_;
  const Arc& arc_;
  double range_m_;
  // By units from the line.
  std::vector<PulseBand::Values> factors_;       ///< root of the node's power, phase of the way
  std::vector<PulseBand::Values> whole_values_;  ///< of a line that the array's end does not reach
};

/// Each line's phase is turned so that its covariance with the line before it is real; of the
/// others the real part is kept.
BandedMatrix covariance_of(const std::vector<Heard>& heard, int band) {
  const int lines = static_cast<int>(heard.size());
  BandedMatrix covariance(lines, band);
  std::vector<std::complex<double>> phasors;
  for (int line = 0; line < lines; ++line) {
    covariance.at(line, 0) = 1;
    phasors.emplace_back(line == 0 ? 1 : phasors.back());
    for (int lag = 1; lag <= std::min(line, band); ++lag) {
      const auto at = static_cast<std::size_t>(line), other = at - static_cast<std::size_t>(lag);
      const std::complex<double> sum = overlap(heard[at], heard[other]);
      const double magnitude = std::abs(sum);
      if (lag == 1 && magnitude > 0) phasors[at] = times(phasors[other], sum / magnitude);
      const std::complex<double> turn = times(phasors[other], std::conj(phasors[at]));
      covariance.at(line, lag) = times(sum, turn).real();
    }
  }
  return covariance;
}

}  // namespace

EvenLines EvenLines::of(const hw::AcquisitionPlan& plan) {
  return {plan.acquisition().sticks_per_frame, plan.theta_rad(0), plan.theta_step_rad()};
}

EvenLines EvenLines::needed(const hw::AcquisitionPlan& plan) {
  const EvenLines all = of(plan);
  if (all.count == 1) return all;
  double cell_rad = HUGE_VAL;
  for (int i = 0; i < kRanges; ++i) {
    const double range_m = plan.acquisition().depth_m * (i + 0.5) / kRanges;
    cell_rad = std::min(cell_rad, cell_m(plan, range_m) / (plan.probe().radius_m + range_m));
  }
  const double sector_rad = (all.count - 1) * all.step_rad;
  const double steps = std::max(1.0, std::ceil(sector_rad * kLinesPerCell / cell_rad));
  if (steps >= all.count - 1) return all;
  const int count = 1 + static_cast<int>(steps);
  return {count, all.first_rad, sector_rad / (count - 1)};
}

LineCovariance::LineCovariance(const hw::AcquisitionPlan& plan,
                               Apodisation apodisation,
                               const EvenLines& lines)
    : plan_(plan), apodisation_(apodisation), lines_(lines) {
  for (int line = 0; line < lines.count; ++line) {
    apertures_.emplace_back(plan, apodisation, lines.first_rad + line * lines.step_rad);
  }
}

BandedMatrix LineCovariance::at(double range_m) const {
  const double radius_m = plan_.probe().radius_m;
  const double reach_rad =
      std::min(lateral_reach_m(plan_, range_m) / (radius_m + range_m), kMostReach_rad);
  if (lines_.count == 1 || lines_.step_rad > 2 * reach_rad) {
    BandedMatrix alone(lines_.count, 0);
    std::fill(alone.values.begin(), alone.values.end(), 1);
    return alone;
  }
  const Arc arc(
      radius_m, range_m, lines_.step_rad, place_step_rad(plan_, range_m, reach_rad), reach_rad);
  const LineResponses responses(plan_, apodisation_, arc, range_m);
  std::vector<Heard> heard;
  for (int line = 0; line < lines_.count; ++line) {
    heard.push_back(responses.of(line, apertures_[static_cast<std::size_t>(line)]));
  }
  return covariance_of(heard, std::min(lines_.count - 1, arc.neighbours()));
}

}  // namespace wobblebench::sim
