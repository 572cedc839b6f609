// How fast a link that has all its bytes hands them out.
#pragma once

#include <string_view>

namespace wobblebench::hw {

enum class Pace {
  asap,      ///< as fast as they are read
  realtime,  ///< when the device would have sent them, by the host's clock
};

template <class Visitor>
void describe_pace(Pace& pace, Visitor& v) {
  v.choice("pace", pace, {{"asap", Pace::asap}, {"realtime", Pace::realtime}});
}

}  // namespace wobblebench::hw
