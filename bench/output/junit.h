// JUnit's XML, in which continuous integration shows the checks of a command.
#pragma once

#include <string>
#include <vector>

#include "bench/results/check.h"

namespace wobblebench::bench {

/// The text of a file: one suite, named `suite`, with a test case a check. Characters that XML
/// cannot hold, and bytes that are no UTF-8, become U+FFFD.
std::string junit_xml(const std::string& suite, const std::vector<Check>& cases);

}  // namespace wobblebench::bench
