// The pictures and maps of the command `run`.
#pragma once

#include <string>

#include "bench/cli/run/run_report.h"
#include "bench/output/output_folder.h"
#include "bench/output/picture/panels.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// Why a result has no surface to show: none was sought, none found, or nothing but speckle and
/// noise was. Empty: it has one.
std::string why_no_surface_picture(const PictureResult& result, const ResolvedScene& scene);

/// Why a result has no error to show; empty: it has one.
std::string why_no_error_picture(const PictureResult& result, const ResolvedScene& scene);

/// The volume picture as volume.png shows it: grey levels up to the brightest 0.5 %, with more
/// contrast among the bright ones, in warm tones. Display values.
Picture3 shown_volume(const Picture3& volume);

/// Whether there is a true surface to show beside the found one.
bool has_true_picture(const PictureResult& result);

/// Stages surface.png, volume.png, error.png, planes.png and sheet.png, where the truth is known
/// truth_reason.png, where a true surface is in view truth.png, and the depth maps, found and true,
/// in mm and with the camera; labels.png and labels.exr where there are labels.
void stage_run_images(OutputFolder& out, const RunResult& result, const ResolvedScene& scene);

/// The same of a picture whose volume is not there: without volume.png and planes.png.
void stage_score_images(OutputFolder& out, const PictureResult& result, const ResolvedScene& scene);

}  // namespace wobblebench::bench
