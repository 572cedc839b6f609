// Scatterers fixed in the tissue, and their echoes on a stick. Each scatterer is a hash of its cell
// of tissue at rest: the same for every stick, moving with the tissue, never stored.
//
// For a stick, the hash cells that the beam touches are found, without those in anechoic tissue,
// beyond the beam's reach or beyond the range at which all sound is lost. Their scatterers echo
// with the beam's response (sim/optics/beam_table.h), the phase of the path, and an amplitude
// for which homogeneous tissue has the mean echo power of its material at every range:
//   amplitude^2 = power / (density * integral of |point spread|^2).
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"
#include "sim/speckle/scatterers/scatterer_settings.h"
#include "sim/speckle/scatterers/stick_path.h"

namespace wobblebench::sim {

class ScanBufferPool;
struct ScannedTissue;
struct ScattererScene;

/// Const functions may be called from several threads.
class ScattererField {
 public:
  ScattererField(const ScannedTissue& tissue,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options)
      : ScattererField(tissue, plan, options, ScattererSettings::of(options)) {}
  ScattererField(const ScannedTissue& tissue,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 const ScattererSettings& settings);

  /// Adds the echoes of all scatterers within the stick's beam. `iq` is one stick at the IQ rate.
  /// `contributed`, if given, is increased by the number of scatterers.
  void add_echoes(const StickPath& path,
                  std::span<std::complex<float>> iq,
                  std::uint64_t* contributed = nullptr) const;

  /// Adds the echoes of the given scatterers instead of the tissue's.
  void add_points(const StickPath& path,
                  std::span<const PointEcho> points,
                  std::span<std::complex<float>> iq) const;

  /// The scatterers that add_echoes() uses for a stick without losses, up to a true range.
  std::vector<PointEcho> near(const TimedRay& line, double to_m) const;

  double per_cubic_mm() const;
  /// Integral of |point spread|^2 at a range, for a response of 1 on the axis.
  double point_spread_m3(double range_m) const;
  const BeamTable& beam() const;

 private:
  std::shared_ptr<const ScattererScene> scene_;
  std::shared_ptr<ScanBufferPool> buffers_;
};

}  // namespace wobblebench::sim
