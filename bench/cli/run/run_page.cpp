#include "bench/cli/run/run_page.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/cli/board_report.h"
#include "bench/cli/run/run_pictures.h"
#include "bench/output/document/figures_table.h"
#include "bench/output/error_report.h"
#include "bench/output/picture/label_picture.h"
#include "bench/output/picture/map_codes.h"
#include "bench/output/report.h"
#include "bench/results/error.h"
#include "bench/studies/tables/paper.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostMapSide = 512;  // so that a page of a large picture stays below 3 MB

double mm(double metres) {
  return metres / kMillimetre;
}

// ---- pictures

void add_surfaces(const PictureResult& result, const ResolvedScene& scene, Document& page) {
  page.add(Heading{"Found and true surface"});
  const std::string why = why_no_surface_picture(result, scene);
  if (!why.empty()) {
    page.add(Text{why});
    return;
  }
  const Picture found{"surface.png", "The surface that was found."};
  if (!has_true_picture(result)) {
    page.add(found);
    return;
  }
  page.add(PicturePair{found, {"truth.png", "The true surface, shaded alike."}});
}

void add_volume(const ResolvedScene& scene, Document& page) {
  if (scene.render().ray_casting.mode == render::RenderMode::surface) return;
  page.add(Heading{"Volume"});
  page.add(Picture{"volume.png", "The echoes, blended along the rays of the same view."});
}

void add_planes(const PictureResult& result, Document& page) {
  page.add(Heading{"Echoes in two planes"});
  page.add(Picture{"planes.png",
                   result.comparison
                       ? "Samples of the sticks, and where the planes cut the true surface (blue) "
                         "and the found one (orange), as far as the picture's rays meet them."
                       : "Samples of the sticks, and where the planes cut the found surface "
                         "(orange)."});
}

std::string map_caption(int every, bool perspective) {
  std::string text = "Values of the pixel under the pointer, or of the one that arrow keys choose.";
  if (every > 1) {
    text += " Of the picture every " + std::to_string(every) + "th row and column.";
  }
  if (perspective) text += " The bar is 10 mm long at the depth of the box's centre.";
  return text;
}

MapView map_of(const PictureResult& result, const ResolvedScene& scene) {
  const Image<float>& found_m = result.picture.depth_m;
  const render::Camera& camera = scene.view().camera;
  const int every = (found_m.width + kMostMapSide - 1) / kMostMapSide;
  MapView map{.name = "depth",
              .caption = map_caption(every, camera.projection == render::Projection::perspective),
              .width = (found_m.width + every - 1) / every,
              .height = (found_m.height + every - 1) / every,
              .mm_per_pixel = every * mm(camera.pixel_m()),
              .layers = {}};
  if (const auto& comparison = result.comparison) {
    map.layers.push_back(
        error_layer("signed error", thinned(comparison->error.raw.map_m, every), kErrorLimit_mm));
    for (const PixelClassName& name : pixel_class_names()) {
      map.classes.push_back({static_cast<int>(name.of), name.name, html_colour(name.rgb)});
    }
    map.class_codes = class_codes(thinned(pixel_classes(result.picture, comparison->truth), every));
  }
  map.layers.push_back(length_layer("found depth", thinned(found_m, every)));
  if (const auto& comparison = result.comparison) {
    map.layers.push_back(length_layer("true depth", thinned(comparison->truth.depth_m, every)));
  }
  return map;
}

void add_map(const PictureResult& result, const ResolvedScene& scene, Document& page) {
  page.add(Heading{result.comparison ? "Depth error" : "Depth"});
  if (!computes_surface(scene)) {
    page.add(Text{why_no_error_picture(result, scene)});
    return;
  }
  const std::string why = why_no_error_picture(result, scene);
  if (!why.empty()) page.add(Text{why});
  const bool is_empty = !why.empty() && !why_no_surface_picture(result, scene).empty();
  if (!is_empty) page.add(map_of(result, scene));
}

// ---- errors

std::vector<double> errors_mm(const Image<float>& error_m) {
  std::vector<double> errors;
  for (const float error : error_m.pixels) {
    if (!std::isnan(error)) errors.push_back(mm(static_cast<double>(error)));
  }
  std::ranges::sort(errors);
  return errors;
}

double percent_below(const std::vector<double>& sorted, double value) {
  const auto below = std::ranges::lower_bound(sorted, value) - sorted.begin();
  return 100.0 * static_cast<double>(below) / static_cast<double>(sorted.size());
}

