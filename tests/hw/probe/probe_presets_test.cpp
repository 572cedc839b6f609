#include "hw/probe/probe.h"

#include <gtest/gtest.h>

#include <string>

#include "base/options.h"
#include "hw/probe/acquisition_plan.h"
#include "tests/support/expect.h"

namespace wobblebench::hw {
namespace {

constexpr ProbePreset kPresets[] = {
    ProbePreset::standard, ProbePreset::c5_2v, ProbePreset::curvilinear_60};

TEST(ProbePresets, AreValidAndNameSourceAndAssumptions) {
  for (const ProbePreset preset : kPresets) {
    const ProbePresetData& data = probe_preset(preset);
    EXPECT_NO_THROW(validate(data.probe));
    AcquisitionOptions acquisition;
    acquisition.sector_rad = data.sector_rad;
    EXPECT_NO_THROW(AcquisitionPlan(data.probe, acquisition));
    EXPECT_TRUE(holds(data.source, "docs/references.md ["));
    EXPECT_TRUE(holds(data.source, "assumed: "));
  }
}

TEST(ProbePresets, DefaultIsTheOptionsDefault) {
  EXPECT_TRUE(probe_preset(ProbePreset::standard).probe == ProbeOptions{});
  EXPECT_EQ(probe_preset(ProbePreset::standard).sector_rad, AcquisitionOptions{}.sector_rad);
}

TEST(ProbePresets, HaveThePublishedValues) {
  const ProbePresetData& c5 = probe_preset(ProbePreset::c5_2v);
  EXPECT_DOUBLE_EQ(c5.probe.center_frequency_hz, 3.57e6);
  EXPECT_DOUBLE_EQ(c5.probe.radius_m, 49.57e-3);
  EXPECT_DOUBLE_EQ(c5.probe.pitch_m, 0.508e-3);
  EXPECT_NEAR(c5.sector_rad / kDegree, 74.6, 0.05);
  const ProbePresetData& large = probe_preset(ProbePreset::curvilinear_60);
  EXPECT_DOUBLE_EQ(large.probe.center_frequency_hz, 3e6);
  EXPECT_DOUBLE_EQ(large.probe.radius_m, 60e-3);
  EXPECT_DOUBLE_EQ(large.probe.pitch_m, 0.477e-3);
}

/// Reads one preset and one other key, as a scene file does.
struct Reader {
  ProbePreset preset;
  std::string source;
  void choice(std::string_view,
              ProbePreset& value,
              std::initializer_list<std::pair<std::string_view, ProbePreset>>) {
    value = preset;
  }
  void constant(std::string_view key, std::string_view text) {
    EXPECT_EQ(key, "preset_source");
    source = text;
  }
  void real(std::string_view key, double& value, double unit, double, double) {
    if (key == "f_number") value = 2.5 * unit;
  }
  void integer(std::string_view, int&, int, int) {}
};

TEST(NamedProbeOptions, KeysOverrideThePreset) {
  for (const ProbePreset preset : kPresets) {
    NamedProbeOptions probe;
    Reader reader{preset, ""};
    describe(probe, reader);
    ProbeOptions expected = probe_preset(preset).probe;
    expected.f_number = 2.5;
    EXPECT_TRUE(static_cast<const ProbeOptions&>(probe) == expected);
    EXPECT_EQ(reader.source, probe_preset(preset).source);
  }
}

TEST(NamedProbeOptions, KeepTheirValuesWhereThePresetIsUnchanged) {
  NamedProbeOptions probe;
  probe.radius_m = 50e-3;
  Reader reader{ProbePreset::standard, ""};
  describe(probe, reader);
  EXPECT_EQ(probe.radius_m, 50e-3);
  EXPECT_NO_THROW(check_options(probe));
}

}  // namespace
}  // namespace wobblebench::hw
