// What every refusal of this room throws.
#pragma once

#include <stdexcept>

namespace wobblebench::phantoms {

/// Options or a file that no phantom can be made of; what() is one line.
class InvalidPhantom : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace wobblebench::phantoms
