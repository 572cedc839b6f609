# What is installed: interfaces for other programs, each class with an example, and the headers that these include.
include_guard()

set(public_headers
  base/image.h base/options.h base/units.h
  hw/probe/acquisition_plan.h hw/probe/clock.h hw/probe/polar_volume.h hw/probe/probe.h hw/probe/probe_presets.h
  hw/probe/stick.h
  hw/link/fault_link.h hw/link/link.h hw/link/xdma_link.h
  hw/recording/file_link.h hw/recording/recorder.h hw/recording/recording.h
  hw/board/board.h hw/board/volume_assembly.h
  render/camera.h render/options.h render/picture.h render/renderer.h render/view.h
  render/gl/context.h render/reference/reference.h)
set(included_by_public_headers
  hw/link/faults.h hw/link/pace.h
  hw/wire/account.h hw/wire/configuration.h hw/wire/stream_origin.h hw/wire/unreadable_stream.h hw/wire/version.h
  render/gl/texel_format.h render/gl/texture_fetch.h)
if(NOT WOBBLEBENCH_RENDER_ONLY)
  list(APPEND public_headers
    phantoms/material.h phantoms/motion.h phantoms/options.h phantoms/phantom.h phantoms/placed_phantom.h
    phantoms/truth.h
    sim/fidelity.h sim/options.h sim/probe_simulator.h sim/card/sim_link.h
    bench/evaluation/depth_error.h bench/evaluation/registration.h bench/evaluation/truth.h)
endif()
list(APPEND public_headers ${included_by_public_headers})
