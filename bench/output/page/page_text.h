// Text as HTML: nothing that comes from outside is read as markup.
#pragma once

#include <string>
#include <string_view>

namespace wobblebench::bench {

/// With &, <, >, " and ' as character references; bytes that are no UTF-8, and control characters
/// but tab and newline, as U+FFFD.
std::string escaped(std::string_view text);

/// The subset of Markdown that Text (document.h) names, as <p> and <ul>. Links that are neither
/// relative nor https are shown as their text.
std::string html_of_markdown(std::string_view markdown);

/// Of [a-z0-9-], for an attribute `id`.
std::string slug(std::string_view text);

/// base64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace wobblebench::bench
