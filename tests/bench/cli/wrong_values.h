// Values that --set and --board must refuse, from the descriptions of the options (base/options.h).
#pragma once

#include <string>
#include <vector>

namespace wobblebench::bench::testing {

/// "section.key=value" for each key of a scene and each way in which its value can be wrong, and
/// texts that are no setting at all.
std::vector<std::string> wrong_settings();

/// For --board of wobblebench: links with a wrong value of each of their keys, and texts that name
/// no link. Names like none.wbst are files that must not be there.
std::vector<std::string> wrong_boards();

}  // namespace wobblebench::bench::testing
