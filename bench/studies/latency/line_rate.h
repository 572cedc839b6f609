// The highest line rate before the first loss, by search in virtual time.
#pragma once

#include <vector>

#include "bench/studies/latency/latency_study.h"
#include "bench/studies/latency/virtual_stream.h"

namespace wobblebench::bench {

/// With `every` the first stick that finds the board's ring full, with `newest` the first volume
/// that is superseded; lines and frames are the setting's, the depth makes the rate.
std::vector<LineRate> first_losses(const VirtualSetting& setting);

}  // namespace wobblebench::bench
