// What `compare` compares: a program with settings, or figures that were kept.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "bench/studies/compare/run_figures.h"

namespace wobblebench::bench {

/// A scene of a comparison: a TOML file, or the defaults.
struct ComparedScene {
  std::string name;            ///< the file's without ".toml", or "default"
  std::filesystem::path file;  ///< empty: the defaults
};

/// Throws UserError where two scenes have one name.
std::vector<ComparedScene> compared_scenes(const std::vector<std::string>& files);

/// The pictures of a scene's first seed: bytes of PNG files, empty where there are none.
struct KeptPictures {
  std::string surface, error;
  Image<glm::vec3> shown = {};  ///< the surface's values, of 0 to 1
};

/// A program that makes runs.
struct ProgramSide {
  std::filesystem::path program;
  std::vector<std::string> settings;  ///< section.key=value
  bool counts_work = true;            ///< `run` has --count-work
};

/// One side as the command line names it.
struct ComparedSide {
  std::string text;
  std::optional<ProgramSide> program;  ///< nullopt: kept
  MeasuredSide measured;         ///< of a kept side: whole; else what has been measured so far
  std::filesystem::path folder;  ///< of a kept side
};

/// `text`: "this" for the running program, a program's file, or a folder with report.json of
/// `compare` (its new side) or `run`. `option`: BASE or NEW, for refusals. `settings` are those of
/// both sides, which concern a program alone; a folder with `own` is refused. Throws UserError.
ComparedSide parse_side(const std::string& option,
                        const std::string& text,
                        std::vector<std::string> settings,
                        const std::vector<std::string>& own);

/// One run of the side, added to what is measured. Returns its pictures. Throws UserError where the
/// program refuses the scene, and std::runtime_error where it fails.
KeptPictures measure(ComparedSide& side, const ComparedScene& scene, std::uint64_t seed);

/// The name of a picture's file in the folder of `compare`: "new_default_surface.png".
std::string compared_picture(const std::string& side,
                             const std::string& scene,
                             const std::string& kind);

/// The pictures of a kept side.
KeptPictures kept_pictures(const ComparedSide& side, const ComparedScene& scene);

/// Sets kPictureSsim of both sides' runs of the scene and seed: 1 of the base; of the new side none
/// where its picture has another size. Of neither where one has no picture, nor of other seeds.
void add_likeness(MeasuredSide& base,
                  const KeptPictures& of_base,
                  MeasuredSide& now,
                  const KeptPictures& of_now,
                  const std::string& scene,
                  std::uint64_t seed);

}  // namespace wobblebench::bench
