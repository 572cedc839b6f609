// The GL state of the current context, as a host would query it.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace wobblebench::render::testing {

/// Values by name, and by index where the state has one.
using GlState = std::map<std::string, std::vector<double>>;

GlState gl_state();

/// Names of what differs.
std::vector<std::string> difference(const GlState& before, const GlState& after);

}  // namespace wobblebench::render::testing
