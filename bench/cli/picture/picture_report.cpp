#include "bench/cli/picture/picture_report.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "base/units.h"
#include "bench/output/error_report.h"

namespace wobblebench::bench {

namespace {

std::string nothing_in_view(const DepthError& raw, const ExpectedSurface& expected) {
  std::string line = "depth error none: no surface in view: " + why_none(raw, expected);
  if (expected.sought && expected.in_phantom && raw.false_surface > 0) {
    line += "; false " + rounded(raw.false_percent()) + " % of the picture";
  }
  return line + "\n";
}

/// Empty where the probe can see every surface in view.
std::string unseen_line(const DepthError& raw) {
  std::string line;
  for (const auto& [name, count] : {std::pair{"outside the field", raw.outside_field},
                                    std::pair{"grazing", raw.grazing},
                                    std::pair{"shadowed", raw.shadowed}}) {
    if (count == 0) continue;
    line +=
        (line.empty() ? "unseen      " : ", ") + rounded(100.0 * count / raw.pixels) + " % " + name;
  }
  return line.empty() ? line : line + " (of the picture; counted apart)\n";
}

/// Empty where the box cuts next to nothing off.
std::string cut_line(double percent) {
  constexpr double kLeast = 0.5;
  if (!(percent >= kLeast)) return "";
  return "cut off     " + rounded(percent) +
         " % of the surface that the probe could see lies outside render.volume_of_interest\n";
}

}  // namespace

std::string rounded(double value) {
  if (!std::isfinite(value)) return "none";
  std::ostringstream text;
  text << std::setprecision(3);
  if (std::abs(value) >= 100) text << std::fixed << std::setprecision(0);
  text << value;
  return text.str();
}

std::string in_mm(double metres) {
  return rounded(metres / kMillimetre);
}

std::string error_text(const Comparison& comparison, const ResolvedScene& scene) {
  const ExpectedSurface expected = expected_surface(scene);
  const DepthError& raw = comparison.error.raw;
  if (!raw.surface_in_view()) return nothing_in_view(raw, expected);
  const auto percent = [&](double value) { return expected.sought ? rounded(value) : "none"; };
  return "depth error bias " + in_mm(raw.depth.bias_m) + " mm, RMS " + in_mm(raw.depth.rms_m) +
         " mm, P95 " + in_mm(raw.depth.p95_m) + " mm, " + rounded(100 * raw.depth.outlier_share) +
         " % beyond 10 mm, over " + std::to_string(raw.depth.n) + " pixels\nsurface     missed " +
         percent(raw.missed_surface_percent()) + " % of its area (" +
         percent(raw.missed_percent()) + " % of the picture), false " +
         percent(raw.false_percent()) + " % of the picture\n" + unseen_line(raw) +
         cut_line(comparison.error.cut_by_box_percent);
}

}  // namespace wobblebench::bench
