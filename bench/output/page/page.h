// report.html: one file that shows a document without a network. Scripts and styles are inside it,
// and its Content-Security-Policy lets nothing else run or load.
#pragma once

#include <functional>
#include <string>

#include "bench/output/document/document.h"

namespace wobblebench::bench {

/// Reads a file of the command: its bytes.
using ReadPicture = std::function<std::string(const std::string& file)>;

/// The page of a document. Everything from outside (names, paths, texts) is shown as text.
std::string html(const Document& document, const ReadPicture& read_picture);

/// Whether this build can draw charts in pages (WOBBLEBENCH_PAGES). If not, the page says so and
/// names the files of their specifications.
bool pages_have_charts();

/// base64 (RFC 4648).
std::string base64(const std::string& bytes);

}  // namespace wobblebench::bench
