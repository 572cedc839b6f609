// Whether what a command was asked to hold does hold: one struct for report.json, the page, stderr,
// the exit code and JUnit's XML.
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace wobblebench::bench {

struct Check {
  std::string group;         ///< in JUnit's XML: "limits"
  std::string name;          ///< "p95_mm<=2"
  std::string failure = {};  ///< why it does not hold, one line; empty: it holds, or was skipped
  std::string skipped = {};  ///< why it was not made; empty: it was made
  std::string output = {};   ///< what was found, for people
  std::string asked = {};    ///< the option that asks for it: "--limit p95_mm<=2"; empty: none does
  double limit = std::numeric_limits<double>::quiet_NaN();  ///< NaN: it has none
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not formed, or no number

  /// For stderr: "--limit p95_mm<=2: p95_mm is 2.4".
  std::string line() const { return (asked.empty() ? "" : asked + ": ") + failure; }
};

/// "checks" of report.json: name, asked, limit, value, held (null: skipped), because.
nlohmann::ordered_json to_json(const std::vector<Check>& checks);
/// What was asked and does not hold, then what holds, as Markdown for the head of a page; empty:
/// nothing was asked.
std::string verdict_text(const std::vector<Check>& checks);

}  // namespace wobblebench::bench
