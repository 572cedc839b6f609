#include "sim/probe_simulator.h"

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

hw::StickIndex index_of(int frame, int line) {
  return {0, static_cast<std::uint32_t>(frame), static_cast<std::uint32_t>(line)};
}

hw::Ray sightline(const hw::AcquisitionPlan& plan, int frame, int line) {
  return plan.geometry().stick(plan.theta_rad(line), plan.motor_angle_rad(index_of(frame, line)));
}

/// Profiles of all sticks of a frame range, each thread with its own sampler.
template <class Body>
void for_each_profile(const hw::AcquisitionPlan& plan,
                      const phantoms::Phantom& phantom,
                      const phantoms::Placement& placement,
                      double spacing_m,
                      int samples,
                      int threads,
                      const Body& body) {
  const int lines = plan.acquisition().sticks_per_frame;
  parallel_ranges(plan.sticks_per_volume(), threads, [&](int first, int last) {
    TissueSampler sampler(phantom, placement);
    for (int i = first; i < last; ++i) {
      const int frame = i / lines, line = i % lines;
      body(sampler.profile(sightline(plan, frame, line), spacing_m, samples), frame, line);
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
    float* stick = mean_echoes_.data() +
                   (static_cast<std::size_t>(frame) * acquisition.sticks_per_frame + line) * samples;
    for (const Stretch& stretch : profile.stretches) {
      const double mean = amplitude_of_db(materials_.at(stretch.material).backscatter_db);
      const float value = options_.output == hw::SampleScale::linear_envelope
                              ? static_cast<float>(mean)
                              : log_compressed(mean, options_);
      std::fill(stick + stretch.first, stick + stretch.last, value);
    }
  };
  for_each_profile(
      plan_, phantom, placement, plan_.sample_spacing_m(), samples, options_.threads, fill);
}

void ProbeSimulator::scan_field(const phantoms::Phantom& phantom,
                                const phantoms::Placement& placement) {
  echoes_ = make_echo_field(plan_);
  std::vector<TissueProfile> profiles(static_cast<std::size_t>(plan_.sticks_per_volume()));
  const auto keep = [&](TissueProfile profile, int frame, int line) {
    fill_stick(profile, frame, line);
    profiles[static_cast<std::size_t>(frame * echoes_.lines + line)] = std::move(profile);
  };
  for_each_profile(
      plan_, phantom, placement, echoes_.spacing_m, echoes_.samples, options_.threads, keep);
  if (options_.speckle) {
    filter_across_lines(echoes_, plan_, options_.threads);
    filter_across_frames(echoes_, plan_, options_.threads);
  }
  if (!options_.interface_echo) return;
  parallel_ranges(plan_.sticks_per_volume(), options_.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      add_interfaces(profiles[static_cast<std::size_t>(i)], i / echoes_.lines, i % echoes_.lines);
    }
  });
}

void ProbeSimulator::fill_stick(const TissueProfile& profile, int frame, int line) {
  auto strength = two_way_amplitude(
      profile, materials_, plan_, options_, echoes_.spacing_m, echoes_.samples);
  for (const Stretch& stretch : profile.stretches) {
    const double mean = amplitude_of_db(materials_.at(stretch.material).backscatter_db);
    const float scale = static_cast<float>(options_.speckle ? mean * kRmsOfRayleighMean : mean);
    for (int i = stretch.first; i < stretch.last; ++i) strength[static_cast<std::size_t>(i)] *= scale;
  }
  const auto stick = echoes_.stick(frame, line);
  if (!options_.speckle) {
    std::copy(strength.begin(), strength.end(), stick.begin());
    return;
  }
  const auto key = random_key(options_.seed,
                              RandomStream::speckle,
                              static_cast<std::uint64_t>(frame),
                              static_cast<std::uint64_t>(line));
  fill_speckle(stick, strength, key, sigma_of_fwhm(axial_fwhm_m(plan_)) / echoes_.spacing_m);
}

void ProbeSimulator::add_interfaces(const TissueProfile& profile, int frame, int line) {
  if (profile.interfaces.empty()) return;
  const auto amplitude = two_way_amplitude(
      profile, materials_, plan_, options_, echoes_.spacing_m, echoes_.samples);
  for (std::size_t i = 0; i < profile.interfaces.size(); ++i) {
    const Interface& interface = profile.interfaces[i];
    // What arrives at an interface is what is left at the last sample before it.
    const int before = profile.stretches[i].last - 1;
    add_reflector(echoes_.stick(frame, line),
                  echoes_.spacing_m,
                  interface.range_m,
                  interface_echo(interface, materials_, options_) *
                      static_cast<double>(amplitude[static_cast<std::size_t>(before)]),
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
