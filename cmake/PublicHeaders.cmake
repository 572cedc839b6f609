# What is installed: headers that other programs name, each class with an example, and the headers that these
# include.
include_guard()

set(dev_headers
  hw/probe/acquisition_plan.h hw/probe/polar_volume.h hw/probe/probe.h
  hw/link/fault_link.h hw/link/link.h hw/link/xdma_link.h
  hw/recording/file_link.h hw/recording/recorder.h hw/recording/recording.h
  hw/wire/configuration.h hw/wire/unreadable_stream.h
  hw/board/board.h hw/board/volume_assembly.h
  render/options.h render/presets.h render/renderer.h render/view.h render/gl/context.h render/reference/reference.h
  # included by these
  base/duration.h base/image.h base/options.h base/units.h
  hw/probe/clock.h hw/probe/motor_deviation.h hw/wire/account.h
  render/camera.h render/picture.h render/gl/texels.h)
set(bench_headers
  phantoms/options.h phantoms/phantom.h phantoms/placed_phantom.h phantoms/truth.h
  sim/options.h sim/probe_simulator.h sim/card/sim_link.h
  bench/evaluation/measures/depth_error.h bench/evaluation/registration/registration.h bench/evaluation/truth/truth.h
  bench/scene/scene.h bench/scene/resolved_scene.h
  # included by these
  phantoms/material.h phantoms/motion.h phantoms/parts.h phantoms/point_scatterers.h sim/fidelity.h sim/echo_store.h sim/iq_sink.h
  bench/results/error.h bench/results/measure.h)
# From a scene and a board to a picture: examples/cpp/render_scene.cpp is the example of them all.
set(pipeline_headers
  base/user_error.h bench/cache/phantom_cache.h bench/output/image_io.h bench/output/progress.h
  bench/pipeline/acquire.h bench/pipeline/stream/gl_stream_renderer.h
  # included by these
  base/part_done.h base/text.h hw/link/link_arguments.h
  bench/cache/blob_cache.h bench/output/machine_use.h bench/output/report_parts.h
  bench/pipeline/board_link.h bench/pipeline/outside_link.h bench/pipeline/stream/frame_reader.h
  bench/pipeline/stream/stream.h bench/pipeline/stream/stream_queues.h bench/pipeline/stream/stream_source.h)
