#include "bench/studies/tables/measure.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>

#include "base/duration.h"
#include "hw/probe/clock.h"
#include "render/gl/fetch_count.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

/// Identity of a measurement: settings that several tables share are measured once.
auto key_of(const TableRow& row, PipelineVariant variant) {
  return std::tuple(row.frames, row.side, row.kernel_3d, row.kernel_2d, variant);
}
using Key = decltype(key_of(TableRow{}, PipelineVariant::plain));

/// One setting under measurement; its renderer is kept for all repeats.
struct TimedSetting {
  const hw::PolarVolume* volume = nullptr;
  std::unique_ptr<render::Renderer> renderer;
  int repeats = 0;
  std::vector<double> frame_ms;
  std::vector<std::string> pass_names;
  std::vector<std::vector<double>> pass_ms;  ///< [pass][repeat]

  /// One of `repeats`; repeat -1 is not counted.
  void measure(int repeat) {
    renderer->add_volume(*volume);
    const auto passes = renderer->render().passes;
    if (repeat >= 0) count(passes);
  }

  void count(const std::vector<render::PassTime>& passes) {
    pass_ms.resize(passes.size());
    pass_names.clear();
    frame_ms.push_back(0);
    for (std::size_t i = 0; i < passes.size(); ++i) {
      pass_names.push_back(passes[i].name);
      pass_ms[i].push_back(passes[i].ms);
      frame_ms.back() += passes[i].ms;
    }
  }

  Timing timing() const {
    Timing timing{spread_of(frame_ms), {}};
    for (std::size_t i = 0; i < pass_ms.size(); ++i) {
      timing.passes.push_back({pass_names[i], spread_of(pass_ms[i]).median});
    }
    return timing;
  }
};

using TimedSettings = std::map<Key, TimedSetting>;

TimedSettings make_settings(const TableVolumes& volumes,
                            const render::RenderOptions& base,
                            render::GlContext& context,
                            const TableRun& run) {
  TimedSettings settings;
  for (const PaperTable& table : paper_tables()) {
    for (const TableRow& row : table.rows) {
      for (const PipelineVariant variant : variants_of(table)) {
        TimedSetting& setting = settings[key_of(row, variant)];
        if (setting.renderer) continue;
        setting.volume = &volumes.by_frames.at(row.frames);
        setting.repeats = run.repeats_of(variant);
        setting.renderer = std::make_unique<render::Renderer>(
            context,
            setting.volume->plan(),
            rendered(variant, settings_of(row, base, run.divisor)));
      }
    }
  }
  return settings;
}

std::size_t count_pictures(const TimedSettings& settings) {
  std::size_t pictures = 0;
  for (const auto& [key, setting] : settings) {
    pictures += static_cast<std::size_t>(setting.repeats) + 1;
  }
  return pictures;
}

MeasuredRow measured_row(const TableRow& row,
                         const PaperTable& table,
                         const TimedSettings& settings) {
  MeasuredRow measured{row, row.paper_ms / reference_row().paper_ms, {}};
  for (const PipelineVariant variant : variants_of(table)) {
    Timing timing = settings.at(key_of(row, variant)).timing();
    timing.median_ms = median_interval(settings.at(key_of(row, variant)).frame_ms);
    timing.ratio = paired_ratio(settings.at(key_of(row, variant)).frame_ms,
                                settings.at(key_of(reference_row(), variant)).frame_ms);
    measured.timings.emplace(variant, std::move(timing));
  }
  return measured;
}

std::optional<Exponents> exponents_of(const std::vector<MeasuredRow>& rows) {
  std::vector<double> side, paper, plain, fast;
  for (const MeasuredRow& row : rows) {
    side.push_back(row.row.side);
    paper.push_back(row.row.paper_ms);
    plain.push_back(row.ms(PipelineVariant::plain));
    fast.push_back(row.ms(PipelineVariant::fast));
  }
  if (std::all_of(side.begin(), side.end(), [&](double s) { return s == side.front(); })) return {};
  return Exponents{power_of(side, paper), power_of(side, plain), power_of(side, fast)};
}

std::vector<PassFloor> count_fetches(const hw::PolarVolume& volume,
                                     const render::RenderOptions& options,
                                     render::GlContext& context) {
  const render::FetchCounter counter;
  std::vector<PassFloor> passes;
  for (const auto& pass : render::render_volume(context, volume, options).passes) {
    passes.push_back({pass.name, pass.fetches});
  }
  return passes;
}

/// Counts the fetches of one frame of each variant, and measures the rate of each kind.
Floors measure_floors(const hw::PolarVolume& volume,
                      const std::map<PipelineVariant, render::RenderOptions>& variants,
                      render::GlContext& context) {
  context.make_current();
  Floors floors;
  for (const auto& [variant, options] : variants) {
    auto& passes = floors.passes[variant] = count_fetches(volume, options, context);
    for (PassFloor& pass : passes) {
      for (const auto& [kind, count] : pass.fetches) {
        if (!floors.rates_per_us.contains(kind)) {
          floors.rates_per_us[kind] = render::fetch_rate_per_us(kind);
        }
        pass.floor_ms += 1e-3 * static_cast<double>(count) / floors.rates_per_us[kind];
      }
    }
  }
  return floors;
}

