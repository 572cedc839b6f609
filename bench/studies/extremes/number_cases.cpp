// Numbers at their ends that no picture shows: device time, sequence numbers, phase.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "base/units.h"
#include "bench/studies/extremes/extremes.h"
#include "bench/studies/extremes/pass_bounds.h"
#include "hw/wire/decoder.h"
#include "sim/speckle/iq_field.h"

namespace wobblebench::bench {

namespace {

constexpr std::uint64_t kLast = std::numeric_limits<std::uint64_t>::max();

/// Device time counts 2^63 ns; numbers beyond its end must not wrap to earlier times.
NumberOutcome device_time_at_its_end() {
  hw::AcquisitionOptions acquisition;
  acquisition.dead_time_s = 10e-3;
  const hw::AcquisitionPlan plan({}, acquisition);
  const double last_s = 0x1p63 * 1e-9;
  double worst_ns = 0;
  hw::DeviceTime before{};
  for (int power = 32; power <= 64; ++power) {
    const std::uint64_t sequence = power == 64 ? kLast : std::uint64_t{1} << power;
    const hw::DeviceTime time = plan.stick_time(sequence);
    const double exact_s = std::min(static_cast<double>(sequence) * plan.stick_period_s(), last_s);
    const double found_s = static_cast<double>(time.time_since_epoch().count()) * 1e-9;
    const double relative = std::abs(found_s - exact_s) / exact_s;
    worst_ns = std::max({worst_ns, relative, time < before ? 1.0 : 0.0});
    before = time;
  }
  return {"device time to its end",
          worst_ns,
          4 * std::numeric_limits<double>::epsilon(),
          "of the time",
          "number times period, at most 2^63 ns, and never earlier than before; four roundings of "
          "double"};
}

/// Bytes and back, of the last number of 64 bits and its neighbours.
NumberOutcome sequence_at_its_end() {
  double wrong = 0;
  for (const std::uint64_t sequence :
       {std::uint64_t{0xffffffff}, std::uint64_t{0x100000000}, kLast - 1, kLast}) {
    hw::Stick stick;
    stick.sequence = sequence;
    stick.samples = {0.25F, 0.5F};
    std::vector<std::byte> bytes;
    encode(stick, bytes);
    hw::Decoder decoder;
    decoder.feed(bytes);
    const auto packet = decoder.next();
    const auto* read = packet ? std::get_if<hw::StickPacket>(&*packet) : nullptr;
    // The last number is refused: the following stick needs one, too.
    const bool right =
        sequence == kLast ? read == nullptr : read != nullptr && read->stick.sequence == sequence;
    wrong += right ? 0 : 1;
  }
  const hw::AcquisitionPlan plan({}, {});
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  const std::uint64_t end = sticks << 32;
  wrong += plan.has_stick(end - 1) && !plan.has_stick(end) && !plan.has_stick(kLast) ? 0 : 1;
  wrong += plan.sequence(plan.index(end - 1)) == end - 1 ? 0 : 1;
  return {"sequence numbers at 2^32 and 2^64",
          wrong,
          0,
          "numbers",
          "as sent, but for 2^64 - 1, which is refused; a plan's last stick is that of volume 2^32 "
          "- 1"};
}

/// 400 mm at 20 MHz and 1000 m/s are 16000 periods there and back: rounded to float32 before the
/// whole periods are taken off, the phase would be wrong by 6e-3 rad.
NumberOutcome phase_at_400_mm() {
  hw::ProbeOptions probe;
  probe.center_frequency_hz = 20e6;
  hw::AcquisitionOptions acquisition;
  acquisition.depth_m = 0.4;
  acquisition.sound_speed_m_s = 1000;
  acquisition.samples_per_stick = 4096;
  const hw::AcquisitionPlan plan(probe, acquisition);
  double worst_rad = 0;
  for (const double range_m : {0.399, 0.39901234567, 0.3990087}) {
    std::vector<std::complex<float>> stick(40000);
    const double spacing_m = acquisition.depth_m / static_cast<double>(stick.size());
    sim::add_reflector(stick, spacing_m, range_m, 1, plan);
    const auto at = static_cast<std::size_t>(range_m / spacing_m);
    const long double cycles = 2.0L * range_m * 20e6L / 1000.0L;
    const auto exact = std::polar(
        1.0,
        static_cast<double>(-2 * static_cast<long double>(kPi) * (cycles - std::floor(cycles))));
    const std::complex<double> found(stick[at].real(), stick[at].imag());
    worst_rad = std::max(worst_rad, std::abs(std::arg(found / exact)));
  }
  return {"phase of an echo at 400 mm",
          worst_rad,
          2 * kUnitRoundoff + 2 * kPi * 16000 * 4 * std::numeric_limits<double>::epsilon(),
          "rad",
          "4 pi f r / c in 80 bits; the IQ sample rounded to float32, periods counted in double"};
}

}  // namespace

std::vector<NumberOutcome> run_number_cases() {
  return {device_time_at_its_end(), sequence_at_its_end(), phase_at_400_mm()};
}

}  // namespace wobblebench::bench
