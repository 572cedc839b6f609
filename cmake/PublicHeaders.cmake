# What is installed: headers that other programs name, each class with an example, and the headers that these
# include.
include_guard()

set(public_headers
  hw/probe/acquisition_plan.h hw/probe/polar_volume.h hw/probe/probe.h
  hw/link/fault_link.h hw/link/link.h hw/link/xdma_link.h
  hw/recording/file_link.h hw/recording/recorder.h hw/recording/recording.h
  hw/wire/configuration.h hw/wire/unreadable_stream.h
  hw/board/board.h hw/board/volume_assembly.h
  render/options.h render/renderer.h render/view.h render/gl/context.h render/reference/reference.h)
set(included_by_public_headers
  base/duration.h base/image.h base/options.h base/units.h
  hw/probe/clock.h hw/probe/motor_deviation.h hw/wire/account.h
  render/camera.h render/picture.h render/gl/texels.h)
if(NOT WOBBLEBENCH_RENDER_ONLY)
  list(APPEND public_headers
    phantoms/options.h phantoms/phantom.h phantoms/placed_phantom.h phantoms/truth.h
    sim/options.h sim/probe_simulator.h sim/card/sim_link.h
    bench/evaluation/measures/depth_error.h bench/evaluation/registration/registration.h bench/evaluation/truth/truth.h)
  list(APPEND included_by_public_headers
    phantoms/material.h phantoms/motion.h phantoms/point_scatterers.h sim/fidelity.h sim/iq_sink.h)
endif()
list(APPEND public_headers ${included_by_public_headers})
