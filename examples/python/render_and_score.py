#!/usr/bin/env python3
"""Simulate a scene, render it, and say how far the found surface lies from the true one.

    render_and_score.py docs/scenes/sphere.toml depth.npy
"""
import argparse

import numpy

import wobblebench

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scene", nargs="?", default="", help="TOML file; default: the face of a fetus")
parser.add_argument("depth", nargs="?", help="where to write the found depth, in metres")
parser.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE")
arguments = parser.parse_args()

scene = wobblebench.Scene(arguments.scene, arguments.set)
volume = wobblebench.simulate(scene)
picture = wobblebench.Renderer(scene).render(volume)
figures = wobblebench.score(picture, scene)
print(f"P95 {figures['p95_mm']:.2f} mm, missed {figures['missed_percent']:.2f} %, "
      f"false {figures['false_percent']:.2f} % of the picture")

# The same map of another program's surface is scored alike: here, of ours, smoothed by NumPy.
depth_m = numpy.array(picture.depth_m)
neighbours = numpy.stack([numpy.roll(depth_m, shift, axis) for shift in (-1, 1) for axis in (0, 1)])
depth_m = (depth_m + neighbours.sum(axis=0)) / 5
print(f"smoothed: P95 {wobblebench.score(depth_m, scene)['p95_mm']:.2f} mm")
if arguments.depth:
    numpy.save(arguments.depth, picture.depth_m)
