// Settings of the synthetic probe and of the capture card behind it.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/options.h"
#include "base/units.h"
#include "hw/probe/polar_volume.h"
#include "hw/wire/configuration.h"

namespace wobblebench::sim {

/// The ladder of fidelity (docs/architecture.md): each rung adds effects to the one below. Each is
/// a class in sim/rungs.
enum class Rung {
  automatic,   ///< the lowest that models what the options switch on (sim/fidelity.h)
  geometry,    ///< mean echo of the tissue at each sample; no speckle, no beam, no losses
  field,       ///< + speckle filtered by the point spread, losses, interface echoes, receive chain
  scatterers,  ///< + scatterers fixed in the tissue: speckle that moves with it
  reference,   ///< the same scatterers summed over the elements of the probe: small scenes only
};

/// Window over the elements of an aperture in the image plane, on transmit and on receive.
enum class Apodisation {
  rectangular,  ///< all equal
  hann,         ///< raised cosine, 0 at the aperture's ends
  tukey,        ///< flat over the inner half, raised cosine beyond
};

/// The dB value that stands for an amplitude of 0.
inline constexpr double kZeroAmplitude_db = -200;
inline double amplitude_of_db(double db) {
  return std::pow(10.0, db / 20);
}

/// Echo amplitudes are in dB relative to a perfect mirror perpendicular to the beam.
struct SimulationOptions {
  Rung fidelity = Rung::automatic;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one for each core. Results do not depend on it.

  // Effects from `field` on that a scene may switch off; they are then skipped.
  bool speckle = true;
  bool attenuation = true;        ///< two-way absorption and scattering loss
  bool transmission_loss = true;  ///< energy that an interface reflects is lost behind it
  /// Losses on all ray paths between the aperture and an echo, instead of those on the stick's
  /// axis.
  bool aperture_losses = true;
  bool interface_echo = true;
  /// The beam with its side lobes, instead of the main lobe alone; needs the rung `scatterers` or
  /// higher. Without side lobes speckle at the foci is up to 14 % finer, and bright tissue beside a
  /// stick adds no clutter.
  bool side_lobes = false;
  /// Sound travels at each material's own speed, while the scanner assumes one speed.
  bool tissue_sound_speed = false;

  Apodisation apodisation = Apodisation::rectangular;

  /// Minimum number of scatterers in a resolution cell (product of the three -6 dB widths at its
  /// range). With 10 the envelope's mean over sigma is 2 % below Rayleigh's, with 30 less than 1 %.
  double scatterers_per_cell = 12;
  /// -3 dB full width of the specular lobe: about 3 deg for a focused beam (references.md [6]).
  double specular_width_rad = 3 * kDegree;

  // Receive chain.
  double tgc_db_per_cm_mhz = 0.22;  ///< nominal one-way loss that TGC compensates, both ways
  double noise_db = -95;            ///< RMS electronic noise before TGC; -200: none
  double full_scale_db = -15;       ///< echo amplitude after TGC that becomes sample value 1
  double dynamic_range_db = 60;     ///< below full scale; log compression maps it to [0, 1]
  bool low_pass = true;             ///< average the envelope over each output sample, then decimate
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
  v.flag("aperture_losses", o.aperture_losses);
  v.flag("interface_echo", o.interface_echo);
  v.flag("side_lobes", o.side_lobes);
  v.flag("tissue_sound_speed", o.tissue_sound_speed);
  v.choice("apodisation",
           o.apodisation,
           {{"rectangular", Apodisation::rectangular},
            {"hann", Apodisation::hann},
            {"tukey", Apodisation::tukey}});
  v.real("scatterers_per_cell", o.scatterers_per_cell, 1, 0.1, 100);
  v.real("specular_width_deg", o.specular_width_rad, kDegree, 0.1, 90);
  v.real("noise_db", o.noise_db, 1, kZeroAmplitude_db, 0);
  hw::describe_display_scale(o, v);
  v.flag("low_pass", o.low_pass);
  v.choice(
      "output",
      o.output,
      {{"log", hw::SampleScale::log_compressed}, {"linear", hw::SampleScale::linear_envelope}});
}

/// The capture card between the probe and the host. Defaults: a small ring of LitePCIe's 8 KiB
/// buffers with an interrupt each, behind one lane of PCIe 3.0 with payloads of 256 bytes
/// (references 17, 18).
struct CardOptions {
  int buffer_bytes = 8192;  ///< of each DMA buffer
  int buffers = 256;        ///< in the ring
  /// Interrupt coalescing: full buffers per interrupt; there is one at the end of a volume, too.
  int buffers_per_interrupt = 1;
  double payload_rate_mb_s = 900;  ///< 1e6 bytes a second over the PCIe link
  double interrupt_latency_s = 0;  ///< from the end of the DMA transfer to the host's wake-up
};

template <OptionsOf<CardOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("buffer_bytes", o.buffer_bytes, 64, 1 << 24);
  v.integer("buffers", o.buffers, 2, 1 << 16);
  v.integer("buffers_per_interrupt", o.buffers_per_interrupt, 1, 1 << 16);
  v.real("payload_rate_mb_s", o.payload_rate_mb_s, 1, 0.1, 100000);
  v.real("interrupt_latency_us", o.interrupt_latency_s, kMicrosecond, 0, 1e6);
}

}  // namespace wobblebench::sim
