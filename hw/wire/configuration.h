// The acquisition that the sticks of a stream belong to.
#pragma once

#include "hw/probe/acquisition_plan.h"
#include "hw/wire/display_scale.h"
#include "hw/wire/stream_origin.h"
#include "hw/wire/subject_hash.h"

namespace wobblebench::hw {

/// Given at the start of a stream, and again where it changes.
struct Configuration {
  AcquisitionPlan plan;
  StreamOrigin source;  ///< of the samples, also in a recording
  SubjectHash subject = {};
  DisplayScale display_scale = {};
};

}  // namespace wobblebench::hw
