// The factory of echo models: one for each rung, with the rung's name and effects.
#include "sim/rungs/echo_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "sim/fidelity.h"
#include "sim/losses/losses.h"

namespace wobblebench::sim {
namespace {

constexpr Rung kRungs[] = {Rung::geometry, Rung::field, Rung::scatterers, Rung::reference};

/// Small enough for the rung `reference`.
hw::AcquisitionPlan small_plan(hw::MotorMode motor = hw::MotorMode::stepped) {
  return {{},
          {.depth_m = 40e-3,
           .sector_rad = 0.02,
           .fan_rad = 0.02,
           .sticks_per_frame = 3,
           .samples_per_stick = 64,
           .frames_per_volume = 2,
           .motor = motor}};
}

SimulationOptions options_of(Rung rung) {
  SimulationOptions options;
  options.fidelity = rung;
  options.scatterers_per_cell = 1;
  return options;
}

ScannedTissue sphere(Rung rung, const hw::AcquisitionPlan& plan, phantoms::Motion motion = {}) {
  static const auto phantom = phantoms::make_phantom({.name = "sphere", .radius_m = 2e-3});
  return {std::make_shared<const TissueMap>(phantom, echo_model_type(rung).reach_m(plan), 0),
          phantom.materials(),
          {glm::dmat3(1.0), {0, 0, plan.probe().radius_m + 20e-3}},
          std::move(motion)};
}

std::vector<float> stick(const EchoModel& model, std::uint64_t sequence) {
  std::vector<float> samples(64, -1.0f);
  model.stick_maker({})(sequence, samples);
  return samples;
}

TEST(EchoModel, EachRungHasItsModel) {
  const auto plan = small_plan();
  for (const Rung rung : kRungs) {
    const auto model = make_echo_model(rung, sphere(rung, plan), plan, options_of(rung));
    EXPECT_EQ(model->type().name, to_string(rung));
    EXPECT_EQ(&model->type(), &echo_model_type(rung));
    for (const float sample : stick(*model, 4)) {
      EXPECT_TRUE(sample >= 0 && sample <= 1) << to_string(rung) << ": " << sample;
    }
  }
}

TEST(EchoModel, ARungModelsWhatTheLowerOnesModelAndMore) {
  const EchoModelType* lower = nullptr;
  for (const Rung rung : kRungs) {
    const EchoModelType& type = echo_model_type(rung);
    EXPECT_EQ(type.lower, lower) << type.name;
    EXPECT_FALSE(type.added_effects.empty()) << type.name;
    for (const auto effect : type.added_effects) {
      EXPECT_TRUE(type.models(effect)) << effect;
      EXPECT_FALSE(lower != nullptr && lower->models(effect)) << effect;
    }
    lower = &type;
  }
}

TEST(EchoModel, EffectsAreThoseOfTheReports) {
  const auto reported = choose_fidelity({}, small_plan(), false).effects;
  const auto is_reported = [&](std::string_view name) {
    return std::any_of(reported.begin(), reported.end(), [&](const Effect& effect) {
      return effect.name == name;
    });
  };
  std::size_t effects = 0;
  for (const Rung rung : kRungs) {
    for (const auto effect : echo_model_type(rung).added_effects) {
      EXPECT_TRUE(is_reported(effect)) << effect;
      ++effects;
    }
  }
  EXPECT_EQ(effects, reported.size()) << "each effect belongs to exactly one rung";
  EXPECT_FALSE(echo_model_type(Rung::reference).models("no such effect"));
}

TEST(EchoModel, AutomaticIsNoRung) {
  EXPECT_THROW(echo_model_type(Rung::automatic), std::logic_error);
  EXPECT_EQ(to_string(Rung::automatic), "auto");
}

TEST(EchoModel, VolumesRepeatUnlessTheSweepAlternates) {
  // In the mode alternating, volume 1 begins with the last frame.
  auto options = options_of(Rung::field);
  options.noise_db = kZeroAmplitude_db;
  const std::uint64_t next_volume = 6;
  for (const auto motor : {hw::MotorMode::stepped, hw::MotorMode::alternating}) {
    const auto plan = small_plan(motor);
    const auto model = make_echo_model(Rung::field, sphere(Rung::field, plan), plan, options);
    const bool repeats = stick(*model, 0) == stick(*model, next_volume);
    EXPECT_EQ(repeats, motor == hw::MotorMode::stepped);
  }
}

TEST(StickOrder, TakesEachStickOnce) {
  for (const int frames : {1, 15, 16, 17, 37}) {
    for (const int lines : {1, 5}) {
      for (const std::uint32_t volume : {0u, 1u}) {  // an odd volume sweeps back
        const hw::AcquisitionPlan plan({},
                                       {.sticks_per_frame = lines,
                                        .frames_per_volume = frames,
                                        .motor = hw::MotorMode::alternating});
        std::set<std::uint64_t> sequences;
        for (int i = 0; i < frames * lines; ++i) {
          sequences.insert(plan.sequence(stick_in_order(plan, volume, i)));
        }
        ASSERT_EQ(sequences.size(), static_cast<std::size_t>(frames * lines));
        EXPECT_EQ(*sequences.begin(), plan.first_sequence(volume));
        EXPECT_EQ(*sequences.rbegin() + 1, plan.first_sequence(volume + 1));
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