Chart histogram(const std::vector<double>& sorted) {
  constexpr double kBin_mm = 0.1;
  constexpr int kBins = 60;
  Chart chart{"Signed error",
              {.label = "found minus true depth (mm)"},
              {.label = "pixels in 0.1 mm (%)", .low = 0}};
  Series bars{.name = ""};
  for (int i = 0; i < kBins && !sorted.empty(); ++i) {
    const double low = kBin_mm * (i - 0.5 * kBins), high = kBin_mm * (i + 1 - 0.5 * kBins);
    const double share = percent_below(sorted, high) - percent_below(sorted, low);
    bars.add(low, share);
    bars.add(high, share);
  }
  chart.series.push_back(std::move(bars));
  return chart;
}

Chart cumulative(std::vector<double> errors) {
  constexpr double kStep_mm = 0.05;
  constexpr int kSteps = 100;
  for (double& error : errors) error = std::abs(error);
  std::ranges::sort(errors);
  Chart chart{"Magnitude",
              {.label = "magnitude of the error (mm)"},
              {.label = "pixels below it (%)", .low = 0, .high = 100}};
  Series share{.name = ""};
  for (int i = 0; i <= kSteps && !errors.empty(); ++i) {
    share.add(kStep_mm * i, percent_below(errors, kStep_mm * i));
  }
  chart.series.push_back(std::move(share));
  return chart;
}

Table depth_table(const PictureMeasures& error) {
  static constexpr const Measure* kShown[] = {&error::kBias,
                                              &error::kRms,
                                              &error::kMedian,
                                              &error::kP95,
                                              &error::kMax,
                                              &error::kOutliers,
                                              &error::kPixels};
  Table table{.name = "depth_error",
              .caption = "Signed error of depth; P95 and the greatest of its magnitude",
              .columns = columns_of({{"of", "depth"}}, kShown)};
  table.add(cells_of({"found"}, described(error.raw.depth), kShown));
  table.add(cells_of({"filtered for shading"}, described(error.filtered.depth), kShown));
  return table;
}

Table region_table(const PictureMeasures& error) {
  static constexpr const Measure* kShown[] = {&error::kSurface,
                                              &error::kBias,
                                              &error::kRms,
                                              &error::kMedian,
                                              &error::kP95,
                                              &error::kMissedSurface,
                                              &error::kFalse,
                                              &error::kNormalMedian,
                                              &error::kPixels};
  Table table{.name = "regions",
              .caption = "Errors by region of the picture",
              .columns = columns_of({{"group"}, {"region"}}, kShown)};
  for (const RegionError& region : error.regions) {
    table.add(
        cells_of({region.group, region.name}, described(region, error, ExpectedSurface()), kShown));
  }
  return table;
}

Figure region_figure(const PictureMeasures& error) {
  Figure figure{.name = "regions",
                .caption =
                    "P95 of the magnitude of the error by angle of incidence of the stick, "
                    "by range along it, and by part of the phantom.",
                .panels = {}};
  for (const auto& [group, title] : {std::pair{"incidence", "By incidence, degrees"},
                                     std::pair{"range", "By range, mm"},
                                     std::pair{"face", "By part of the face"},
                                     std::pair{"part", "By part"}}) {
    BarChart chart{.title = title, .label = "P95 of the magnitude (mm)"};
    BarPart part{.name = "P95"};
    for (const RegionError& region : error.regions) {
      if (region.group != group || region.depth.n == 0) continue;
      chart.rows.push_back(region.name);
      part.values.push_back(mm(region.depth.p95_m));
    }
    chart.parts.push_back(std::move(part));
    if (!chart.rows.empty()) figure.panels.emplace_back(std::move(chart));
  }
  return figure;
}

void add_errors(const PictureResult& result, const ResolvedScene& scene, Document& page) {
  if (!why_no_error_picture(result, scene).empty()) return;
  const PictureMeasures& error = result.comparison->error;
  page.add(error_figure(error.raw.map_m));
  page.add(depth_table(error));
  page.add(figures_table({.name = "picture", .caption = "Every figure of the picture"},
                         described(error, ExpectedSurface())));
  page.add(
      Picture{"truth_reason.png",
              "Why each pixel has a true surface or none: `truth_reason` of truth_depth.exr."});
  page.add(Heading{"Where errors are"});
  Figure regions = region_figure(error);
  if (!regions.panels.empty()) page.add(std::move(regions));
  page.add(region_table(error));
}

