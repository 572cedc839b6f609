#include "sim/fidelity.h"

#include <stdexcept>
#include <tuple>
#include <utility>

#include "sim/math/random.h"
#include "sim/receive/losses.h"

namespace wobblebench::sim {

namespace {

std::pair<Rung, std::string> lowest_rung(const SimulationOptions& options, bool moving) {
  if (options.side_lobes) return {Rung::scatterers, "side lobes are asked for"};
  if (moving && options.speckle) {
    return {Rung::scatterers, "the phantom moves, and its speckle must move with it"};
  }
  const bool echoes_only = !options.speckle && !options.attenuation && !options.transmission_loss &&
                           !options.interface_echo && !options.tissue_sound_speed &&
                           options.noise_db <= kSilent_db;
  if (echoes_only) return {Rung::geometry, "every effect of the higher rungs is switched off"};
  if (moving) return {Rung::field, "the phantom moves, but speckle is switched off"};
  return {Rung::field, "speckle and losses of a phantom at rest"};
}

/// The loudest noise, after time gain, stays below the display.
bool noise_never_shows(const SimulationOptions& options, const hw::AcquisitionPlan& plan) {
  if (options.output == hw::SampleScale::linear_envelope) return false;
  const double loudest = amplitude_of_db(options.noise_db) *
                         static_cast<double>(kMaxComplexNormal) *
                         time_gain(plan, options, plan.acquisition().depth_m);
  return loudest < amplitude_of_db(options.full_scale_db - options.dynamic_range_db);
}

constexpr char kSwitchedOff[] = "switched off";

class EffectList {
 public:
  explicit EffectList(Rung rung) : rung_(rung) {}

  void add(const std::string& name, Rung from, bool asked, const std::string& no_show = "") {
    if (rung_ < from) {
      effects_.push_back({name, "the rung " + to_string(rung_) + " leaves it out"});
    } else {
      effects_.push_back({name, asked ? no_show : kSwitchedOff});
    }
  }
  std::vector<Effect> take() { return std::move(effects_); }

 private:
  Rung rung_;
  std::vector<Effect> effects_;
};

std::vector<Effect> effects_of(Rung rung,
                               const SimulationOptions& o,
                               const hw::AcquisitionPlan& plan,
                               bool moving) {
  EffectList list(rung);
  list.add("tissue_echo", Rung::geometry, true);
  list.add("tissue_motion", Rung::geometry, moving);
  list.add("attenuation", Rung::field, o.attenuation);
  list.add("transmission_loss", Rung::field, o.transmission_loss);
  list.add("tissue_sound_speed", Rung::field, o.tissue_sound_speed);
  list.add("beam_width", Rung::field, true);
  list.add("speckle", Rung::field, o.speckle);
  list.add("interface_echo", Rung::field, o.interface_echo);
  list.add("scatterers_in_tissue", Rung::scatterers, o.speckle);
  list.add("side_lobes", Rung::scatterers, o.side_lobes);
  list.add("element_sum", Rung::reference, true);
  list.add("noise",
           Rung::field,
           o.noise_db > kSilent_db,
           noise_never_shows(o, plan) ? "below the display at every depth" : "");
  list.add("envelope", Rung::field, true);
  list.add("low_pass", Rung::field, o.low_pass);
  list.add("time_gain", Rung::field, o.tgc_db_per_cm_mhz > 0);
  list.add("log_compression", Rung::geometry, o.output == hw::SampleScale::log_compressed);
  return list.take();
}

}  // namespace

std::string to_string(Rung rung) {
  switch (rung) {
    case Rung::automatic:
      return "auto";
    case Rung::geometry:
      return "geometry";
    case Rung::field:
      return "field";
    case Rung::scatterers:
      return "scatterers";
    case Rung::reference:
      return "reference";
  }
  throw std::logic_error("Rung: no such rung");
}

Fidelity choose_fidelity(const SimulationOptions& options,
                         const hw::AcquisitionPlan& plan,
                         bool moving) {
  Fidelity choice;
  if (options.fidelity == Rung::automatic) {
    std::tie(choice.rung, choice.reason) = lowest_rung(options, moving);
  } else {
    choice.rung = options.fidelity;
    choice.reason = "asked for";
  }
  const auto refuse = [&](const char* key, const std::string& needs) {
    throw InvalidOption(
        key, "true", needs + "; simulation.fidelity is \"" + to_string(choice.rung) + '"');
  };
  if (options.side_lobes && choice.rung < Rung::scatterers) {
    refuse("side_lobes", "needs the rung scatterers or reference");
  }
  if (options.tissue_sound_speed && choice.rung < Rung::field) {
    refuse("tissue_sound_speed", "needs the rung field or higher");
  }
  choice.effects = effects_of(choice.rung, options, plan, moving);
  return choice;
}

}  // namespace wobblebench::sim
