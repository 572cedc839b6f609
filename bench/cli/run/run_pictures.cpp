#include "bench/cli/run/run_pictures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/parallel.h"
#include "base/units.h"
#include "bench/output/error_report.h"
#include "bench/output/image_io.h"
#include "bench/output/picture/error_picture.h"
#include "bench/output/picture/label_picture.h"
#include "bench/output/picture/scan_plane.h"

namespace wobblebench::bench {

namespace {

constexpr int kSheetSide = 360;  // pixels of a panel of sheet.png
constexpr int kLeastSide = 384;  // of error.png's panel, so that its names and numbers have room
constexpr int kMostSide = 1024;
constexpr double kMostFalseShare = 0.05;  // of a picture without a true surface

/// Width of a panel in which pixels stay squares of whole pixels, where they are not too many.
int panel_side(int size) {
  return size > kMostSide ? kMostSide : size * ((kLeastSide + size - 1) / size);
}

bool finds_surface(const PictureResult& result) {
  return std::ranges::any_of(result.picture.depth_m.pixels,
                             [](float depth_m) { return !std::isnan(depth_m); });
}

Panel surface_panel(const PictureResult& result, const ResolvedScene& scene) {
  const auto why = why_no_surface_picture(result, scene);
  return {"surface", why.empty() ? encoded(result.picture.surface) : Picture3(), why};
}

Panel truth_panel(const PictureResult& result) {
  if (!result.comparison) return {"truth", {}, "The truth is not known."};
  const Picture3& truth = result.comparison->shaded_truth;
  if (truth.pixels.empty()) return {"truth", {}, "The picture is too small to be shaded."};
  if (!result.comparison->error.raw.surface_in_view()) {
    return {
        "truth", {}, "No surface in view: " + why_no_surface(result.comparison->error.raw) + "."};
  }
  return {"truth, shaded alike", encoded(truth)};
}

Panel run_error_panel(const PictureResult& result, const ResolvedScene& scene) {
  const auto why = why_no_error_picture(result, scene);
  if (!why.empty()) return {"signed error", {}, why};
  return error_panel(result.comparison->error.raw.map_m,
                     pixel_classes(result.picture, result.comparison->truth),
                     kErrorLimit_mm,
                     scene.view().camera.pixel_m() / kMillimetre);
}

Panel volume_panel(const PictureResult& result, const ResolvedScene& scene) {
  if (scene.render().ray_casting.mode == render::RenderMode::surface) {
    return {"volume", {}, "Mode \"surface\" blends no volume picture."};
  }
  return {"volume", shown_volume(result.picture.volume)};
}

constexpr int kPlaneSide = 440;
constexpr std::uint32_t kTrueLine = 0x4cc3ff, kFoundLine = 0xffa21f;

/// Echoes in a plane, and where the surfaces of the picture cut it.
Panel plane_panel(const std::string& title,
                  const ScanPlane& plane,
                  const RunResult& result,
                  const ResolvedScene& scene) {
  Panel panel{.title = title,
              .picture = coloured(scan_converted(result.acquisition.volume, plane),
                                  0,
                                  1,
                                  black_to_white,
                                  display_colour(kNothing)),
              .mm_per_pixel = plane.pixel_m / kMillimetre};
  const auto add =
      [&](const char* name, std::uint32_t rgb, const Image<float>& depth_m, double width) {
        panel.lines.push_back({{display_colour(rgb), name},
                               surface_in_plane(depth_m, scene.view().camera, plane),
                               width});
      };
  if (result.comparison) {
    const Truth& truth = result.comparison->truth;
    add("true surface",
        kTrueLine,
        truth.crossing_m.pixels.empty() ? truth.depth_m : truth.crossing_m,
        3);
  }
  if (computes_surface(scene)) add("found surface", kFoundLine, result.picture.depth_m, 1.3);
  return panel;
}

Picture3 planes_picture(const RunResult& result, const ResolvedScene& scene) {
  const hw::AcquisitionPlan& plan = scene.plan();
  const int frame = plan.acquisition().frames_per_volume / 2;
  return draw_panels(
      {plane_panel("frame " + std::to_string(frame) + ", the middle one",
                   frame_plane(plan, frame, kPlaneSide),
                   result,
                   scene),
       plane_panel(
           "plane across the frames, x = 0", plane_across_frames(plan, kPlaneSide), result, scene)},
      kPlaneSide);
}

/// A file of a result, and what makes its bytes.
struct Job {
  std::string name;
  std::function<std::vector<char>()> encode;
};

void add_maps(const PictureResult& result, const render::Camera& camera, std::vector<Job>& jobs) {
  const render::Picture& picture = result.picture;
  jobs.push_back({"depth.exr", [&] { return depth_exr(picture, camera); }});
  if (!result.comparison) return;
  const Comparison& comparison = *result.comparison;
  jobs.push_back({"truth_depth.exr", [&] {
                    const Truth& truth = comparison.truth;
                    const auto reason = converted<float>(truth.kind);
                    return exr_mm({{"Z", &truth.depth_m},
                                   {"Z_crossing", &truth.crossing_m},
                                   {"truth_reason", &reason, 1}},
                                  camera);
                  }});
  jobs.push_back({"error_depth.exr", [&] {
                    return exr_mm({{"Z", &comparison.error.raw.map_m}}, camera);
                  }});
}

/// Labels as numbers, and as a picture.
void add_labels(const PictureResult& result, const render::Camera& camera, std::vector<Job>& jobs) {
  if (!result.comparison || !result.comparison->labels) return;
  const Truth& truth = result.comparison->truth;
  const Labels& labels = *result.comparison->labels;
  jobs.push_back({"labels.exr", [&] {
                    const LabelMaps maps = label_maps(truth, labels);
                    std::vector<NamedMap> channels = {{"part", &maps.part, 1},
                                                      {"before", &maps.before, 1},
                                                      {"visible", &maps.visible, 1}};
                    const auto drawn = converted<float>(result.picture.drawn);
                    if (!drawn.pixels.empty()) channels.push_back({"drawn", &drawn, 1});
                    return exr_mm(channels, camera);
                  }});
  jobs.push_back({"labels.png", [&] {
                    return png(draw_panels(label_panels(truth, labels, camera),
                                           panel_side(camera.image_size)));
                  }});
}

void add_pictures(const PictureResult& result, const ResolvedScene& scene, std::vector<Job>& jobs) {
  const render::Camera& camera = scene.view().camera;
  const int side = panel_side(camera.image_size);
  jobs.push_back({"error.png",
                  [&, side] { return png(draw_panels({run_error_panel(result, scene)}, side)); }});
  jobs.push_back({"surface.png", [&] { return png(result.picture.surface, Values::light); }});
  if (!result.comparison) return;
  jobs.push_back(
      {"truth_reason.png", [&, side] {
         return png(draw_panels(
             {reason_panel(result.comparison->truth, camera.pixel_m() / kMillimetre)}, side));
       }});
  if (!has_true_picture(result)) return;
  jobs.push_back(
      {"truth.png", [&] { return png(result.comparison->shaded_truth, Values::light); }});
}

/// Beside the picture of a volume: its echoes, and all side by side.
void add_volume_pictures(const RunResult& result,
                         const ResolvedScene& scene,
                         std::vector<Job>& jobs) {
  jobs.push_back({"sheet.png", [&] {
                    return png(draw_panels({surface_panel(result, scene),
                                            truth_panel(result),
                                            run_error_panel(result, scene),
                                            volume_panel(result, scene)},
                                           kSheetSide));
                  }});
  jobs.push_back({"planes.png", [&] { return png(planes_picture(result, scene)); }});
  jobs.push_back({"volume.png", [&] { return png(shown_volume(result.picture.volume)); }});
}

/// Encoded on all threads, and written on this one (OutputFolder).
void stage(OutputFolder& out, const std::vector<Job>& jobs) {
  std::vector<std::vector<char>> bytes(jobs.size());
  parallel_rows(static_cast<int>(jobs.size()), [&](int i) {
    const auto slot = static_cast<std::size_t>(i);
    bytes[slot] = jobs[slot].encode();
  });
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    write_new_file(out.stage(jobs[i].name), {bytes[i].data(), bytes[i].size()});
  }
}

}  // namespace

