#include "sim/fidelity.h"

#include <utility>

#include "base/number_text.h"
#include "base/units.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"
#include "sim/receive/receiver.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::sim {

namespace {

std::pair<Rung, std::string> lowest_rung(const SimulationOptions& options,
                                         bool moving,
                                         bool points) {
  if (options.side_lobes) return {Rung::scatterers, "side lobes are asked for"};
  if (moving && options.speckle) {
    return {Rung::scatterers, "the phantom moves, and its speckle must move with it"};
  }
  const bool echoes_only = !options.speckle && !options.attenuation && !options.transmission_loss &&
                           !options.interface_echo && !options.tissue_sound_speed &&
                           !options.clutter.any() && options.noise_db <= kZeroAmplitude_db;
  if (echoes_only && points) return {Rung::field, "the phantom has point scatterers"};
  if (echoes_only) return {Rung::geometry, "every effect of the higher rungs is switched off"};
  if (moving) return {Rung::field, "the phantom moves, but speckle is switched off"};
  return {Rung::field, "speckle and losses of a phantom at rest"};
}

/// True if the largest noise sample, after time gain, lies below the dynamic range.
bool noise_is_invisible(const SimulationOptions& options, const hw::AcquisitionPlan& plan) {
  if (options.output == hw::SampleScale::linear_envelope) return false;
  const double largest = largest_noise(plan, options, iq_oversampling(plan)) *
                         time_gain(plan, options, plan.acquisition().depth_m);
  return largest < amplitude_of_db(options.full_scale_db - options.dynamic_range_db);
}

constexpr char kSwitchedOff[] = "switched off";

/// Wavelengths of the lowest element of which a BeamTable is made. Across the image plane it takes
/// a delay for a parabola, which holds in the beam's far zone up to about a quarter of its range.
constexpr double kLeastHeight = 4;

class EffectList {
 public:
  explicit EffectList(const EchoModelType& model) : model_(model) {}

  /// `left_out`: the reason why it does not run although it is switched on.
  void add(const std::string& name, bool switched_on, const std::string& left_out = "") {
    if (!model_.models(name)) {
      effects_.push_back({name, "the rung " + std::string(model_.name) + " leaves it out"});
    } else {
      effects_.push_back({name, switched_on ? left_out : kSwitchedOff});
    }
  }
  std::vector<Effect> take() { return std::move(effects_); }

 private:
  const EchoModelType& model_;
  std::vector<Effect> effects_;
};

std::vector<Effect> effects_of(const EchoModelType& model,
                               const SimulationOptions& o,
                               const hw::AcquisitionPlan& plan,
                               bool moving,
                               bool points) {
  EffectList list(model);
  list.add("tissue_echo", true);
  list.add("tissue_motion", moving);
  list.add("attenuation", o.attenuation);
  list.add("transmission_loss", o.transmission_loss);
  list.add("aperture_losses", o.aperture_losses && (o.attenuation || o.transmission_loss));
  list.add("tissue_sound_speed", o.tissue_sound_speed);
  list.add("beam_width", true);
  list.add("speckle", o.speckle);
  list.add("tissue_unevenness", o.clutter.tissue_unevenness_db > 0);
  list.add("interface_echo", o.interface_echo);
  list.add("scatterers_in_tissue", true);
  list.add("point_scatterers", points);
  list.add("particles", o.clutter.particles_per_cm3 > 0);
  list.add("side_lobes", o.side_lobes);
  list.add("element_sum", true);
  list.add("reverberation", o.clutter.probe_reflection > 0);
  list.add("haze", o.clutter.has_haze());
  list.add("noise",
           o.noise_db > kZeroAmplitude_db,
           noise_is_invisible(o, plan) ? "below the display at every depth" : "");
  list.add("envelope", true);
  list.add("low_pass", o.low_pass);
  list.add("time_gain", o.tgc_db_per_cm_mhz > 0);
  const bool log = o.output == hw::SampleScale::log_compressed;
  list.add("log_compression", log);
  list.add("line_filter", o.display.line_filter > 0);
  list.add("persistence", o.display.persistence > 0);
  list.add("grey_levels", o.display.grey_bits > 0, log ? "" : "linear envelopes are not quantised");
  return list.take();
}

}  // namespace

std::string to_string(Rung rung) {
  return rung == Rung::automatic ? "auto" : std::string(echo_model_type(rung).name);
}

Fidelity choose_fidelity(const SimulationOptions& options,
                         const hw::AcquisitionPlan& plan,
                         bool moving,
                         bool points) {
  Fidelity choice;
  if (options.fidelity == Rung::automatic) {
    std::tie(choice.rung, choice.reason) = lowest_rung(options, moving, points);
  } else {
    choice.rung = options.fidelity;
    choice.reason = "asked for";
  }
  const EchoModelType& model = echo_model_type(choice.rung);
  const auto refuse = [&](const char* key, const char* value, const std::string& needs) {
    throw InvalidOption(
        key, value, needs + "; the rung is " + to_string(choice.rung) + " (" + choice.reason + ")");
  };
  if (options.side_lobes && !model.models("side_lobes")) {
    refuse("side_lobes", "true", "needs the rung scatterers or reference");
  }
  if (options.tissue_sound_speed && !model.models("tissue_sound_speed")) {
    refuse("tissue_sound_speed", "true", "needs the rung field or higher");
  }
  // The echoes of scatterers are speckle; without speckle there would be none.
  if (!options.speckle && model.models("scatterers_in_tissue")) {
    refuse("speckle", "false", "needs the rung geometry or field");
  }
  const bool takes_beam_table = model.models("scatterers_in_tissue")
                                    ? choice.rung != Rung::reference
                                    : points && model.models("point_scatterers");
  if (const double least_m = kLeastHeight * ProbeOptics(plan).wavelength_m();
      takes_beam_table && plan.probe().element_height_m < least_m) {
    throw InvalidOption("fidelity",
                        to_string(options.fidelity),
                        "the rung " + to_string(choice.rung) +
                            " needs probe.element_height_mm of at least 4 "
                            "wavelengths, " +
                            significant(least_m * 1e3, 3) + " (now " +
                            significant(plan.probe().element_height_m * 1e3, 3) +
                            "): the beam of a lower element is too wide for its table; reference "
                            "has no such bound");
  }
  choice.effects = effects_of(model, options, plan, moving, points);
  return choice;
}

}  // namespace wobblebench::sim
