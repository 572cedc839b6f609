// Settings of a renderer by the keys that scenes have for them.
#pragma once

#include <string>

#include "render/options.h"

namespace wobblebench::render::testing {

/// Sets options: "view.yaw_deg=70 ray_casting.transfer_grey=1,0.2,0.7". Throws
/// std::invalid_argument of what is no key or no value.
void set(RenderOptions& options, const std::string& settings);

}  // namespace wobblebench::render::testing
