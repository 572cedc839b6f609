#include "sim/fidelity.h"

#include <gtest/gtest.h>

#include "tests/support/expect.h"

namespace wobblebench::sim {
namespace {

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

std::string reason_left_out(const Fidelity& fidelity, const std::string& effect) {
  for (const Effect& candidate : fidelity.effects) {
    if (candidate.name == effect) return candidate.left_out;
  }
  return "no such effect";
}

TEST(Fidelity, ScenesAtRestTakeTheField) {
  const auto chosen = choose_fidelity({}, plan(), false);
  EXPECT_EQ(chosen.rung, Rung::field);
  EXPECT_FALSE(chosen.reason.empty());
  EXPECT_EQ(reason_left_out(chosen, "speckle"), "");
  EXPECT_EQ(reason_left_out(chosen, "side_lobes"), "the rung field leaves it out");
}

TEST(Fidelity, MotionTakesScatterers) {
  EXPECT_EQ(choose_fidelity({}, plan(), true).rung, Rung::scatterers);
  SimulationOptions options;
  options.speckle = false;
  EXPECT_EQ(choose_fidelity(options, plan(), true).rung, Rung::field);
}

TEST(Fidelity, SideLobesTakeScatterers) {
  SimulationOptions options;
  options.side_lobes = true;
  EXPECT_EQ(choose_fidelity(options, plan(), false).rung, Rung::scatterers);
  options.fidelity = Rung::field;
  EXPECT_THROW(choose_fidelity(options, plan(), false), InvalidOption);
}

/// A table of the beam of so low an element is wrong: a point is up to 40 % too short.
TEST(Fidelity, LowElementsTakeNoTableOfTheBeam) {
  const auto of_height = [](double height_m) {
    hw::ProbeOptions probe;
    probe.element_height_m = height_m;
    return hw::AcquisitionPlan(probe, {});
  };
  SimulationOptions options;
  EXPECT_NO_THROW(choose_fidelity(options, of_height(1e-3), false, false));
  EXPECT_THROW(choose_fidelity(options, of_height(1e-3), false, true), InvalidOption) << "points";
  options.fidelity = Rung::scatterers;
  EXPECT_THROW(choose_fidelity(options, of_height(1.7e-3), false, false), InvalidOption);
  EXPECT_NO_THROW(choose_fidelity(options, of_height(1.8e-3), false, false));
  options.fidelity = Rung::reference;
  EXPECT_NO_THROW(choose_fidelity(options, of_height(1e-3), false, true));
}

std::string refusal(const SimulationOptions& options) {
  return refusal_of<InvalidOption>([&] { choose_fidelity(options, plan(), false); });
}

TEST(Fidelity, ScatterersWithoutSpeckleAreRefused) {
  SimulationOptions options;
  options.speckle = false;
  for (const Rung rung : {Rung::automatic, Rung::geometry, Rung::field}) {
    options.fidelity = rung;
    EXPECT_EQ(refusal(options), "") << to_string(rung);
  }
  const std::string why = "speckle = false: needs the rung geometry or field; the rung is ";
  options.fidelity = Rung::scatterers;
  EXPECT_EQ(refusal(options), why + "scatterers (asked for)");
  options.fidelity = Rung::reference;
  EXPECT_EQ(refusal(options), why + "reference (asked for)");
  options.fidelity = Rung::automatic;
  options.side_lobes = true;
  EXPECT_EQ(refusal(options), why + "scatterers (side lobes are asked for)");
}

TEST(Fidelity, GeometryIsTakenIfAllOtherEffectsAreOff) {
  SimulationOptions options;
  options.speckle = options.attenuation = options.transmission_loss = false;
  options.interface_echo = false;
  EXPECT_EQ(choose_fidelity(options, plan(), false).rung, Rung::field) << "there is noise";
  options.noise_db = kZeroAmplitude_db;
  EXPECT_EQ(choose_fidelity(options, plan(), false).rung, Rung::geometry);
  options.fidelity = Rung::geometry;
  options.tissue_sound_speed = true;
  EXPECT_THROW(choose_fidelity(options, plan(), false), InvalidOption);
}

TEST(Fidelity, NoiseBelowTheDynamicRangeIsReportedAsLeftOut) {
  SimulationOptions options;
  EXPECT_EQ(reason_left_out(choose_fidelity(options, plan(), false), "noise"), "");
  options.noise_db = -150;
  EXPECT_EQ(reason_left_out(choose_fidelity(options, plan(), false), "noise"),
            "below the display at every depth");
  options.output = hw::SampleScale::linear_envelope;
  EXPECT_EQ(reason_left_out(choose_fidelity(options, plan(), false), "noise"), "");
}

TEST(Fidelity, ANamedRungIsTaken) {
  SimulationOptions options;
  for (Rung rung : {Rung::geometry, Rung::field, Rung::scatterers, Rung::reference}) {
    options.fidelity = rung;
    EXPECT_EQ(choose_fidelity(options, plan(), true).rung, rung);
  }
}

}  // namespace
}  // namespace wobblebench::sim
