#include "sim/optics/element_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/math/fast_math.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::sim {

namespace {

using Complex = std::complex<double>;

constexpr int kLeastColumns = 3;     ///< of an element; wider ones have two for each wavelength
constexpr double kBandSigmas = 3.2;  ///< the spectrum has 0.6 % of its peak there
constexpr double kPulseSigmas = 4;   ///< the pulse has 0.03 % of its peak there
constexpr double kPeriodSlack = 1.1;
constexpr int kLanes = 8;

/// sums[f] += weight * exp(-i (k0 + f dk) path) over sources, eight at a time: their
/// recurrences are independent.
void add_sources(const double* paths,
                 const double* weights,
                 std::size_t count,
                 double first_per_m,
                 double step_per_m,
                 std::span<Complex> sums) {
  for (std::size_t s = 0; s < count; s += kLanes) {
    double re[kLanes], im[kLanes], step_re[kLanes], step_im[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const bool valid = s + i < count;
      const double path = valid ? paths[s + i] : 0;
      const double weight = valid ? weights[s + i] : 0;
      re[i] = weight * std::cos(first_per_m * path);
      im[i] = -weight * std::sin(first_per_m * path);
      step_re[i] = std::cos(step_per_m * path);
      step_im[i] = -std::sin(step_per_m * path);
    }
    for (Complex& sum : sums) {
      double sum_re = 0, sum_im = 0;
      for (std::size_t i = 0; i < kLanes; ++i) {
        sum_re += re[i];
        sum_im += im[i];
        const double next = re[i] * step_re[i] - im[i] * step_im[i];
        im[i] = re[i] * step_im[i] + im[i] * step_re[i];
        re[i] = next;
      }
      sum += Complex(sum_re, sum_im);
    }
  }
}

}  // namespace

ElementSum::ElementSum(const ProbeOptics& optics, double theta_rad)
    : sigma_m_(optics.band().sigma_m()),
      wavenumber_per_m_(optics.band().center_per_m()),
      optics_(optics),
      aperture_(optics, theta_rad),
      columns_per_element_(std::max(
          kLeastColumns,
          static_cast<int>(std::ceil(2 * optics.probe().pitch_m / optics.wavelength_m())))) {
  const double radius_m = optics.probe().radius_m;
  const double width_rad = optics.probe().pitch_m / radius_m;
  for (std::size_t e = 0; e < aperture_.elements().size(); ++e) {
    for (int c = 0; c < columns_per_element_; ++c) {
      const double at =
          aperture_.elements()[e].angle_rad + ((c + 0.5) / columns_per_element_ - 0.5) * width_rad;
      columns_.push_back({radius_m * (std::cos(at) - 1), radius_m * std::sin(at), e});
    }
  }
}

std::size_t ElementSum::sources(double range_m) const {
  std::size_t sending = 0, receiving = 0;
  for (const Element& element : aperture_.elements()) {
    sending += aperture_.transmit_weight(element, range_m) > 0;
    receiving += aperture_.receive_weight(element, range_m) > 0;
  }
  return (sending + receiving) * sources_per_element();
}

ElementSum::Paths ElementSum::paths_to(const glm::dvec3& point_m) const {
  Paths paths;
  for (const Column& column : columns_) {
    const double in_plane = std::hypot(point_m.x - column.axial_m, point_m.y - column.lateral_m);
    for (std::size_t i = 0; i < optics_.lens().height_m.size(); ++i) {
      const double distance = std::hypot(in_plane, point_m.z - optics_.lens().height_m[i]);
      paths.length_m.push_back(distance + optics_.lens().lens_m[i]);
      paths.weight.push_back(1 / distance);
    }
  }
  return paths;
}

ElementSum::Band ElementSum::band(double spread_m, double frequency_ratio) const {
  // A Gaussian pulse of sigma s over range is one of sigma 1 / 2 s over wavenumber.
  const double sigma = 0.5 / sigma_m_;
  const double down = (1 - frequency_ratio) * wavenumber_per_m_;
  const double half =
      std::min(kBandSigmas * sigma + down, (1 - PulseBand::kLowest) * wavenumber_per_m_);
  // Sampling over wavenumber repeats the echo over range: a period of pi in k r.
  const double step = kPi / (kPeriodSlack * (spread_m + 2 * kPulseSigmas * sigma_m_));
  const int steps = static_cast<int>(std::ceil(half / step));
  Band band;
  double sum = 0;
  for (int i = -steps; i <= steps; ++i) {
    const double away = half * i / steps;
    band.wavenumber_per_m.push_back(wavenumber_per_m_ + away);
    band.amplitude.push_back(std::exp(-(0.5 * away + down) * away / (sigma * sigma)));
    sum += band.amplitude.back();
  }
  for (double& power : band.amplitude) power /= sum;
  return band;
}

std::vector<Complex> ElementSum::element_spectra(const Paths& paths,
                                                 const Band& band,
                                                 double range_m,
                                                 double last_m) const {
  const std::size_t count = band.amplitude.size(), each = sources_per_element();
  const double step = band.wavenumber_per_m[1] - band.wavenumber_per_m[0];
  const auto& elements = aperture_.elements();
  std::vector<Complex> spectra(elements.size() * count);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const bool transmits = aperture_.transmit_weight(elements[e], range_m) > 0;
    if (!transmits && aperture_.receive_weight(elements[e], last_m) == 0) continue;
    add_sources(paths.length_m.data() + e * each,
                paths.weight.data() + e * each,
                each,
                band.wavenumber_per_m[0],
                step,
                {spectra.data() + e * count, count});
  }
  return spectra;
}

