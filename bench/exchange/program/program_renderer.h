// Pictures whose surface another program finds: it gets a volume and a view, and answers with a
// depth map (docs/score.md).
#pragma once

#include <memory>
#include <string>

#include "bench/exchange/program/renderer_process.h"
#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

struct PictureOptions;

/// render.program of a scene, and what belongs to it.
struct ProgramSetting {
  std::string name;  ///< empty: none, our own renderer
  double voxel_m = 0;
  double timeout_s = 0;

  bool any() const { return !name.empty(); }
  friend bool operator==(const ProgramSetting&, const ProgramSetting&) = default;
};
ProgramSetting program_setting(const PictureOptions& options);
/// Throws UserError for a program that --renderer does not define.
void check_program(const PictureOptions& options);

/// One program, which is started once and renders any number of volumes of one plan.
class ProgramRenderer {
 public:
  /// Throws UserError for a name that --renderer does not define; std::runtime_error.
  explicit ProgramRenderer(const ProgramSetting& setting);

  /// depth_m is the program's answer. Passes 3 and 4 are ours, on the CPU. The passes are
  /// `exchange`, writing the volume and reading the depths, and `program`, from the request to the
  /// answer, in which the program reads and writes these files. Throws std::runtime_error
  /// "render.program = NAME: …" for a program that ends, or gives no, or another, answer.
  render::Picture render(const hw::PolarVolume& volume, const render::RenderOptions& options);

  const ProgramSetting& setting() const { return setting_; }

 private:
  ProgramSetting setting_;
  RendererProcess process_;
};

}  // namespace wobblebench::bench
