// Labels of a truth as maps, as a picture that can be read, as a table and in report.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "bench/evaluation/truth/labels.h"
#include "bench/output/document/table.h"
#include "bench/output/picture/panels.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// Numbers of pixels for a file.
struct LabelMaps {
  Image<float> part;     ///< label of what the pixel shows; 0: nothing
  Image<float> before;   ///< label of what is before it on the way of the sound; 0: nothing
  Image<float> visible;  ///< 1: the probe sees it, with nothing before it
};
LabelMaps label_maps(const Truth& truth, const Labels& labels);

/// The colour of a label; each of part_names() has one of its own.
std::uint32_t label_colour(std::uint8_t label);

/// Parts in colours with landmarks, and what the probe sees of them.
std::vector<Panel> label_panels(const Truth& truth,
                                const Labels& labels,
                                const render::Camera& camera);

/// One row for each label: its number, name, and pixels.
Table label_table(const Truth& truth, const Labels& labels);
/// One row for each landmark: position in the probe frame, place in the picture, visibility.
Table landmark_table(const Labels& labels);

/// {parts[], landmarks[]}: the rows of both tables.
nlohmann::ordered_json labels_json(const Truth& truth, const Labels& labels);

}  // namespace wobblebench::bench
