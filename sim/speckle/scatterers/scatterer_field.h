// Scatterers fixed in the tissue, and their echoes on a stick. The position of each scatterer is a
// hash of its cell of tissue at rest: it is the same for every stick, moves with the tissue, and is
// never stored.
//
// For each stick the hash cells that the beam touches are found; cells in anechoic tissue, beyond
// the beam's reach or beyond the range at which all sound is lost are left out. The echo of a
// scatterer has the beam's response (sim/optics/beam_table.h), the phase of the path, and an
// amplitude for which homogeneous tissue has the mean echo power of its material at every range:
//   amplitude^2 = power / (density * integral of |point spread|^2).
#pragma once

#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/losses/stick_losses.h"
#include "sim/optics/beam_table.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/tissue_blocks.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// Propagation along a stick's axis, one value per IQ sample; sample i lies at apparent range
/// (i + 1/2) * spacing_m.
struct StickPath {
  TimedRay line;
  double spacing_m = 0;  ///< ProbeOptics::iq_spacing_m()
  /// Two-way amplitude that remains after losses; samples from remaining.size() on are lost.
  std::span<const float> remaining;
  /// Apparent minus true range; empty: 0 everywhere (one sound speed).
  std::span<const float> delay_m;
  /// BandLoss::frequency_ratio(); empty: 1 everywhere (no absorption).
  std::span<const float> frequency_ratio = {};
  std::span<const InterfaceFront> fronts = {};
};

/// A point scatterer at one moment.
struct PointEcho {
  glm::dvec3 position_m{0};  ///< probe frame
  float amplitude = 0;       ///< of the echo that it would have on the axis at its range
  CrossedInterface interface = {};
};

/// Choices within the scatterer rungs. The defaults are those of the rung `scatterers` without
/// absorption.
struct ScattererSettings {
  BeamShape beam = BeamShape::main_lobe;
  /// Full density at every range (sim/speckle/scatterers/scatterer_cells.h).
  bool all_octaves = false;
  /// Highest centre frequency of the pulses at each range. Where it is lower the beam is wider and
  /// needs fewer scatterers per volume.
  FrequencyCourse course = {};

  static ScattererSettings of(const SimulationOptions& options, FrequencyCourse course = {}) {
    return {options.side_lobes ? BeamShape::side_lobes : BeamShape::main_lobe,
            false,
            std::move(course)};
  }
};

class ScanBufferPool;
struct ScattererScene;

/// Const functions may be called from several threads.
class ScattererField {
 public:
  ScattererField(const ScannedTissue& tissue,
                 const ProbeOptics& optics,
                 const SimulationOptions& options)
      : ScattererField(tissue, optics, options, ScattererSettings::of(options)) {}
  ScattererField(const ScannedTissue& tissue,
                 const ProbeOptics& optics,
                 const SimulationOptions& options,
                 const ScattererSettings& settings);

  /// Adds the echoes of all scatterers within the stick's beam. `iq` is one stick at the IQ rate.
  /// `contributed`, if given, is increased by the number of scatterers.
  void add_echoes(const StickPath& path,
                  std::span<std::complex<float>> iq,
                  std::uint64_t* contributed = nullptr) const;

  /// Adds the echoes of the given scatterers instead of those of the tissue.
  void add_points(const StickPath& path,
                  std::span<const PointEcho> points,
                  std::span<std::complex<float>> iq) const;

  /// The scatterers that add_echoes() uses for a stick without losses, up to a true range.
  std::vector<PointEcho> near(const TimedRay& line, double to_m) const;

  const BeamTable& beam() const;

 private:
  std::shared_ptr<const ScattererScene> scene_;
  std::shared_ptr<ScanBufferPool> buffers_;
};

/// True range up to which echoes of scatterers reach the remaining samples of a stick: a pulse
/// length beyond the last one.
double echo_range_m(const StickPath& path);

/// Holds the working memory of one thread. Results are valid until the next call.
class PointsInBeam {
 public:
  PointsInBeam(const ScannedTissue& tissue, const BeamTable& beam);

  /// Finds the point scatterers that lie, at the stick's time, within the beam's reach of the axis
  /// (an ellipse at each range), up to a true range.
  std::span<const PointEcho> find(const TimedRay& line, double to_m);
  /// The same up to echo_range_m().
  std::span<const PointEcho> find(const StickPath& path);

 private:
  /// Reach of the beam at the ranges of a row of its table.
  struct Reach {
    double lateral_m;
    double elevation_m;
  };
  struct Stick {
    hw::Ray ray;
    AcrossStick across;
    double to_m;
    phantoms::Deformation now;
  };

  void find_fixed(const Stick& stick);
  void add_if_near(const phantoms::PointScatterer& point, const Stick& stick);

  ScannedTissue tissue_;
  double rows_per_m_;
  std::vector<Reach> reaches_;
  double widest_m_ = 0;
  /// Coordinates of the fixed points, for vectorised loops.
  std::vector<float> x_m_, y_m_, z_m_;
  std::vector<std::uint32_t> fixed_, moving_;  ///< indices of points
  std::vector<std::uint8_t> near_;             ///< flag of each fixed point
  std::vector<PointEcho> found_;
};

}  // namespace wobblebench::sim
