#include "sim/beam/beam_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>

#include "base/parallel.h"
#include "base/units.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/beam/beam_pattern.h"
#include "sim/beam/point_spread.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<double>;

constexpr double kRow_m = 1e-3;
constexpr int kMaxRows = 512;
constexpr int kMinRows = 16;
constexpr int kColumns = 32;  // an error of -36 dB, from using the middle of the column
constexpr int kSideLobeColumns = 96;
static_assert(kMaxRows * kSideLobeColumns <= BeamTable::kMaxEntries);
constexpr int kSearchSteps = 128;
/// The reach in each direction leaves out this share of the beam's power, but is at least kMainLobe
/// of the distance to the first zero of the focused beam.
constexpr double kPowerBeyond = 1e-2;
constexpr double kMainLobe = 0.8;
constexpr double kPowerBeyondSideLobes = 5e-5;
constexpr double kLobes = 4;  // the main lobe and three side lobes

/// The pulse's power spectrum at a few frequencies, (f - f0) / f0.
struct Band {
  static constexpr int kCount = 7;
  std::array<double, kCount> offset{};
  std::array<double, kCount> weight{};  // sum 1
  double variance = 0;                  // sum of weight * offset^2

  explicit Band(const hw::AcquisitionPlan& plan) {
    // The spectrum of a Gaussian pulse of sigma s in range is one of sigma c / (4 pi s).
    const double sigma = plan.acquisition().sound_speed_m_s /
                         (4 * kPi * sigma_of_fwhm(axial_fwhm_m(plan))) /
                         plan.probe().center_frequency_hz / std::sqrt(2.0);
    const double widest = std::min(2.5 * sigma, 0.9);
    double sum = 0;
    for (int i = 0; i < kCount; ++i) {
      const double x = widest * (2.0 * i / (kCount - 1) - 1);
      offset[static_cast<std::size_t>(i)] = x;
      weight[static_cast<std::size_t>(i)] = std::exp(-0.5 * x * x / (sigma * sigma));
      sum += weight[static_cast<std::size_t>(i)];
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      weight[i] /= sum;
      variance += weight[i] * offset[i] * offset[i];
    }
  }
};

/// A response over the band.
using Spectrum = std::array<Complex, Band::kCount>;

/// The response in one direction, and the bounds of its reach.
struct Source {
  const hw::AcquisitionPlan& plan;
  Complex (*two_way)(const hw::AcquisitionPlan&, double frequency_hz, double range_m, double off_m);
  double (*aperture_m)(const hw::AcquisitionPlan&, double range_m);
  double focus_m;
  double beyond;  ///< share of the power beyond the reach

  Complex response(double frequency_ratio, double range_m, double offset_m) const {
    return two_way(plan, frequency_ratio * plan.probe().center_frequency_hz, range_m, offset_m);
  }
  /// From the axis to the first zero of the focused beam.
  double lobe_m(double range_m) const {
    const double wavelength_m =
        plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz;
    return wavelength_m * range_m / aperture_m(plan, range_m);
  }
  /// Bounds of the reach.
  double widest_m(double range_m) const {
    const double shadow_m = aperture_m(plan, range_m) * std::abs(1 - range_m / focus_m);
    return kLobes * lobe_m(range_m) + 0.5 * shadow_m;
  }
  double narrowest_m(double range_m) const { return kMainLobe * lobe_m(range_m); }
};

double element_height_m(const hw::AcquisitionPlan& plan, double) {
  return plan.probe().element_height_m;
}

struct Column {
  Complex level;  // A
  Complex slope;  // B
};

/// One direction at one range.
struct Row {
  double reach_m = 0;
  double delay_m = 0;
  double curvature_per_m = 0;
  std::vector<Column> columns;
};

class RowBuilder {
 public:
  RowBuilder(const hw::AcquisitionPlan& plan, const Source& source, int columns)
      : source_(source),
        band_(plan),
        columns_(columns),
        wavenumber_per_m_(2 * kPi * plan.probe().center_frequency_hz /
                          plan.acquisition().sound_speed_m_s) {}

  Row row(double range_m) const {
    Row row;
    row.reach_m = edge_m(range_m);
    std::vector<Spectrum> spectra;
    for (int c = 0; c < columns_; ++c) spectra.push_back(spectrum(range_m, offset_m(row, c)));
    fit_delays(spectra, row);
    const Complex on_axis = source_.response(1, range_m, 0);
    for (int c = 0; c < columns_; ++c) {
      const double delay_m =
          row.delay_m + row.curvature_per_m * offset_m(row, c) * offset_m(row, c);
      row.columns.push_back(column(spectra[static_cast<std::size_t>(c)], delay_m, on_axis));
    }
    return row;
  }

  double offset_m(const Row& row, int column) const {
    return row.reach_m * (column + 0.5) / columns_;
  }
  double variance() const { return band_.variance; }

