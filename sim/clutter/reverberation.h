// Reverberation between the probe's face and the layers before it.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/losses/stick_losses.h"
#include "sim/options.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// Sound that an interface returns is reflected by the probe's face and goes out again. By the
/// method of images each interface that a stick crosses is a second probe behind the first: all
/// echoes of the stick come again, later by the interface's range and weaker by its echo times the
/// reflection of the face, and again from each of these. What comes again has the speckle of the
/// tissue and moves with it. Holds the working memory of one thread.
class Reverberation {
 public:
  /// `materials` must outlive it.
  Reverberation(const hw::AcquisitionPlan& plan,
                const SimulationOptions& options,
                const std::vector<phantoms::Material>& materials,
                double spacing_m);

  /// Adds the repeated echoes of all orders to the echoes of one stick.
  void add(const StickTrack& track, const StickLosses& losses, std::span<std::complex<float>> iq);

 private:
  /// y[i] += sum over k of weights[k] y[i - delay - k].
  struct Image {
    int delay;  ///< samples, at least 1
    std::array<std::complex<float>, 4> weights;
  };

  void find_images(const StickTrack& track, const StickLosses& losses);

  double face_;  ///< reflection
  double cycles_per_m_;
  double spacing_m_;
  const std::vector<phantoms::Material>* materials_;
  std::vector<Image> images_;
};

}  // namespace wobblebench::sim
