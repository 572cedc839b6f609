// Straight ray paths between the aperture and the beam: their geometry among the sticks of a
// volume, and the waves that they carry to sample points across the beam.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "hw/probe/probe.h"
#include "sim/losses/loss_table.h"
#include "sim/optics/probe_optics.h"

namespace wobblebench::sim {

/// The straight ray paths from the aperture to the points on a stick. The aperture is divided into
/// kLateral equal parts along the face and kElevation equal parts across the image plane; a path
/// starts at the middle of a part. Its distance from the axis at a depth is measured as an angle
/// about the face's centre of curvature, or about the motor's axis.
class ApertureCone {
 public:
  static constexpr int kLateral = 8;
  static constexpr int kElevation = 4;
  /// Transmit and receive.
  static constexpr int kEnds = 2;

  ApertureCone(const ProbeOptics& optics, const LossGrid& grid);

  /// Distance from the axis, in lines, of the path from a part to node `to`, between the nodes
  /// `from` and `from` + 1.
  float lines_aside(int end, int part, int from, int to) const {
    return lines_aside_[at(end, to, from) * kLateral + static_cast<std::size_t>(part)];
  }
  /// The same across the image plane, in metres.
  double elevation_m(int part, int from, int to) const;
  /// Frames per metre across the image plane between node `from` and the next, on each line.
  const float* frames_per_m(int from) const {
    return frames_per_m_.data() + static_cast<std::size_t>(from * grid_.lines);
  }
  /// Largest distance of a path from the axis between node `from` and the next, in frames.
  int most_frames(int from) const { return most_frames_[static_cast<std::size_t>(from)]; }
  /// Largest distance of any path from the axis, in lines.
  int most_lines() const;

  /// Fraction of a part of the aperture for a node that lies on the array, for each line. It is
  /// positive for at least one part.
  const float* on_array(int end, int part, int node) const {
    const int row = (end * grid_.nodes + node) * kLateral + part;
    return on_array_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.lines);
  }

 private:
  std::size_t at(int end, int to, int from) const {
    return static_cast<std::size_t>((end * grid_.nodes + to) * grid_.nodes + from);
  }
  /// Distance of a path from the axis between node `from` and the next, relative to the distance at
  /// its start, which lies `behind_m` behind the face's middle.
  double left(int from, int to, double behind_m) const;
  void locate_steps(const hw::AcquisitionPlan& plan);
  void locate(double aperture_m, int to);
  void weigh(double aperture_m);
  float share_on_array(double from_rad, double to_rad) const;

  hw::ProbeOptions probe_;
  LossGrid grid_;
  double lines_per_rad_;
  double array_rad_;                 ///< angle of the last element
  double widest_m_ = 0;              ///< of the apertures
  std::vector<double> theta_rad_;    ///< of each line
  std::vector<float> frames_per_m_;  ///< [node][line]
  std::vector<int> most_frames_;     ///< [node]
  std::vector<float> lines_aside_;   ///< [end][to][from][part]
  std::vector<float> on_array_;      ///< [end][node][part][line]
};

/// Sample points across the beam: for each node of a LossGrid, points in the image plane and across
/// it around the axis of a stick, and the wave at the centre frequency that reaches each of them
/// from each part of an ApertureCone. Waves are paraxial, with the phase pi h^2 (1 / r - 1 / focus)
/// / wavelength - 2 pi h y / (wavelength r) from height h to point y (Goodman, Introduction to
/// Fourier Optics, 4.2). Losses are interpolated between the middles of the parts.
class BeamSection {
 public:
  /// Equidistant points, up to twice the beam's width to either side.
  static constexpr int kPoints = 13;

  /// `cone` must be made of the same optics and grid.
  BeamSection(const ProbeOptics& optics, const LossGrid& grid, const ApertureCone& cone);

  /// A point in the image plane, in lines from the axis.
  float lines_aside(int node, int point) const { return lines_aside_[at(0, node, point)]; }
  /// A point across the image plane, in metres from the axis.
  float across_m(int node, int point) const { return across_m_[at(0, node, point)]; }
  /// Frames per metre across the image plane at a node, on each line.
  const float* frames_per_m(int node) const { return frames_per_m_.data() + row(node); }
  /// Largest distance of a point from the axis, in lines and in frames.
  int most_lines() const { return most_lines_; }
  int most_frames() const { return most_frames_; }

  /// Waves of the ApertureCone::kLateral parts at a point in the image plane, and of its kElevation
  /// parts at a point across it, where transmit and receive are the same.
  const std::complex<double>* lateral(int end, int node, int point) const {
    return lateral_.data() + at(end, node, point) * ApertureCone::kLateral;
  }
  const std::complex<double>* elevation(int node, int point) const {
    return elevation_.data() + at(0, node, point) * ApertureCone::kElevation;
  }
  /// Two-way power without losses, summed over the points. In the image plane it is given for each
  /// line, because parts of the aperture may lie beyond the array.
  const double* lateral_power(int node) const { return lateral_power_.data() + row(node); }
  double elevation_power(int node) const {
    return elevation_power_[static_cast<std::size_t>(node)];
  }

 private:
  std::size_t at(int end, int node, int point) const {
    return static_cast<std::size_t>((end * grid_.nodes + node) * kPoints + point);
  }
  std::size_t row(int node) const {
    return static_cast<std::size_t>(node) * static_cast<std::size_t>(grid_.lines);
  }
  void locate(const ProbeOptics& optics);
  void sum_waves(const ProbeOptics& optics);
  void sum_powers(const ApertureCone& cone);
  void bound();

  LossGrid grid_;
  int most_lines_ = 0;
  int most_frames_ = 0;
  std::vector<double> beside_m_;    ///< points in the image plane
  std::vector<float> lines_aside_;  ///< the same, in lines
  std::vector<float> across_m_;
  std::vector<float> frames_per_m_;              ///< [node][line]
  std::vector<std::complex<double>> lateral_;    ///< [end][node][point][part]
  std::vector<std::complex<double>> elevation_;  ///< [node][point][part]
  std::vector<double> lateral_power_;            ///< [node][line]
  std::vector<double> elevation_power_;          ///< [node]
};

}  // namespace wobblebench::sim
