// Settings of the synthetic probe and of the capture card behind it.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

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

/// What the options of the simulation start from.
enum class ScanPreset {
  clean,     ///< echoes of the tissue alone, on a wide display range: the defaults
  clinical,  ///< with clutter, uneven tissue and the display of a fetal 4D scan
};

/// Echoes that show tissue where there is none, and the slow variation of tissue itself. Off by
/// default (docs/decisions/0048-clutter.md has the sources).
struct ClutterOptions {
  /// Reflection of the probe's face for sound that comes back, as an amplitude; 0: no
  /// reverberation.
  double probe_reflection = 0;
  /// Power of the haze within and behind uniform tissue, relative to its echo; -200: none.
  double haze_db = kZeroAmplitude_db;
  double haze_reach_rad = 12 * kDegree;  ///< to either side, in which it falls to 1/e of its power
  double haze_trail_m = 15e-3;           ///< behind what echoes, in which it falls likewise
  double haze_fall_db_per_cm = 0;        ///< with range, besides the losses on the way
  double haze_unevenness_db = 0;         ///< standard deviation of its level over centimetres
  /// Point scatterers in fluid that echoes nothing; 0: none.
  double particles_per_cm3 = 0;
  double particle_echo_db = -60;  ///< RMS amplitude on the beam's axis, against a perfect mirror
  /// Standard deviation of tissue's backscatter over some millimetres; 0: uniform.
  double tissue_unevenness_db = 0;
  double tissue_grain_m = 6e-3;  ///< distance over which it varies
  /// Depth behind fluid over which the variation in dB grows from none: skin is more even than
  /// what lies below it.
  double even_skin_m = 0;

  bool has_haze() const { return haze_db > kZeroAmplitude_db; }
  /// Whether anything of it depends on the seed.
  bool random() const { return has_haze() || particles_per_cm3 > 0 || tissue_unevenness_db > 0; }
  bool any() const { return random() || probe_reflection > 0; }
};

/// How a scanner treats detected samples before it shows them. Off by default. Gain and dynamic
/// range are SimulationOptions::full_scale_db and dynamic_range_db.
struct DisplayOptions {
  double line_filter = 0;  ///< lateral smoothing: weight of the two neighbouring lines together
  double persistence = 0;  ///< frame averaging: weight of the frame before in the same volume
  int grey_bits = 0;       ///< of a log-compressed sample; 0: not quantised
};

/// Echo amplitudes are in dB relative to a perfect mirror perpendicular to the beam.
struct SimulationOptions {
  /// The options above start from it; it has no effect by itself.
  ScanPreset preset = ScanPreset::clean;
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

  ClutterOptions clutter = {};
  DisplayOptions display = {};
};

/// The options of a preset.
SimulationOptions simulation_preset(ScanPreset preset);

/// Without the sections `clutter` and `display`, which have descriptions of their own.
template <OptionsOf<SimulationOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  [[maybe_unused]] const ScanPreset before = o.preset;
  v.choice("preset", o.preset, {{"clean", ScanPreset::clean}, {"clinical", ScanPreset::clinical}});
  if constexpr (!std::is_const_v<O>) {
    if (o.preset != before) o = simulation_preset(o.preset);
  }
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

template <OptionsOf<ClutterOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.real("probe_reflection", o.probe_reflection, 1, 0, 0.9);
  v.real("haze_db", o.haze_db, 1, kZeroAmplitude_db, 20);
  v.real("haze_reach_deg", o.haze_reach_rad, kDegree, 0.5, 90);
  v.real("haze_trail_mm", o.haze_trail_m, kMillimetre, 0.1, 100);
  v.real("haze_fall_db_per_cm", o.haze_fall_db_per_cm, 1, 0, 10);
  v.real("haze_unevenness_db", o.haze_unevenness_db, 1, 0, 20);
  v.real("particles_per_cm3", o.particles_per_cm3, 1, 0, 20);
  v.real("particle_echo_db", o.particle_echo_db, 1, -120, 0);
  v.real("tissue_unevenness_db", o.tissue_unevenness_db, 1, 0, 20);
  v.real("tissue_grain_mm", o.tissue_grain_m, kMillimetre, 1, 50);
  v.real("even_skin_mm", o.even_skin_m, kMillimetre, 0, 20);
}

template <OptionsOf<DisplayOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.real("line_filter", o.line_filter, 1, 0, 0.9);
  v.real("persistence", o.persistence, 1, 0, 0.9);
  v.integer("grey_bits", o.grey_bits, 0, 16);
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
