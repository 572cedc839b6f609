#!/usr/bin/env python3
"""Say what a recording holds, and how bright its samples are at each depth.

    look_at_recording.py out/recording.wbst
"""
import sys

import numpy

import wobblebench

if len(sys.argv) != 2:
    sys.exit("look_at_recording.py RECORDING")
recording = wobblebench.Recording(sys.argv[1])
print(f"{recording.volumes} volumes, {recording.sticks} sticks, {recording.lost} lost, "
      + ("damaged" if recording.damaged else "complete" if recording.complete else "incomplete"))
for volume in recording:
    print(f"volume {volume.index}: frames, lines, samples {volume.samples.shape}")
    zones = numpy.array_split(numpy.arange(volume.ranges_m.size), 8)
    for zone in zones:
        levels = volume.samples[:, :, zone][volume.arrived]
        print(f"  {1e3 * volume.ranges_m[zone[0]]:5.0f} to {1e3 * volume.ranges_m[zone[-1]]:4.0f} mm: "
              f"mean {levels.mean():.3f}, highest 1 % from {numpy.quantile(levels, 0.99):.3f}")
