// Particles in fluid: point scatterers at random places.
#pragma once

#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "phantoms/point_scatterers.h"
#include "sim/options.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

/// Particles in the fluid within the probe's field at time 0 and somewhat around it: at most
/// ClutterOptions::particles_per_cm3 where nothing echoes, none elsewhere. They are fixed in the
/// subject and move with it. Amplitudes are normal.
phantoms::PointScatterers fluid_particles(const phantoms::PlacedPhantom& subject,
                                          const TissueMap& map,
                                          const hw::AcquisitionPlan& plan,
                                          const SimulationOptions& options);

}  // namespace wobblebench::sim
