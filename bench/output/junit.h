// JUnit's XML, in which continuous integration shows the checks of a command.
#pragma once

#include <string>
#include <vector>

namespace wobblebench::bench {

/// A check and its outcome.
struct TestCase {
  std::string group;         ///< "limits"
  std::string name;          ///< "p95_mm<=2"
  std::string failure = {};  ///< why it failed, one line; empty: it passed, or was skipped
  std::string skipped = {};  ///< why it was not made; empty: it was made
  std::string output = {};   ///< what was measured, for people
};

/// The text of a file: one suite, named `suite`, with a test case a check. Characters that XML
/// cannot hold, and bytes that are no UTF-8, become U+FFFD.
std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases);

}  // namespace wobblebench::bench
