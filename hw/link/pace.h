// How fast a link that has all its bytes hands them out.
#pragma once

#include "base/options.h"

namespace wobblebench::hw {

enum class Pace {
  asap,      ///< as fast as they are read
  realtime,  ///< when the device would have sent them, by the host's clock
};

template <OptionsOf<Pace> P, class Visitor>
void describe_pace(P& pace, Visitor& v) {
  v.choice("pace", pace, {{"asap", Pace::asap}, {"realtime", Pace::realtime}});
}

}  // namespace wobblebench::hw
