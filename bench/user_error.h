// The one error of the command line for what a user gave it: a message on one line, exit code 2.
#pragma once

#include <stdexcept>
#include <string>

namespace wobblebench::bench {

/// what() names file (or option), key, value and what is allowed, on one line.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace wobblebench::bench
