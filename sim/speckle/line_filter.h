// Gives the white noise of a frame the correlation that speckle has between its lines.
#pragma once

#include <complex>
#include <vector>

#include "sim/options.h"
#include "sim/speckle/line_covariance.h"

namespace wobblebench::sim {

/// Multiplies by the triangular factor of the lines' covariance, which serves lines of different
/// apertures, and the ends of the scan. Keeps the mean power.
class LineFilter {
 public:
  /// For sticks whose sample i lies at range (i + 1/2) * spacing_m.
  LineFilter(const hw::AcquisitionPlan& plan,
             const SimulationOptions& options,
             int samples,
             double spacing_m);

  /// `frame`: lines x samples, sample fastest.
  void apply(std::complex<float>* frame) const;

 private:
  /// Samples between two ranges at which the covariance is factored.
  struct Span {
    int first, last;        ///< samples; the last is beyond
    std::size_t near, far;  ///< of factors_
    float share;            ///< of the far one, at the first sample
    float share_step;       ///< a sample
  };
  /// Of factored_ lines.
  void correlate(std::complex<float>* noise, int line, const Span& span) const;
  void interpolate(const std::complex<float>* from, int line, std::complex<float>* target) const;

  int samples_;
  int lines_;
  EvenLines factored_;
  std::vector<Span> spans_;
  std::vector<BandedMatrix> factors_;  ///< by range
};

}  // namespace wobblebench::sim