Complex ElementSum::sample(const std::vector<Complex>& spectra,
                           const std::vector<Complex>& sent,
                           const Band& band,
                           double range_m) const {
  const std::size_t count = band.amplitude.size();
  const double step = band.wavenumber_per_m[1] - band.wavenumber_per_m[0];
  std::vector<Complex> received(count);
  const auto& elements = aperture_.elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const double share = aperture_.receive_weight(elements[e], range_m);
    if (share == 0) continue;
    const double late = StickAperture::excess_m(elements[e], range_m);
    Complex rotation = std::polar(share, band.wavenumber_per_m[0] * late);
    const Complex step_rotation = std::polar(1.0, step * late);
    for (std::size_t f = 0; f < count; ++f) {
      received[f] += times(spectra[e * count + f], rotation);
      rotation = times(rotation, step_rotation);
    }
  }
  // The sample at time 2 r / c, demodulated.
  Complex rotation = std::polar(1.0, 2 * band.wavenumber_per_m[0] * range_m);
  const Complex step_rotation = std::polar(1.0, 2 * step * range_m);
  Complex sum = 0;
  for (std::size_t f = 0; f < count; ++f) {
    sum += times(times(sent[f], received[f]), rotation);
    rotation = times(rotation, step_rotation);
  }
  return sum * std::polar(1.0, -2 * wavenumber_per_m_ * range_m);
}

ElementSum::Extent ElementSum::extent(const Paths& paths, double range_m) const {
  const std::size_t each = sources_per_element();
  Extent extent{std::numeric_limits<double>::infinity(), 0};
  const auto& elements = aperture_.elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const bool transmits = aperture_.transmit_weight(elements[e], range_m) > 0;
    if (!transmits && aperture_.receive_weight(elements[e], range_m) == 0) continue;
    const double focus_m = StickAperture::excess_m(elements[e], range_m);
    const double transmit_m =
        StickAperture::excess_m(elements[e], optics_.transmit_focus_m(range_m));
    const double early_m = transmits ? std::max(transmit_m, focus_m) : focus_m;
    const double late_m = transmits ? std::min(transmit_m, focus_m) : focus_m;
    const auto [low, high] = std::minmax_element(paths.length_m.begin() + e * each,
                                                 paths.length_m.begin() + (e + 1) * each);
    extent.first_m = std::min(extent.first_m, *low - early_m);
    extent.last_m = std::max(extent.last_m, *high - late_m);
  }
  return extent;
}

std::vector<Complex> ElementSum::transmitted_spectrum(const std::vector<Complex>& spectra,
                                                      const Band& band,
                                                      double range_m) const {
  const std::size_t count = band.amplitude.size();
  std::vector<Complex> sent(count);
  const auto& elements = aperture_.elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const double share = aperture_.transmit_weight(elements[e], range_m);
    if (share == 0) continue;
    const double path_m = StickAperture::excess_m(elements[e], optics_.transmit_focus_m(range_m));
    for (std::size_t f = 0; f < count; ++f) {
      const double ahead = band.wavenumber_per_m[f] * path_m;
      sent[f] += times(spectra[e * count + f], std::polar(share, ahead));
    }
  }
  return sent;
}

void ElementSum::add(const BeamPoint& point,
                     double delay_m,
                     double spacing_m,
                     std::span<Complex> iq) const {
  const double margin_m = kPulseSigmas * sigma_m_;
  const Paths paths = paths_to(point.at_m);
  const Extent extent = this->extent(paths, point.at_m.x);
  const Band band = this->band(extent.last_m - extent.first_m, point.frequency_ratio);
  const std::vector<Complex> spectra =
      element_spectra(paths, band, point.at_m.x, extent.last_m + margin_m);
  std::vector<Complex> sent = transmitted_spectrum(spectra, band, point.at_m.x);
  for (std::size_t f = 0; f < sent.size(); ++f) sent[f] *= point.amplitude * band.amplitude[f];

  const int samples = static_cast<int>(iq.size());
  const int from = std::max(0, static_cast<int>((extent.first_m + delay_m - margin_m) / spacing_m));
  const int to =
      std::min(samples, static_cast<int>((extent.last_m + delay_m + margin_m) / spacing_m) + 1);
  for (int i = from; i < to; ++i) {
    const double range_m = (i + 0.5) * spacing_m - delay_m;
    const Complex echo = sample(spectra, sent, band, std::max(range_m, 1e-6));
    iq[static_cast<std::size_t>(i)] += echo * std::polar(1.0, -2 * wavenumber_per_m_ * delay_m);
  }
}

double ElementSum::on_axis(double range_m) const {
  // The largest of densely spaced samples around the range.
  const double spacing_m = 0.1 * sigma_m_;
  const int half = 20;
  const double first_m = range_m - (half + 0.5) * spacing_m;
  std::vector<Complex> around(2 * half + 1);
  add({{range_m, 0, 0}, 1}, -first_m, spacing_m, around);
  double largest = 0;
  for (const Complex& value : around) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace wobblebench::sim
