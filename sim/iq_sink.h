// IQ samples of a simulated probe, delivered in addition to the detected samples.
#pragma once

#include <complex>
#include <functional>
#include <span>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Takes the IQ samples of one stick: with electronic noise, before envelope detection and TGC. An
/// amplitude of 1 is the echo of a perfect mirror; sample i of n lies at range (i + 1/2) depth / n;
/// a reflector at range r has the phase -4 pi r / wavelength at the centre frequency. Valid during
/// the call.
using IqSink =
    std::function<void(const hw::StickIndex& index, std::span<const std::complex<float>> iq)>;

}  // namespace wobblebench::sim