std::string why_no_surface_picture(const PictureResult& result, const ResolvedScene& scene) {
  if (!computes_surface(scene)) return "Mode \"volume\" computes no surface.";
  if (!finds_surface(result)) return "No ray met a surface.";
  if (!result.comparison) return "";
  const DepthError& error = result.comparison->error.raw;
  if (error.surface_in_view() || error.outside_field + error.grazing + error.shadowed > 0)
    return "";
  if (error.false_surface < kMostFalseShare * error.pixels) return "";
  return "No surface in view: what was found is speckle and noise.";
}

std::string why_no_error_picture(const PictureResult& result, const ResolvedScene& scene) {
  if (!result.comparison) return "No error: the truth is not known.";
  if (!computes_surface(scene)) return "No error: mode \"volume\" computes no surface.";
  const DepthError& error = result.comparison->error.raw;
  if (error.surface_in_view()) return "";
  return "No error: no surface is in view. Why: " + why_no_surface(error) + ".";
}

Picture3 shown_volume(const Picture3& volume) {
  std::vector<float> levels;
  levels.reserve(volume.pixels.size());
  for (const glm::vec3& pixel : volume.pixels) levels.push_back(pixel.r);
  const auto rank = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() * 995 / 1000);
  std::nth_element(levels.begin(), rank, levels.end());
  const auto white = std::max(static_cast<double>(*rank), 0.05);
  Picture3 shown(volume.width, volume.height);
  std::ranges::transform(volume.pixels, shown.pixels.begin(), [&](const glm::vec3& pixel) {
    return warm(std::pow(std::min(1.0, static_cast<double>(pixel.r) / white), 1.8));
  });
  return shown;
}

bool has_true_picture(const PictureResult& result) {
  const auto& comparison = result.comparison;
  return comparison && comparison->error.raw.surface_in_view() &&
         !comparison->shaded_truth.pixels.empty();
}

void stage_run_images(OutputFolder& out, const RunResult& result, const ResolvedScene& scene) {
  std::vector<Job> jobs;
  add_volume_pictures(result, scene, jobs);
  add_pictures(result, scene, jobs);
  add_maps(result, scene.view().camera, jobs);
  add_labels(result, scene.view().camera, jobs);
  stage(out, jobs);
}

void stage_score_images(OutputFolder& out,
                        const PictureResult& result,
                        const ResolvedScene& scene) {
  std::vector<Job> jobs;
  jobs.push_back(
      {"sheet.png", [&] {
         return png(draw_panels(
             {surface_panel(result, scene), truth_panel(result), run_error_panel(result, scene)},
             kSheetSide));
       }});
  add_pictures(result, scene, jobs);
  add_maps(result, scene.view().camera, jobs);
  stage(out, jobs);
}

}  // namespace wobblebench::bench
