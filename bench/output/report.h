// report.json: the document that every command writes. Names are kept; every figure carries its
// unit in its key (docs/architecture.md).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/evaluation/registration/registration.h"
#include "bench/output/report_parts.h"
#include "bench/scene/scene.h"
#include "render/picture.h"

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

/// The scene with all its options; null: not framed yet.
Json scene_json(const Scene& scene);

/// The head: schema, command, provenance with the scene's seed, scene as resolved, no effects yet.
Json report_head(const std::string& command, Provenance provenance, const Scene& scene);

/// The sum over the passes.
double frame_ms(const std::vector<render::PassTime>& passes);
Json render_json(const std::vector<render::PassTime>& passes, render::PipelineMode mode);
Json registration_json(const Registration& registration);
/// What the phantom measures on its finished surfaces, and what was aimed at (null: nothing); null
/// where nothing was measured.
Json measures_json(const phantoms::Phantom& phantom);

}  // namespace wobblebench::bench
