// What is said of a scene where a picture may not be what was meant (Progress::warn).
#pragma once

#include <string>
#include <vector>

#include "bench/output/progress.h"
#include "bench/scene/idle_options.h"

namespace wobblebench::bench {

/// A correction for the beam's width that was determined for another probe, receiver or rung, and a
/// single frame, which fills its fan.
std::vector<std::string> scene_warnings(const Scene& scene, SampleSource source);
/// Warns of those, and of options that were given and are without effect.
void warn_of_scene(const Scene& scene, SampleSource source, Progress& progress);
/// The same for the simulated scenes of a study: each text once, and the options that are without
/// effect in all scenes that were given them.
void warn_of_scenes(const std::vector<Scene>& scenes, Progress& progress);
/// For commands that scan, and render nothing. Warns of options that are without effect: of those
/// of the scan where a simulated probe makes the sticks, else of all.
void warn_of_scan(const Scene& scene, bool is_simulated, Progress& progress);
/// Warns of those options that a command does not use: of the sections that begin with one of
/// `sections`; none: of all. `acts_with`: what would use them.
void warn_of_unused(const Scene& scene,
                    const std::vector<std::string>& sections,
                    const std::string& acts_with,
                    Progress& progress);

}  // namespace wobblebench::bench
