#include "sim/probe_simulator.h"

#include <algorithm>
#include <cmath>

#include "sim/losses.h"
#include "sim/parallel.h"
#include "sim/point_spread.h"
#include "sim/random.h"
#include "sim/receive.h"

namespace wobblebench::sim {

namespace {

/// A Rayleigh envelope's mean is sqrt(pi)/2 of its RMS; the material table gives means.
const double kRmsOfRayleighMean = 2 / std::sqrt(kPi);

/// Profiles along the lines of sight of a grid, each thread with its own sampler.
template <class Body>
void for_each_profile(const hw::AcquisitionPlan& plan,
                      const BeamGrid& grid,
                      const phantoms::Phantom& phantom,
                      const phantoms::Placement& placement,
                      double spacing_m,
                      int samples,
                      int threads,
                      const Body& body) {
  const int lines = grid.lines(plan);
  parallel_ranges(grid.frames(plan) * lines, threads, [&](int first, int last) {
    TissueSampler sampler(phantom, placement);
    for (int i = first; i < last; ++i) {
      const int frame = i / lines, line = i % lines;
      body(sampler.profile(grid.sightline(plan, frame, line), spacing_m, samples), frame, line);
    }
  });
}

}  // namespace

ProbeSimulator::ProbeSimulator(const phantoms::Phantom& phantom,
                               const phantoms::Placement& placement,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options)
    : plan_(plan), options_(options), materials_(phantom.materials()) {
  hw::check_options(options);
  if (options_.fidelity == Rung::geometry) {
    scan_geometry(phantom, placement);
  } else {
    scan_field(phantom, placement);
  }
}

void ProbeSimulator::scan_geometry(const phantoms::Phantom& phantom,
                                   const phantoms::Placement& placement) {
  const auto& acquisition = plan_.acquisition();
  const int samples = acquisition.samples_per_stick;
  mean_echoes_.resize(static_cast<std::size_t>(plan_.sticks_per_volume()) *
                      static_cast<std::size_t>(samples));
  const auto fill = [&](const TissueProfile& profile, int frame, int line) {
    float* stick =
        mean_echoes_.data() +
        (static_cast<std::size_t>(frame) * acquisition.sticks_per_frame + line) * samples;
    for (const Stretch& stretch : profile.stretches) {
      const double mean = amplitude_of_db(materials_.at(stretch.material).backscatter_db);
      const float value = options_.output == hw::SampleScale::linear_envelope
                              ? static_cast<float>(mean / amplitude_of_db(options_.full_scale_db))
                              : log_compressed(mean, options_);
      std::fill(stick + stretch.first, stick + stretch.last, value);
    }
  };
  // Without a beam there is nothing between the sticks to look at.
  for_each_profile(plan_,
                   BeamGrid(),
                   phantom,
                   placement,
                   plan_.sample_spacing_m(),
                   samples,
                   options_.threads,
                   fill);
}

void ProbeSimulator::scan_field(const phantoms::Phantom& phantom,
                                const phantoms::Placement& placement) {
  echoes_ = make_echo_field(plan_);
  const BeamGrid grid(plan_);
  PowerField power(grid.frames(plan_), grid.lines(plan_), echoes_.samples);
  std::vector<TissueProfile> on_axis(static_cast<std::size_t>(plan_.sticks_per_volume()));
  const auto sample = [&](TissueProfile profile, int frame, int line) {
    add_power(profile, power.stick(frame, line));
    if (frame % grid.per_frame != 0 || line % grid.per_line != 0) return;
    const int stick = frame / grid.per_frame * echoes_.lines + line / grid.per_line;
    on_axis[static_cast<std::size_t>(stick)] = std::move(profile);
  };
  for_each_profile(plan_,
                   grid,
                   phantom,
                   placement,
                   echoes_.spacing_m,
                   echoes_.samples,
                   options_.threads,
                   sample);
  power = averaged_under_beam(std::move(power), grid, plan_, echoes_.spacing_m, options_.threads);
  average_under_pulse(power, pulse_sigma_samples(), options_.threads);
  fill_echoes(power);
  if (!options_.interface_echo) return;
  parallel_ranges(plan_.sticks_per_volume(), options_.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      add_specular(on_axis[static_cast<std::size_t>(i)], i / echoes_.lines, i % echoes_.lines);
    }
  });
}

