#include "render/reconstruction/stick_edges.h"

#include <cmath>

#include "base/parallel.h"

namespace wobblebench::render {
namespace {

/// Windows around a sample, in samples.
struct Windows {
  int middle, side;
};

/// Range of the first edge in a stick's samples.
double first_edge_m(const WindowMeans& means,
                    const SampleSpan& span,
                    const Windows& windows,
                    double level,
                    double sign,
                    double spacing_m) {
  const int before = windows.middle / 2;
  // Positive beyond the edge.
  const auto beyond = [&](int begin, int end) { return sign * (means.mean(begin, end) - level); };
  const auto here = [&](int k) { return beyond(k - before, k - before + windows.middle); };
  for (int k = std::max(span.begin, 1); k < span.end; ++k) {
    const double now = here(k);
    if (now < 0 || beyond(k, k + windows.side) < 0 || beyond(k - windows.side, k) >= 0) continue;
    const double last = here(k - 1);
    const double past = last < 0 ? now / (now - last) : 0;
    // The window's middle, as a range: sample k begins at k spacings.
    return (k - past - before + 0.5 * windows.middle) * spacing_m;
  }
  return kNoEdge;
}

bool has_support(const std::vector<double>& edges, int frames, int lines, int frame, int line) {
  const auto edge = [&](int f, int l) { return edges[static_cast<std::size_t>(f * lines + l)]; };
  int neighbours = 0, near = 0;
  for (int f = frame - 1; f <= frame + 1; ++f) {
    for (int l = line - 1; l <= line + 1; ++l) {
      if (f < 0 || l < 0 || f >= frames || l >= lines || (f == frame && l == line)) continue;
      ++neighbours;
      near += std::abs(edge(f, l) - edge(frame, line)) < kSupport_m;
    }
  }
  return 4 * near >= neighbours;
}

}  // namespace

std::vector<double> find_stick_edges(const hw::AcquisitionPlan& plan,
                                     const std::vector<std::vector<float>>& frames,
                                     const std::vector<SampleSpan>& spans,
                                     const EchoLevels& levels,
                                     EdgeSign sign,
                                     double fraction) {
  const int lines = plan.acquisition().sticks_per_frame;
  const int samples = plan.acquisition().samples_per_stick;
  const int count = static_cast<int>(frames.size());
  std::vector<double> edges(spans.size(), kNoEdge);
  if (!levels.separate) return edges;
  const Windows windows{samples_in(kEdgeMean_m, plan), samples_in(kEdgeSides_m, plan)};
  parallel_rows(count, [&](int frame) {
    for (int line = 0; line < lines; ++line) {
      const auto stick = static_cast<std::size_t>(frame * lines + line);
      if (spans[stick].begin >= spans[stick].end) continue;
      const WindowMeans means(
          frames[static_cast<std::size_t>(frame)].data() + std::ptrdiff_t{line} * samples, samples);
      edges[stick] = first_edge_m(means,
                                  spans[stick],
                                  windows,
                                  levels.at(fraction),
                                  sign == EdgeSign::rising ? 1 : -1,
                                  plan.sample_spacing_m());
    }
  });
  std::vector<double> supported = edges;
  for (int frame = 0; frame < count; ++frame) {
    for (int line = 0; line < lines; ++line) {
      if (has_support(edges, count, lines, frame, line)) continue;
      supported[static_cast<std::size_t>(frame * lines + line)] = kNoEdge;
    }
  }
  return supported;
}

}  // namespace wobblebench::render
