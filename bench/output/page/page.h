// report.html: one file that shows a document without a network. Scripts and styles are inside it,
// and its Content-Security-Policy lets nothing else run or load.
#pragma once

#include <functional>
#include <string>

#include "bench/output/document/document.h"

namespace wobblebench::bench {

/// Reads a picture of the command: the bytes of its PNG, or of a JPEG of lower quality, which the
/// page then says.
using ReadPicture = std::function<std::string(const std::string& file)>;

/// The page of a document. Everything in it is shown as text, never read as markup. Where the build
/// has no charts (WOBBLEBENCH_PAGES), it names the files of their specifications instead.
std::string html(const Document& document, const ReadPicture& read_picture);

}  // namespace wobblebench::bench