void ProbeSimulator::add_power(const TissueProfile& profile, float* power) const {
  const auto left =
      two_way_amplitude(profile, materials_, plan_, options_, echoes_.spacing_m, echoes_.samples);
  const auto rms = [&](double mean) { return options_.speckle ? mean * kRmsOfRayleighMean : mean; };
  for (const Stretch& stretch : profile.stretches) {
    const auto scale =
        static_cast<float>(rms(amplitude_of_db(materials_.at(stretch.material).backscatter_db)));
    for (int i = stretch.first; i < stretch.last; ++i) {
      const float amplitude = scale * left[static_cast<std::size_t>(i)];
      power[i] = amplitude * amplitude;
    }
  }
  if (!options_.interface_echo) return;
  // A rough interface is a thin sheet of scatterers: one sample's worth of power that the pulse
  // spreads to the amplitude asked for at its peak.
  const double peak = pulse_power_peak(pulse_sigma_samples());
  for (std::size_t i = 0; i < profile.interfaces.size(); ++i) {
    const int before = profile.stretches[i].last - 1;
    const double diffuse = interface_echo(profile.interfaces[i], materials_, options_).diffuse;
    const double amplitude =
        rms(diffuse) * static_cast<double>(left[static_cast<std::size_t>(before)]);
    const int at = std::clamp(static_cast<int>(profile.interfaces[i].range_m / echoes_.spacing_m),
                              0,
                              echoes_.samples - 1);
    power[at] += static_cast<float>(amplitude * amplitude / peak);
  }
}

void ProbeSimulator::fill_echoes(const PowerField& power) {
  // Even speckle first, then its local strength: filtered after, the strength would be blurred
  // twice.
  std::fill(echoes_.values.begin(), echoes_.values.end(), 1.0f);
  if (options_.speckle) fill_even_speckle();
  const std::size_t count = echoes_.values.size();
  for (std::size_t i = 0; i < count; ++i) echoes_.values[i] *= std::sqrt(power.values[i]);
}

void ProbeSimulator::fill_even_speckle() {
  parallel_ranges(plan_.sticks_per_volume(), options_.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const int frame = i / echoes_.lines, line = i % echoes_.lines;
      const auto key = random_key(options_.seed,
                                  RandomStream::speckle,
                                  static_cast<std::uint64_t>(frame),
                                  static_cast<std::uint64_t>(line));
      fill_speckle(echoes_.stick(frame, line), key, pulse_sigma_samples());
    }
  });
  filter_across_lines(echoes_, plan_, options_.threads);
  filter_across_frames(echoes_, plan_, options_.threads);
}

double ProbeSimulator::pulse_sigma_samples() const {
  return sigma_of_fwhm(axial_fwhm_m(plan_)) / echoes_.spacing_m;
}

void ProbeSimulator::add_specular(const TissueProfile& profile, int frame, int line) {
  if (profile.interfaces.empty()) return;
  const auto left =
      two_way_amplitude(profile, materials_, plan_, options_, echoes_.spacing_m, echoes_.samples);
  for (std::size_t i = 0; i < profile.interfaces.size(); ++i) {
    const Interface& interface = profile.interfaces[i];
    // What arrives at an interface is what is left at the last sample before it.
    const int before = profile.stretches[i].last - 1;
    add_reflector(echoes_.stick(frame, line),
                  echoes_.spacing_m,
                  interface.range_m,
                  interface_echo(interface, materials_, options_).specular *
                      static_cast<double>(left[static_cast<std::size_t>(before)]),
                  plan_);
  }
}

VolumeSamples ProbeSimulator::volume(std::uint32_t index) const {
  if (options_.fidelity == Rung::geometry) return mean_echoes_;
  const int samples = plan_.acquisition().samples_per_stick;
  VolumeSamples result(static_cast<std::size_t>(plan_.sticks_per_volume()) *
                       static_cast<std::size_t>(samples));
  parallel_ranges(plan_.sticks_per_volume(), options_.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const std::size_t stick = static_cast<std::size_t>(i);
      const std::size_t length = static_cast<std::size_t>(echoes_.samples);
      receive({echoes_.values.data() + stick * length, length},
              random_key(options_.seed, RandomStream::noise, index, stick),
              plan_,
              options_,
              {result.data() + stick * static_cast<std::size_t>(samples),
               static_cast<std::size_t>(samples)});
    }
  });
  return result;
}

std::vector<std::string> ProbeSimulator::effects() const {
  const bool field = options_.fidelity == Rung::field;
  const std::vector<std::pair<bool, std::string>> all = {
      {true, "tissue_echo"},
      {field && options_.attenuation, "attenuation"},
      {field && options_.transmission_loss, "transmission_loss"},
      {field && options_.speckle, "speckle"},
      {field && options_.speckle, "point_spread"},
      {field, "beam_width"},
      {field && options_.interface_echo, "interface_echo"},
      {field && options_.noise_db > kSilent_db, "noise"},
      {field, "envelope"},
      {field && options_.tgc_db_per_cm_mhz > 0, "time_gain"},
      {field && options_.low_pass, "low_pass"},
      {options_.output == hw::SampleScale::log_compressed, "log_compression"},
  };
  std::vector<std::string> ran;
  for (const auto& [on, name] : all) {
    if (on) ran.push_back(name);
  }
  return ran;
}

}  // namespace wobblebench::sim
