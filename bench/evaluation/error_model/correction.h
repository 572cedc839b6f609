// The detection-error model as a file that `fit` writes and `run` applies (render.correction).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "bench/evaluation/error_model/detection_model.h"
#include "bench/scene/scene.h"
#include "render/renderer.h"

namespace wobblebench::bench {

/// Dotted keys of a scene with their values as JSON.
using CorrectionConditions = std::map<std::string, std::string>;

/// What a correction depends on: probe, scan, display scale, and the render settings that decide
/// where a surface is found. Not the phantom, the view, the picture's size, light, or volume of
/// interest.
CorrectionConditions correction_conditions(const Scene& scene);

struct Correction {
  DetectionModel model;
  CorrectionConditions made_for;  ///< correction_conditions() of the scene that it was fitted in
  double step_mm = 0;             ///< of the rays there
};

/// The text of correction.json.
std::string correction_text(const Correction& correction);

/// Reads render.correction of a scene; none where it is empty. Throws UserError, in one line that
/// names file, key and both values, for a file that is no correction, and for one that was made for
/// another probe, scan, detector, n or number of steps. `knows_scan`: false where probe, scan and
/// display scale are those of a recording or a card: check_correction() alone compares them.
std::optional<Correction> read_correction(const Scene& scene, bool knows_scan = true);

/// The same for a scene that is resolved: for plan and display scale of its board, and for the
/// length of a step, which follows from the volume of interest and may differ by 10 %.
void check_correction(const Correction& correction, const Scene& scene);

/// z less the model's bias, pixel by pixel, from measured quantities alone: normals of z after pass
/// 3's filter, range, and the sticks about the point. Without terms the same bits.
Image<float> corrected_depth(const DetectionModel& model,
                             const TermMeter& meter,
                             const render::CastDepth& depth,
                             const hw::PolarVolume& volume);

/// What `renderer` shows, of this volume, rendered once more with corrected z: RenderTaps::depth is
/// corrected_depth(), whose time is the pass `correction`. Pass 1 is not done again: its time is
/// that of `uncorrected`, the picture without. Replaces the renderer's taps and leaves it without
/// any.
render::Picture corrected_picture(const Correction& correction,
                                  render::Renderer& renderer,
                                  const render::Picture& uncorrected,
                                  const hw::PolarVolume& volume,
                                  const Scene& scene);

}  // namespace wobblebench::bench
