// The name that a slip of the keyboard may have meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobblebench {

/// The one of `names` nearest to `text`, if it is near: at most a third of its letters, rounded up,
/// are inserted, deleted, replaced or swapped with their neighbour. Empty: none. Case does not
/// count.
std::string nearest_name(std::string_view text, const std::vector<std::string>& names);

/// "; did you mean NAME?", or nothing where no name is near.
std::string did_you_mean(std::string_view text, const std::vector<std::string>& names);

}  // namespace wobblebench