/// Wall time of adding each frame in turn, milliseconds. update() waits until GL is done.
std::vector<double> add_frames(render::Renderer& renderer, const hw::PolarVolume& volume) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> each_ms;
  for (int f = 0; f < static_cast<int>(volume.frames().size()); ++f) {
    const auto start = Clock::now();
    renderer.add_frame(f, volume.frame(f));
    renderer.update();
    each_ms.push_back(to_milliseconds(Clock::now() - start));
  }
  return each_ms;
}

/// Sum over all passes; without reading the picture back.
double picture_ms(render::Renderer& renderer) {
  const auto passes = renderer.render().passes;
  return std::accumulate(passes.begin(), passes.end(), 0.0, [](double sum, const auto& pass) {
    return sum + pass.ms;
  });
}

/// One variant of the reference row, frame by frame.
Arrival measure_arrival(const hw::PolarVolume& volume,
                        const render::RenderOptions& options,
                        render::GlContext& context,
                        int repeats) {
  render::Renderer renderer(context, volume.plan(), options);
  std::vector<double> frames, volumes, views;
  render::ViewOptions front = options.view, turned = options.view;
  turned.yaw_rad += 10 * kDegree;
  for (int repeat = -1; repeat < repeats; ++repeat) {
    const auto each_ms = add_frames(renderer, volume);
    const double volume_ms = picture_ms(renderer);
    if (repeat < 0) continue;
    frames.insert(frames.end(), each_ms.begin(), each_ms.end());
    volumes.push_back(volume_ms);
    renderer.set_view(turned);
    views.push_back(picture_ms(renderer));
    renderer.set_view(front);
  }
  return {spread_of(frames), spread_of(volumes), spread_of(views)};
}

}  // namespace

std::int64_t PassFloor::total() const {
  std::int64_t all = 0;
  for (const auto& [kind, count] : fetches) all += count;
  return all;
}

std::string to_string(const render::TextureFetch& kind) {
  constexpr std::array kSamplers = {"sampler2D", "sampler3D", "sampler2DArray"};
  constexpr std::array kFormats = {
      "r8", "r16", "r32f", "rg8", "rg16", "rg32f", "rgba8", "rgba16", "rgb32f", "rgba32f"};
  constexpr std::array kFilters = {"nearest", "linear"};
  return std::string(kSamplers.at(static_cast<std::size_t>(kind.sampler))) + " " +
         kFormats.at(static_cast<std::size_t>(kind.format)) + " " +
         kFilters.at(static_cast<std::size_t>(kind.filter));
}

double power_of(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y.at(i));
    sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double pass_ms(const Timing& timing, const std::string& pass) {
  for (const PassTiming& candidate : timing.passes) {
    if (candidate.name == pass) return candidate.ms;
  }
  return 0;
}

std::optional<double> MeasuredRow::pass_speed_up(const std::string& pass) const {
  const double plain = pass_ms(timings.at(PipelineVariant::plain), pass);
  const double fast = pass_ms(timings.at(PipelineVariant::fast), pass);
  if (plain <= 0 || fast <= 0) return {};
  return plain / fast;
}

TableResults measure_tables(const TableVolumes& volumes,
                            const render::RenderOptions& base,
                            render::GlContext& context,
                            const TableRun& run,
                            const PartDone& done) {
  TableResults results;
  const hw::PolarVolume& volume = volumes.by_frames.at(reference_row().frames);
  results.frame_acquisition_ms =
      to_milliseconds(volume.plan().volume_duration()) / reference_row().frames;
  TimedSettings settings = make_settings(volumes, base, context, run);
  PartCount pictures(count_pictures(settings), done);
  for (int repeat = -1; repeat < std::max(run.repeats, run.plain_repeats); ++repeat) {
    for (auto& [key, setting] : settings) {
      if (repeat >= setting.repeats) continue;
      setting.measure(repeat);
      pictures.finish_one();
    }
  }
  for (const PaperTable& table : paper_tables()) {
    MeasuredTable measured{table, {}, {}};
    for (const TableRow& row : table.rows) {
      measured.rows.push_back(measured_row(row, table, settings));
    }
    measured.exponents = exponents_of(measured.rows);
    results.tables.push_back(std::move(measured));
  }
  results.reference = measured_row(reference_row(), paper_tables().front(), settings);
  settings.clear();
  const auto options = settings_of(reference_row(), base, run.divisor);
  results.floors =
      measure_floors(volume,
                     {{PipelineVariant::plain, rendered(PipelineVariant::plain, options)},
                      {PipelineVariant::fast, rendered(PipelineVariant::fast, options)}},
                     context);
  for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
    results.arrivals[variant] =
        measure_arrival(volume, rendered(variant, options), context, run.repeats_of(variant));
  }
  results.stages = measure_stages(volumes, context, run);
  return results;
}

}  // namespace wobblebench::bench
