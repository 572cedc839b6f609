// Rate at which a simulated or recorded link delivers its bytes.
#pragma once

#include "base/options.h"

namespace wobblebench::hw {

enum class Pace {
  asap,      ///< as fast as they are read
  realtime,  ///< at the device's times, on the host's clock
};

template <OptionsOf<Pace> P, class Visitor>
void describe_pace(P& pace, Visitor& v) {
  v.choice("pace", pace, {{"asap", Pace::asap}, {"realtime", Pace::realtime}});
}

}  // namespace wobblebench::hw
