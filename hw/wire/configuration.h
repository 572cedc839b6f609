// What the sticks of a stream are: their source, subject, display scale and acquisition.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/options.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::hw {

/// The source of a stream's samples. The values are those of the wire format.
enum class StreamOrigin : std::uint32_t {
  simulated = 1,  ///< a synthetic probe
  recording = 2,  ///< a file, of any origin
  emulator = 3,   ///< an emulation of the card's driver
  hardware = 4,   ///< a real card
};

/// "simulated", "recording", "stand-in" or "hardware", as in reports.
constexpr std::string_view to_string(StreamOrigin origin) {
  switch (origin) {
    case StreamOrigin::simulated:
      return "simulated";
    case StreamOrigin::recording:
      return "recording";
    case StreamOrigin::emulator:
      return "stand-in";
    case StreamOrigin::hardware:
      return "hardware";
  }
  return "unknown";
}

/// What the samples are of, as far as it decides the truth about them: CRC-32C of the settings of a
/// simulated subject, and of an imported file's bytes. All 0: the
/// stream does not say.
struct SubjectHash {
  std::uint32_t phantom = 0;
  std::uint32_t placement = 0;  ///< in the probe frame
  std::uint32_t motion = 0;

  bool stated() const { return *this != SubjectHash(); }
  friend bool operator==(const SubjectHash&, const SubjectHash&) = default;
};

/// Settings of the receiver between an echo and its sample. All 0: the stream does not say; the
/// dynamic range may be known alone. Echo amplitudes are in dB relative to a perfect mirror across
/// the beam.
///
/// @code
/// #include "hw/recording/recording.h"
/// const auto configuration = hw::inspect_recording("scan.wbst").configuration;
/// if (!configuration || !configuration->display_scale.stated()) return;
/// const double middle_db = hw::echo_db(0.5F,
///                                      hw::SampleScale::log_compressed,
///                                      configuration->display_scale,
///                                      configuration->plan,
///                                      configuration->plan.sample_range_m(100));
/// if (middle_db < -80) return;
/// @endcode
struct DisplayScale {
  double full_scale_db = 0;      ///< echo amplitude after TGC that becomes sample value 1
  double dynamic_range_db = 0;   ///< below full scale; log compression maps it to [0, 1]
  double tgc_db_per_cm_mhz = 0;  ///< nominal one-way loss that TGC compensates, both ways
  bool range_alone = false;      ///< full scale and TGC are not known, and 0

  bool stated() const { return *this != DisplayScale() && !range_alone; }
  bool knows_range() const { return stated() || range_alone; }
  friend bool operator==(const DisplayScale&, const DisplayScale&) = default;
};

/// Of any options with these three fields.
template <class Options, class Visitor>
void describe_display_scale(Options& o, Visitor& v) {
  v.real("tgc_db_per_cm_mhz", o.tgc_db_per_cm_mhz, 1, 0, 3);
  v.real("full_scale_db", o.full_scale_db, 1, -100, 20);
  v.real("dynamic_range_db", o.dynamic_range_db, 1, 10, 200);
}

/// The range check is of scales that are stated.
template <OptionsOf<DisplayScale> O, class Visitor>
void describe(O& o, Visitor& v) {
  describe_display_scale(o, v);
}

/// TGC over full scale is at most this.
inline constexpr double kMostGain_db = 600;

/// The echo amplitude that a sample at a range stands for, dB: undoes log compression, full scale
/// and TGC. Log-compressed samples of 0 and 1 stand for all amplitudes from there down and up; a
/// linear 0 is minus infinity. Throws std::invalid_argument unless the scale is stated.
double echo_db(float sample,
               SampleScale sample_scale,
               const DisplayScale& display_scale,
               const AcquisitionPlan& plan,
               double range_m);

/// The acquisition that the sticks belong to: given at the start of a stream, and again where it
/// changes.
struct Configuration {
  AcquisitionPlan plan;
  StreamOrigin source;  ///< of the samples, also in a recording
  SubjectHash subject = {};
  DisplayScale display_scale = {};
  /// False for scans of other programs: the plan's line rate, and the times of sticks, say nothing.
  bool knows_times = true;
};

}  // namespace wobblebench::hw
