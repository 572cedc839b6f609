// Limits that a command's figures must keep, so that a script or continuous integration learns of
// it by the exit code.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace wobblebench::bench {

struct CommandResult;

/// At most this.
struct Limit {
  std::string name;  ///< of a figure, with its unit
  double most = 0;
};

/// "p95_mm<=2", with a number of 0 or more. Throws UserError "--limit = TEXT: what is allowed",
/// with `names` where the name is none of them.
Limit parse_limit(const std::string& text, const std::vector<std::string>& names);
std::vector<Limit> parse_limits(const std::vector<std::string>& texts,
                                const std::vector<std::string>& names);

/// --limit, with the names in its help.
void add_limit_option(CLI::App& command,
                      std::vector<std::string>& limits,
                      const std::vector<std::string>& names);

/// A figure that limits may name.
struct LimitedFigure {
  std::string name;
  double value = 0;          ///< NaN: not formed
  std::string because = {};  ///< why it is not formed, where that is known
};

/// Adds each limit to the result's checks and, for each that does not hold, a line to its failure
/// and exit code kFailed. The magnitude is compared, as a bias may be negative. A figure that is
/// not formed keeps no limit. `figures` has all names that were allowed.
void check_limits(const std::vector<Limit>& limits,
                  const std::vector<LimitedFigure>& figures,
                  CommandResult& result);

}  // namespace wobblebench::bench
