// Settings of the synthetic probe.
#pragma once

#include <cstdint>

#include "base/options.h"
#include "base/units.h"
#include "hw/probe/stick.h"

namespace wobblebench::sim {

/// The ladder of fidelity (docs/architecture.md): each rung models what the one below leaves out.
enum class Rung {
  automatic,   ///< the lowest of these that the scene asks for (sim/fidelity.h)
  geometry,    ///< mean echo of the tissue at each sample; no speckle, no beam, no losses
  field,       ///< + speckle filtered by the point spread, losses, interface echoes, receive chain
  scatterers,  ///< + scatterers fixed in the tissue: speckle that moves with it
  reference,   ///< the same scatterers summed over the elements of the probe: small scenes only
};

/// The dB value that stands for silence: no noise is made at this level.
inline constexpr double kSilent_db = -200;

/// Echo amplitudes are in dB against the echo of a perfect mirror across the beam.
struct SimulationOptions {
  Rung fidelity = Rung::automatic;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all that the machine has. Results do not depend on it.

  // Effects of `field` that a scene may switch off; what is off is skipped, not multiplied by one.
  bool speckle = true;
  bool attenuation = true;        ///< two-way absorption and scattering loss
  bool transmission_loss = true;  ///< what an interface reflects is missing behind it
  bool interface_echo = true;
  /// The beam as a rectangular aperture makes it, side lobes included, instead of its main lobe
  /// alone. From `scatterers` on.
  bool side_lobes = false;
  /// Sound travels at each material's own speed; the scanner goes on assuming one.
  bool tissue_sound_speed = false;

  /// Scatterers that each resolution cell (product of the three -6 dB widths at its range) holds at
  /// least. With 10 the envelope's mean over sigma is 2 % short of Rayleigh's, with 30 less than
  /// 1 %.
  double scatterers_per_cell = 10;
  /// -3 dB full width of the specular lobe: about 3 deg for a focused beam (references.md [6]).
  double specular_width_rad = 3 * kDegree;

  // Receive chain.
  double tgc_db_per_cm_mhz = 0.3;  ///< nominal one-way loss that time gain undoes, both ways
  double noise_db = -95;           ///< RMS electronic noise ahead of time gain; -200: none
  double full_scale_db = -15;      ///< echo that becomes sample value 1
  double dynamic_range_db = 60;    ///< below full scale; log compression maps it to [0, 1]
  bool low_pass = true;  ///< average the envelope over each output sample before decimation
  hw::SampleScale output = hw::SampleScale::log_compressed;
};

template <OptionsOf<SimulationOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("fidelity",
           o.fidelity,
           {{"auto", Rung::automatic},
            {"geometry", Rung::geometry},
            {"field", Rung::field},
            {"scatterers", Rung::scatterers},
            {"reference", Rung::reference}});
  v.seed("seed", o.seed);
  v.integer("threads", o.threads, 0, 1024);
  v.flag("speckle", o.speckle);
  v.flag("attenuation", o.attenuation);
  v.flag("transmission_loss", o.transmission_loss);
  v.flag("interface_echo", o.interface_echo);
  v.flag("side_lobes", o.side_lobes);
  v.flag("tissue_sound_speed", o.tissue_sound_speed);
  v.real("scatterers_per_cell", o.scatterers_per_cell, 1, 0.1, 100);
  v.real("specular_width_deg", o.specular_width_rad, kDegree, 0.1, 90);
  v.real("tgc_db_per_cm_mhz", o.tgc_db_per_cm_mhz, 1, 0, 3);
  v.real("noise_db", o.noise_db, 1, kSilent_db, 0);
  v.real("full_scale_db", o.full_scale_db, 1, -100, 20);
  v.real("dynamic_range_db", o.dynamic_range_db, 1, 10, 200);
  v.flag("low_pass", o.low_pass);
  v.choice(
      "output",
      o.output,
      {{"log", hw::SampleScale::log_compressed}, {"linear", hw::SampleScale::linear_envelope}});
}

}  // namespace wobblebench::sim
