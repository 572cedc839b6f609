// A scene as it is scanned and rendered: with all that its file leaves open.
#pragma once

#include <optional>
#include <string>

#include "bench/scene/scene.h"
#include "hw/wire/configuration.h"
#include "phantoms/placed_phantom.h"
#include "render/view.h"

namespace wobblebench::bench {

/// Every option with its value, the acquisition plan, the phantom at its place, and the view.
/// Made by resolve_scene(); nothing in it changes afterwards.
///
/// @code
/// #include <cstdio>
///
/// const bench::Scene given = bench::load_scene({}, {"phantom.name=sphere"});
/// const bench::ResolvedScene scene =
///     bench::resolve_scene(given, phantoms::make_phantom(given.phantom));
/// std::printf("centre %g mm in front of the probe\n",
///             1e3 * scene.subject()->placement.position_m.z);
/// @endcode
class ResolvedScene {
 public:
  /// `options` leave nothing open. `subject`: what they show, nullopt where that is not known. A
  /// study that scans another subject than its options say gives both. Throws InvalidOption.
  ResolvedScene(Scene options, std::optional<phantoms::PlacedPhantom> subject);

  const Scene& options() const { return options_; }
  const sim::SimulationOptions& simulation() const { return options_.simulation; }
  const render::RenderOptions& render() const { return options_.render; }
  const hw::AcquisitionPlan& plan() const { return plan_; }
  const render::View& view() const { return view_; }
  /// nullopt: nobody knows what the samples are of.
  const std::optional<phantoms::PlacedPhantom>& subject() const { return subject_; }
  /// What they show is known, and moves.
  bool moves() const { return subject_ && !subject_->motion.still(); }

 private:
  Scene options_;
  hw::AcquisitionPlan plan_;
  render::View view_;
  std::optional<phantoms::PlacedPhantom> subject_;
};

/// Fills in what the scene leaves open. With a phantom: position and volume of interest as the
/// phantom suggests. Without one, for samples whose subject is not known: the volume of interest is
/// the box around the scanned sector. Throws UserError for a motion that this phantom cannot make.
ResolvedScene resolve_scene(Scene scene, const std::optional<phantoms::Phantom>& phantom);

/// The scene with the probe and acquisition of a recording or a card, `source` in refusals. Throws
/// UserError "SECTION.KEY = VALUE: SOURCE delivers OTHER" for a key that the user set to another
/// value, and where the machine has too little memory.
Scene with_plan(const Scene& scene, const hw::AcquisitionPlan& plan, const std::string& source);

/// The scene with the display scale that a stream states; as it is where the stream states none. A
/// dynamic range that the user gave stays: linear envelopes are displayed over it.
Scene with_display_scale(Scene scene, const hw::DisplayScale& scale);

}  // namespace wobblebench::bench
