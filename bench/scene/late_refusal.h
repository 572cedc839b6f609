// Refusals of a scene that only its work finds.
#pragma once

#include <string>

#include "base/options.h"
#include "base/user_error.h"
#include "phantoms/options.h"

namespace wobblebench::bench {

/// Runs `body`. A scan too large for its rung, or a phantom whose file holds none, is thrown as
/// UserError that names the scene's section.
template <class Body>
auto with_late_refusals(const Body& body) {
  try {
    return body();
  } catch (const InvalidOption& error) {
    throw UserError(std::string("simulation.") + error.what());
  } catch (const phantoms::InvalidPhantom& error) {
    throw UserError(std::string("phantom.") + error.what());
  }
}

}  // namespace wobblebench::bench