/// How far the picture is from the truth; where that is not known, that it is not.
void add_answer(const PictureResult& result, Document& page) {
  static constexpr const Measure* kAnswer[] = {
      &error::kP95, &error::kMedian, &error::kMissedSurface, &error::kFalse, &error::kNormalMedian};
  if (!result.comparison) {
    page.add(Text{"What the samples are of is not known: the picture is compared with nothing."});
  } else {
    page.add(key_figures(described(result.comparison->error, ExpectedSurface()), kAnswer));
  }
}

// ---- labels

void add_labels(const PictureResult& result, Document& page) {
  if (!result.comparison || !result.comparison->labels) return;
  const Truth& truth = result.comparison->truth;
  const Labels& labels = *result.comparison->labels;
  page.add(Heading{"Labels"});
  page.add(
      Picture{"labels.png",
              "The part of the phantom that each pixel shows, with its landmarks, and what the "
              "probe sees of it: `part`, `before` and `visible` of labels.exr."});
  page.add(label_table(truth, labels));
  if (labels.landmarks.empty()) return;
  page.add(landmark_table(labels));
  page.data.push_back({"landmarks.csv", landmark_table(labels)});
}

// ---- times and board

std::string settings_text(const ResolvedScene& scene) {
  const render::RenderOptions& render = scene.render();
  const render::RayCastingOptions& cast = render.ray_casting;
  const std::string kernel = std::to_string(cast.kernel_3d);
  return std::to_string(scene.plan().acquisition().frames_per_volume) + " frames, " +
         std::to_string(cast.image_size) + "² rays of " + std::to_string(cast.steps) +
         " steps, 3D kernel " + kernel + "³, filter of the picture " +
         std::to_string(render.smoothing.filter_size) + "²";
}

void add_times(const RunResult& result, const ResolvedScene& scene, Document& page) {
  Table table{
      .name = "passes",
      .caption = "Time of the passes of this picture",
      .columns = {{"pass"}, {"time_ms", "time", "ms", 1}, {"gpu_ms", "timer query", "ms", 1}}};
  const auto& passes = result.picture.passes;
  for (const render::PassTime& pass : passes) {
    table.add({pass.name, pass.ms, pass.gpu_ms < 0 ? Cell() : Cell(pass.gpu_ms)});
  }
  table.add({"all", frame_ms(passes), Cell()});
  table.add({"the paper's", reference_row().paper_ms, Cell()});
  page.add(Heading{"Times"});
  page.add(Text{"This picture: " + settings_text(scene) + ", on " + result.gl_renderer +
                ". The paper's time is that of all passes on the paper's GPU, for its " +
                reference_row().setting +
                " (its Tables I to IV); one picture is no measurement of speed, which "
                "`wobblebench tables` makes."});
  page.add(std::move(table));
}

void add_board(const RunResult& result, Document& page) {
  page.add(Heading{"Board"});
  page.add(board_table(result.acquisition.account));
}

}  // namespace

Figure error_figure(const Image<float>& error_m) {
  const std::vector<double> errors = errors_mm(error_m);
  return {.name = "errors",
          .caption =
              "How the pixels that show both surfaces spread over the error; those beyond "
              "3 mm are not in the histogram.",
          .panels = {histogram(errors), cumulative(errors)}};
}

Document run_document(const RunResult& result,
                      const ResolvedScene& scene,
                      const std::string& summary) {
  const bool known = scene.subject().has_value();
  Document page{.title = "wobblebench run: " +
                         (known ? scene.options().phantom.name : std::string("a recording"))};
  add_answer(result, page);
  add_surfaces(result, scene, page);
  page.add(Heading{"This run"}).add(Text{summary_list(summary)});
  add_map(result, scene, page);
  add_errors(result, scene, page);
  add_labels(result, page);
  add_volume(scene, page);
  add_planes(result, page);
  add_times(result, scene, page);
  add_board(result, page);
  return page;
}

Document score_document(const PictureResult& result,
                        const ResolvedScene& scene,
                        const std::string& summary) {
  Document page{.title = "wobblebench score: " + scene.options().phantom.name};
  add_answer(result, page);
  add_surfaces(result, scene, page);
  page.add(Heading{"This score"}).add(Text{summary_list(summary)});
  add_map(result, scene, page);
  add_errors(result, scene, page);
  return page;
}

}  // namespace wobblebench::bench
