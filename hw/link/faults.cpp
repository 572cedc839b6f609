#include "hw/link/faults.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "base/hash.h"
#include "base/options.h"

namespace wobblebench::hw {
namespace {

constexpr std::array<std::string_view, kFaultKinds> kNames = {"drop",
                                                              "duplicate",
                                                              "corrupt",
                                                              "truncate",
                                                              "reorder",
                                                              "delay",
                                                              "stall",
                                                              "unplug",
                                                              "short_reads"};

constexpr int kLongestWaitMs = 60000;

[[noreturn]] void refuse(const std::string& term, const std::string& allowed) {
  throw InvalidOption("faults", term, allowed);
}

template <class T>
T number(const std::string& term, std::string_view text, T least, T most) {
  T value{};
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && rest == text.data() + text.size();
  if (whole && value >= least && value <= most) return value;
  std::ostringstream allowed;
  allowed << "must be a number within " << least << " and " << most;
  refuse(term, allowed.str());
}

FaultKind kind_of(const std::string& term, std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found != kNames.end()) return static_cast<FaultKind>(found - kNames.begin());
  std::string all;
  for (const auto& known : kNames) all += (all.empty() ? "" : ", ") + std::string(known);
  refuse(term,
         "must be KIND:RATE or KIND@PACKET with one of " + all +
             "; or seed:N, delay_ms:N, stall_ms:N");
}

void read_term(FaultPlan& plan, const std::string& term) {
  constexpr std::uint64_t kAny = ~std::uint64_t{0};
  const std::size_t sign = std::min(term.find_first_of(":@"), term.size());
  const std::string_view name = std::string_view(term).substr(0, sign);
  const std::string_view value = std::string_view(term).substr(std::min(sign + 1, term.size()));
  const bool at = sign < term.size() && term[sign] == '@';
  if (!at && name == "seed") {
    plan.seed = number<std::uint64_t>(term, value, 0, kAny);
  } else if (!at && name == "delay_ms") {
    plan.delay = std::chrono::milliseconds(number(term, value, 0, kLongestWaitMs));
  } else if (!at && name == "stall_ms") {
    plan.stall = std::chrono::milliseconds(number(term, value, 0, kLongestWaitMs));
  } else if (at) {
    plan.faults.push_back({kind_of(term, name), 0, number<std::uint64_t>(term, value, 0, kAny)});
  } else {
    plan.faults.push_back({kind_of(term, name), number(term, value, 0.0, 1.0), {}});
  }
}

}  // namespace

std::string_view to_string(FaultKind kind) {
  return kNames.at(static_cast<std::size_t>(kind));
}

std::uint64_t FaultPlan::draw(FaultKind kind, std::uint64_t packet, std::uint64_t purpose) const {
  const auto stream = purpose * kFaultKinds + static_cast<std::uint64_t>(kind);
  return mix64(mix64(mix64(seed + kGoldenGamma) + stream + kGoldenGamma) + packet + kGoldenGamma);
}

bool FaultPlan::affects(FaultKind kind, std::uint64_t packet) const {
  return std::any_of(faults.begin(), faults.end(), [&](const Fault& fault) {
    if (fault.kind != kind) return false;
    if (fault.at) return *fault.at == packet;
    return unit_interval(draw(kind, packet, 0)) < fault.rate;
  });
}

FaultPlan parse_faults(const std::string& text) {
  FaultPlan plan;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('+', at), text.size());
    read_term(plan, text.substr(at, end - at));
    at = end + 1;
  }
  return plan;
}

}  // namespace wobblebench::hw
