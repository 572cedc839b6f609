#include "bench/pipeline/stream/stream_source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "base/number_text.h"
#include "base/units.h"
#include "base/user_error.h"
#include "hw/board/volume_assembly.h"

namespace wobblebench::bench {

FirstConfiguration first_configuration(hw::Board& board, const std::string& name) {
  hw::VolumeAssembly assembly(board);
  board.start();
  if (!assembly.wait_for_configuration(hw::HostClock::now() + kVolumeTimeout)) {
    // The board returns its end again at every call.
    std::string ending = ending_of(board.next(hw::HostTime::min()));
    const std::uint64_t skipped = board.damage().bytes_skipped;
    if (!ending.empty() && skipped > 0) {
      ending += "; " + std::to_string(skipped) + " bytes are no packet with a correct checksum";
    }
    throw nothing_came(name, "configuration", std::move(ending));
  }
  board.stop();
  return {*assembly.configuration(), assembly.before_configuration()};
}

std::string ending_of(const hw::Event& event) {
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) return lost->reason;
  const auto* end = std::get_if<hw::EndOfStream>(&event);
  if (end == nullptr) return "";
  return end->truncated ? "the stream is cut short" : "the stream is over";
}

NothingCame nothing_came(const std::string& name, const std::string& what, std::string ending) {
  if (ending.empty()) {
    ending = "nothing arrived for " + std::to_string(kVolumeTimeout.count()) + " minutes";
  }
  return NothingCame("--board " + name + ": no " + what + " came; " + ending);
}

namespace {

void count_samples(ReceivedSamples& received, const float* samples, std::size_t count) {
  const float limit =
      received.scale == hw::SampleScale::log_compressed ? 1.0f : std::numeric_limits<float>::max();
  received.count += count;
  for (std::size_t k = 0; k < count; ++k) {
    const float sample = samples[k];
    received.out_of_range += !(sample >= 0.0f && sample <= limit);
    if (!std::isfinite(sample)) continue;
    received.least = std::min(received.least, sample);
    received.most = std::max(received.most, sample);
  }
}

ReceivedSamples received_samples(const hw::PolarVolume& volume) {
  ReceivedSamples received;
  received.scale = volume.scale();
  received.least = std::numeric_limits<float>::max();
  received.most = std::numeric_limits<float>::lowest();
  for (const hw::PolarFrame& frame : volume.frames()) {
    const std::size_t samples = frame.samples.size() / frame.arrived.size();
    for (std::size_t line = 0; line < frame.arrived.size(); ++line) {
      if (frame.arrived[line] == 0) continue;
      count_samples(received, frame.samples.data() + line * samples, samples);
    }
  }
  if (received.least > received.most) received.least = received.most = 0;
  return received;
}

}  // namespace

ReceivedSamples make_displayable(hw::PolarVolume& volume,
                                 const hw::Configuration& configuration,
                                 std::optional<double> dynamic_range_db,
                                 const std::string& board) {
  ReceivedSamples received = received_samples(volume);
  const auto refuse = [&](const std::string& why) {
    throw UserError("--board = " + board + ": " + why);
  };
  if (received.scale == hw::SampleScale::linear_envelope) {
    const hw::DisplayScale& scale = configuration.display_scale;
    // Simulations of before a stream stated it have full scale at 1, too.
    const bool is_known = scale.stated() || configuration.source == hw::StreamOrigin::simulated;
    if (scale.stated() && !dynamic_range_db) dynamic_range_db = scale.dynamic_range_db;
    if (!is_known || !dynamic_range_db) {
      refuse(
          "its samples are linear envelopes of unknown full scale; they must be log-compressed, or "
          "its configuration must state the display scale");
    }
    received.dynamic_range_db = dynamic_range_db;
    volume.log_compress(*dynamic_range_db);
  }
  const double percent =
      100 * static_cast<double>(received.out_of_range) / static_cast<double>(received.count);
  if (percent > kMostOutOfRangePercent) {
    refuse("its samples go from " + significant(static_cast<double>(received.least), 3) + " to " +
           significant(static_cast<double>(received.most), 3) + ", " + significant(percent, 3) +
           " % of them out of range; they must be finite, and log-compressed from 0 to 1");
  }
  return received;
}

namespace {

std::string degrees(double rad) {
  return significant(rad / kDegree, 3);
}

}  // namespace

void refuse_misplaced(const hw::MotorDeviation& motor,
                      const hw::AcquisitionPlan& plan,
                      const std::string& board) {
  const auto frame = static_cast<std::uint64_t>(plan.acquisition().sticks_per_frame);
  if (plan.phi_step_rad() == 0 || motor.sticks <= frame || !motor.matters(plan)) return;
  const auto [low_rad, high_rad] = hw::planned_fan_rad(plan);
  const double covered_rad = std::min(high_rad, motor.high_rad) - std::max(low_rad, motor.low_rad);
  if (covered_rad >= plan.phi_step_rad()) return;
  throw UserError("--board = " + board + ": its motor angles go from " + degrees(motor.low_rad) +
                  " to " + degrees(motor.high_rad) + " deg; the plan's fan is " + degrees(low_rad) +
                  " to " + degrees(high_rad) + " deg, and at least one frame's step of it (" +
                  degrees(plan.phi_step_rad()) + " deg) must be covered");
}

}  // namespace wobblebench::bench