 private:
  Spectrum spectrum(double range_m, double offset_m) const {
    Spectrum result;
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = source_.response(1 + band_.offset[i], range_m, offset_m);
    }
    return result;
  }

  /// The reach.
  double edge_m(double range_m) const {
    const double step = source_.widest_m(range_m) / kSearchSteps;
    std::vector<double> power;
    for (int i = 0; i < kSearchSteps; ++i) {
      power.push_back(std::norm(source_.response(1, range_m, (i + 0.5) * step)));
    }
    double outside = source_.beyond * std::accumulate(power.begin(), power.end(), 0.0);
    int last = kSearchSteps - 1;
    while (last > 0 && power[static_cast<std::size_t>(last)] <= outside) {
      outside -= power[static_cast<std::size_t>(last--)];
    }
    const double edge = last + 1 - outside / power[static_cast<std::size_t>(last)];
    return std::max(source_.narrowest_m(range_m), edge * step);
  }

  /// Least-squares parabola through the delays over the row, weighted by power.
  void fit_delays(const std::vector<Spectrum>& spectra, Row& row) const {
    double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
    const double spacing = band_.offset[1] - band_.offset[0];
    for (int c = 0; c < columns_; ++c) {
      const Spectrum& at = spectra[static_cast<std::size_t>(c)];
      Complex correlation = 0;
      for (std::size_t i = 1; i < at.size(); ++i) {
        correlation +=
            std::sqrt(band_.weight[i] * band_.weight[i - 1]) * at[i] * std::conj(at[i - 1]);
      }
      const double delay = -std::arg(correlation) / (2 * wavenumber_per_m_ * spacing);
      const double u2 = offset_m(row, c) * offset_m(row, c);
      const double weight = std::abs(correlation);
      w += weight;
      wx += weight * u2;
      wxx += weight * u2 * u2;
      wy += weight * delay;
      wxy += weight * u2 * delay;
    }
    const double determinant = w * wxx - wx * wx;
    if (determinant <= 0) return;
    row.delay_m = (wxx * wy - wx * wxy) / determinant;
    row.curvature_per_m = (w * wxy - wx * wy) / determinant;
  }

  Column column(const Spectrum& spectrum, double delay_m, const Complex& on_axis) const {
    Column result;
    for (std::size_t i = 0; i < spectrum.size(); ++i) {
      const double phase = 2 * wavenumber_per_m_ * (1 + band_.offset[i]) * delay_m;
      const Complex aligned = spectrum[i] * std::polar(band_.weight[i], phase) / on_axis;
      result.level += aligned;
      result.slope += band_.offset[i] / band_.variance * aligned;
    }
    return result;
  }

  const Source& source_;
  Band band_;
  int columns_;
  double wavenumber_per_m_;
};

/// Integrals over a row, for the beam's area.
struct RowPower {
  double level = 0;
  double slope = 0;
  Complex cross = 0;

  RowPower(const Row& row, const RowBuilder& builder) {
    const double width = 2 * (builder.offset_m(row, 1) - builder.offset_m(row, 0));
    for (const Column& at : row.columns) {
      level += width * std::norm(at.level);
      slope += width * std::norm(at.slope);
      cross += width * at.level * std::conj(at.slope);
    }
  }
};

/// Power of the product of both directions, (A + B e)(A' + B' e), its e^2 term neglected.
double area(const RowPower& a, const RowPower& b, double variance) {
  const double slope =
      a.level * b.slope + a.slope * b.level + 2 * std::real(a.cross * std::conj(b.cross));
  return a.level * b.level + variance * slope;
}

/// At a zero of `level` the phase is that of 1, and the slope alone gives the echo.
BeamTable::Value to_value(const Column& column) {
  constexpr double kFaintest = 1e-6;
  const double amplitude = std::max(std::abs(column.level), kFaintest);
  const Complex direction = std::abs(column.level) > 0 ? column.level / std::abs(column.level) : 1;
  const Complex slope = column.slope / (amplitude * direction);
  return {static_cast<float>(amplitude),
          static_cast<float>(std::arg(direction) / (2 * kPi)),
          static_cast<float>(slope.real()),
          static_cast<float>(slope.imag())};
}

void store(const Row& row, int columns, std::size_t at, BeamTable::Direction& direction) {
  direction.rows[at] = {static_cast<float>(columns / row.reach_m),
                        static_cast<float>(row.delay_m),
                        static_cast<float>(row.curvature_per_m)};
  std::transform(row.columns.begin(),
                 row.columns.end(),
                 direction.values.begin() + static_cast<std::ptrdiff_t>(at) * columns,
                 to_value);
}

}  // namespace

BeamTable::BeamTable(const hw::AcquisitionPlan& plan, BeamShape shape, int threads)
    : columns_(shape == BeamShape::side_lobes ? kSideLobeColumns : kColumns) {
  const double depth_m = plan.acquisition().depth_m;
  const int count = std::clamp(static_cast<int>(std::ceil(depth_m / kRow_m)), kMinRows, kMaxRows);
  rows_per_m_ = count / depth_m;
  const auto& probe = plan.probe();
  const double beyond = shape == BeamShape::main_lobe ? kPowerBeyond : kPowerBeyondSideLobes;
  const Source lateral_source{
      plan, lateral_response, receive_aperture_m, probe.transmit_focus_m, beyond};
  const Source elevation_source{
      plan, elevation_response, element_height_m, probe.elevation_focus_m, beyond};
  const RowBuilder lateral(plan, lateral_source, columns_);
  const RowBuilder elevation(plan, elevation_source, columns_);
  for (Direction* direction : {&lateral_, &elevation_}) {
    direction->rows.resize(static_cast<std::size_t>(count));
    direction->values.resize(static_cast<std::size_t>(count) * columns_);
  }
  area_m2_.resize(static_cast<std::size_t>(count));
  parallel_ranges(count, threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const double range_m = (i + 0.5) / rows_per_m_;
      const auto at = static_cast<std::size_t>(i);
      const Row lateral_row = lateral.row(range_m), elevation_row = elevation.row(range_m);
      store(lateral_row, columns_, at, lateral_);
      store(elevation_row, columns_, at, elevation_);
      const RowPower lateral_power(lateral_row, lateral), elevation_power(elevation_row, elevation);
      area_m2_[at] = area(lateral_power, elevation_power, lateral.variance());
    }
  });
}

int BeamTable::row(double range_m) const {
  return std::clamp(static_cast<int>(range_m * rows_per_m_), 0, rows() - 1);
}

}  // namespace wobblebench::sim
