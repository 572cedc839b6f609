// Limits that a command's figures must keep, so that a script or continuous integration learns of
// it by the exit code.
#pragma once

#include <string>
#include <vector>

#include "bench/results/measure.h"

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

/// "p95_mm<=2".
std::string text_of(const Limit& limit);

/// "p95_mm<=2", with a number of 0 or more. Throws UserError "--limit = TEXT: what is allowed",
/// with `names` where the name is none of them.
Limit parse_limit(const std::string& text, const std::vector<std::string>& names);
std::vector<Limit> parse_limits(const std::vector<std::string>& texts,
                                const std::vector<std::string>& names);

/// --limit, with the names in its help.
void add_limit_option(CLI::App& command,
                      std::vector<std::string>& limits,
                      const std::vector<std::string>& names);

/// Of these figures the names of those that --limit may hold: less is better.
std::vector<std::string> limit_names(const Measurements& figures);

/// Adds each limit to the result's checks, as add_check(). The magnitude is compared, as a bias may
/// be negative. A figure that is not formed keeps no limit. `figures` has all names that were
/// allowed.
void check_limits(const std::vector<Limit>& limits,
                  const Measurements& figures,
                  CommandResult& result);

}  // namespace wobblebench::bench
