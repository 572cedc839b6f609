// Files of the live page.
#pragma once

#include <string_view>

namespace wobblebench::bench {

/// live.html, page.css, live.css or live.js; empty for other names.
std::string_view live_asset(std::string_view file);

}  // namespace wobblebench::bench
