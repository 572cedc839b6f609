// What the live page may set: options of the scene with their kind, unit and range.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// A list of sections, each with its controls in the order of describe(): key, kind (number,
/// integer, flag, choice, list), min and max in the key's unit, names of a choice, length of a
/// list that has one. Texts are left out, because they name files and programs; of them only
/// phantom.name is there, as a choice of the built-in phantoms. `with_scan`: with the sections of
/// what a simulated probe scans, else only those of the renderer.
nlohmann::ordered_json controls_json(const Scene& scene, bool with_scan);

/// The settings of `scene` that a page may change are those of controls_json(). Throws UserError
/// "--set SETTING: …" for any other key.
void check_control(const std::string& setting, bool with_scan);

}  // namespace wobblebench::bench
