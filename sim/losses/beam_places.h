// Places across the beam, and the waves that reach them from each part of the aperture.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/losses/cone.h"

namespace wobblebench::sim {

/// For each node of a LossGrid places in the image plane and across it, about the axis of a stick,
/// and the wave of the centre frequency at each of them from each part of an ApertureCone. Waves
/// are paraxial, of phase pi h^2 (1 / r - 1 / focus) / wavelength - 2 pi h y / (wavelength r) from
/// height h to place y (Goodman, Introduction to Fourier Optics, 4.2). What covers the aperture is
/// interpolated between the middles of its parts.
class BeamPlaces {
 public:
  /// Equidistant, over twice the beam's width to either side.
  static constexpr int kPlaces = 13;

  /// `cone` must be of the same plan and grid.
  BeamPlaces(const hw::AcquisitionPlan& plan, const LossGrid& grid, const ApertureCone& cone);

  /// A place in the image plane, in lines from the axis.
  float lines_aside(int node, int place) const { return lines_aside_[at(0, node, place)]; }
  /// A place across the image plane, in metres from the axis.
  float across_m(int node, int place) const { return across_m_[at(0, node, place)]; }
  /// Frames for each metre across the image plane at a node, on each line.
  const float* frames_per_m(int node) const { return frames_per_m_.data() + row(node); }
  /// Most lines, and frames, that a place lies aside.
  int most_lines() const { return most_lines_; }
  int most_frames() const { return most_frames_; }

  /// Waves of the ApertureCone::kLateral parts at a place in the image plane, and of its kElevation
  /// parts at one across it, where transmit and receive are the same.
  const std::complex<double>* lateral(int end, int node, int place) const {
    return lateral_.data() + at(end, node, place) * ApertureCone::kLateral;
  }
  const std::complex<double>* elevation(int node, int place) const {
    return elevation_.data() + at(0, node, place) * ApertureCone::kElevation;
  }
  /// Sum over the places of the two-way power where nothing is lost; in the image plane of each
  /// line, by the parts that lie on the array.
  const double* lateral_power(int node) const { return lateral_power_.data() + row(node); }
  double elevation_power(int node) const {
    return elevation_power_[static_cast<std::size_t>(node)];
  }

 private:
  std::size_t at(int end, int node, int place) const {
    return static_cast<std::size_t>((end * grid_.nodes + node) * kPlaces + place);
  }
  std::size_t row(int node) const {
    return static_cast<std::size_t>(node) * static_cast<std::size_t>(grid_.lines);
  }
  void place(const hw::AcquisitionPlan& plan);
  void sum_waves(const hw::AcquisitionPlan& plan);
  void sum_powers(const ApertureCone& cone);
  void bound();

  LossGrid grid_;
  int most_lines_ = 0;
  int most_frames_ = 0;
  std::vector<double> beside_m_;    ///< places in the image plane
  std::vector<float> lines_aside_;  ///< the same
  std::vector<float> across_m_;
  std::vector<float> frames_per_m_;              ///< [node][line]
  std::vector<std::complex<double>> lateral_;    ///< [end][node][place][part]
  std::vector<std::complex<double>> elevation_;  ///< [node][place][part]
  std::vector<double> lateral_power_;            ///< [node][line]
  std::vector<double> elevation_power_;          ///< [node]
};

}  // namespace wobblebench::sim
