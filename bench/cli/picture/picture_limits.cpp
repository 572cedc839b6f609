#include "bench/cli/picture/picture_limits.h"

#include "bench/results/times.h"

namespace wobblebench::bench {

Measurements picture_figures(const PictureMeasures* measures,
                             std::optional<double> frame_ms,
                             const std::string& why_none) {
  const bool formed = measures != nullptr && why_none.empty();
  const Measurements found = formed ? described(*measures, ExpectedSurface()) : Measurements();
  Measurements figures;
  figures.because(formed ? why_no_surface(measures->raw) : why_none);
  for (const Measure* measure : picture_measures()) figures.add(*measure, found.value(*measure));
  if (frame_ms) figures.add(times::kFrame, *frame_ms);
  return figures;
}

}  // namespace wobblebench::bench
