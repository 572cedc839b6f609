#include "sim/optics/plane_response.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "sim/math/fast_math.h"

namespace wobblebench::sim {

namespace {

/// Points are computed in batches; loops over a batch are vectorised.
constexpr int kBatch = 32;

struct PointLanes {
  float axial_m[kBatch];
  float offset_m[kBatch];
};

/// A source seen from a batch of points.
struct Seen {
  float excess_m[kBatch];  ///< path length minus the axial distance
  float amplitude[kBatch];
  float sine2[kBatch];  ///< squared sine of the angle to the source's normal
};

struct SourcePosition {
  float axial_m;
  float lateral_m;
  float normal_axial;
  float normal_lateral;
  float lens_m;
};

/// Responses of a batch of points in one direction, transmit or receive.
struct OneWay {
  float re[kBatch];
  float im[kBatch];
};

/// Largest x^2 of the series of sin(x) / x.
constexpr float kMostOfSeries = 9;

/// sin(x) / x by x^2, up to kMostOfSeries.
WOBBLEBENCH_INLINE float sinc_series(float x2) {
  const float q = x2 < kMostOfSeries ? x2 : kMostOfSeries;
  return 1.0f - q * (1.0f / 6.0f) *
                    (1.0f - q * (1.0f / 20.0f) *
                                (1.0f - q * (1.0f / 42.0f) * (1.0f - q * (1.0f / 72.0f))));
}

/// The same for any x, for elements wider than a wavelength.
WOBBLEBENCH_INLINE float sinc(float x2) {
  const float x = std::sqrt(x2 > 1.0f ? x2 : 1.0f);
  const float beyond = cos_sin_of_cycles(x * static_cast<float>(0.5 / kPi)).sine / x;
  return x2 < 1.0f ? sinc_series(x2) : beyond;
}

WOBBLEBENCH_SIMD void see(const SourcePosition& source,
                          const PointLanes& points,
                          bool spreads,
                          Seen& __restrict seen) {
  const SourcePosition from = source;
  for (int i = 0; i < kBatch; ++i) {
    const float axial = points.axial_m[i] - from.axial_m;
    const float lateral = points.offset_m[i] - from.lateral_m;
    const float distance = std::sqrt(axial * axial + lateral * lateral);
    const float per_distance = 1.0f / distance;
    const float sine = (axial * from.normal_lateral - lateral * from.normal_axial) * per_distance;
    seen.excess_m[i] = distance - points.axial_m[i] + from.lens_m;
    seen.amplitude[i] = spreads ? per_distance : 1.0f;
    seen.sine2[i] = sine * sine;
  }
}

/// Adds a source at one frequency: its phasor at the points times `transmit` and `receive`.
template <float (*kSinc)(float)>
WOBBLEBENCH_SIMD void add_source(const Seen& seen,
                                 float cycles_per_m,
                                 float half_width2,
                                 std::complex<float> transmit,
                                 std::complex<float> receive,
                                 OneWay& __restrict sent,
                                 OneWay& __restrict received) {
  const float transmit_re = transmit.real(), transmit_im = transmit.imag();
  const float receive_re = receive.real(), receive_im = receive.imag();
  for (int i = 0; i < kBatch; ++i) {
    const float amplitude = seen.amplitude[i] * kSinc(half_width2 * seen.sine2[i]);
    const CosSin at = cos_sin_of_cycles(-cycles_per_m * seen.excess_m[i]);
    const float re = amplitude * at.cosine, im = amplitude * at.sine;
    sent.re[i] += re * transmit_re - im * transmit_im;
    sent.im[i] += re * transmit_im + im * transmit_re;
    received.re[i] += re * receive_re - im * receive_im;
    received.im[i] += re * receive_im + im * receive_re;
  }
}

}  // namespace

PlaneResponse::Phasors PlaneResponse::phasors(double weight, double delay_m) const {
  Phasors at = {};
  for (int node = 0; node < band_.nodes(); ++node) {
    const auto phasor = std::polar(weight, band_.wavenumber_per_m(node) * delay_m);
    at.re[node] = static_cast<float>(phasor.real());
    at.im[node] = static_cast<float>(phasor.imag());
  }
  return at;
}

PlaneResponse PlaneResponse::lateral(const StickAperture& aperture, double range_m) {
  const ProbeOptics& optics = aperture.optics();
  PlaneResponse response(optics.band());
  response.half_width_m_ = 0.5 * optics.probe().pitch_m;
  response.spreads_ = true;
  const double focus_m = optics.transmit_focus_m(range_m);
  for (const Element& element : aperture.elements()) {
    const double sent = aperture.transmit_weight(element, range_m);
    const double received = aperture.receive_weight(element, range_m);
    if (sent == 0 && received == 0) continue;
    response.sources_.push_back(
        {static_cast<float>(element.axial_m),
         static_cast<float>(element.lateral_m),
         static_cast<float>(std::cos(element.angle_rad)),
         static_cast<float>(std::sin(element.angle_rad)),
         0,
         response.phasors(sent, StickAperture::excess_m(element, focus_m)),
         response.phasors(received, StickAperture::excess_m(element, range_m))});
  }
  return response;
}

InPlaneExcess::InPlaneExcess(const StickAperture& aperture, double range_m) {
  const ProbeOptics& optics = aperture.optics();
  const double focus_m = optics.transmit_focus_m(range_m);
  std::complex<double> sent = 0, sent_path = 0;
  double received = 0, received_path = 0, least_m = HUGE_VAL, most_m = -HUGE_VAL;
  for (const Element& element : aperture.elements()) {
    const double excess_m = StickAperture::excess_m(element, range_m);
    const double late_m = excess_m - StickAperture::excess_m(element, focus_m);
    const std::complex<double> one =
        std::polar(aperture.transmit_weight(element, range_m) / (range_m + excess_m),
                   -optics.band().center_per_m() * late_m);
    const double focused = aperture.receive_weight(element, range_m) / (range_m + excess_m);
    sent += one;
    sent_path += one * excess_m;
    if (std::norm(one) > 0) {
      least_m = std::min(least_m, excess_m);
      most_m = std::max(most_m, excess_m);
    }
    received += focused;
    received_path += focused * excess_m;
  }
  // Out of focus the weights are complex, and the weighted mean may lie outside the range of the
  // path lengths. It is unbounded where the elements nearly cancel each other.
  const double spread_m = most_m - least_m;
  if (std::norm(sent) > 0) {
    sent_m = std::clamp((sent_path / sent).real(), least_m - spread_m, most_m + spread_m);
  }
  if (received > 0) received_m = received_path / received;
}

PlaneResponse PlaneResponse::elevation(const ProbeOptics& optics, double range_m) {
  return elevation(optics, InPlaneExcess(StickAperture(optics, 0), range_m));
}

PlaneResponse PlaneResponse::elevation(const ProbeOptics& optics, const InPlaneExcess& excess) {
  const ElevationSources& sources = optics.lens();
  PlaneResponse response(optics.band());
  const Phasors one = response.phasors(1.0 / static_cast<double>(sources.height_m.size()), 0);
  for (std::size_t i = 0; i < sources.height_m.size(); ++i) {
    const auto add = [&](double excess_m, const Phasors& transmit, const Phasors& receive) {
      // The source is farther by the excess; the phase of the excess belongs to the image plane.
      response.sources_.push_back({static_cast<float>(-excess_m),
                                   static_cast<float>(sources.height_m[i]),
                                   1,
                                   0,
                                   static_cast<float>(sources.lens_m[i] - excess_m),
                                   transmit,
                                   receive});
    };
    add(excess.sent_m, one, {});
    add(excess.received_m, {}, one);
  }
  return response;
}

std::vector<PulseBand::Values> PlaneResponse::at(std::span<const PlanePoint> points) const {
  std::vector<PulseBand::Values> values(points.size());
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    const std::size_t count = std::min<std::size_t>(kBatch, points.size() - first);
    PointLanes lanes;
    for (std::size_t i = 0; i < kBatch; ++i) {
      const PlanePoint& point = points[first + std::min(i, count - 1)];
      lanes.axial_m[i] = static_cast<float>(point.axial_m);
      lanes.offset_m[i] = static_cast<float>(point.offset_m);
    }
    OneWay sent[PulseBand::kNodes] = {}, received[PulseBand::kNodes] = {};
    Seen seen;
    for (const Source& source : sources_) {
      see({source.axial_m,
           source.lateral_m,
           source.normal_axial,
           source.normal_lateral,
           source.lens_m},
          lanes,
          spreads_,
          seen);
      for (int node = 0; node < band_.nodes(); ++node) {
        const double wavenumber = band_.wavenumber_per_m(node);
        const double half_width = wavenumber * half_width_m_;
        const auto half_width2 = static_cast<float>(half_width * half_width);
        const auto add = half_width2 > kMostOfSeries ? add_source<sinc> : add_source<sinc_series>;
        add(seen,
            static_cast<float>(wavenumber / (2 * kPi)),
            half_width2,
            {source.transmit.re[node], source.transmit.im[node]},
            {source.receive.re[node], source.receive.im[node]},
            sent[node],
            received[node]);
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (int node = 0; node < band_.nodes(); ++node) {
        values[first + i][static_cast<std::size_t>(node)] =
            std::complex<double>(sent[node].re[i], sent[node].im[i]) *
            std::complex<double>(received[node].re[i], received[node].im[i]);
      }
    }
  }
  return values;
}

PulseBand::Values PlaneResponse::on_axis(double range_m) const {
  const PlanePoint axis{range_m, 0};
  return at({&axis, 1}).front();
}

}  // namespace wobblebench::sim
