#!/usr/bin/python3
"""A renderer for `wobblebench --renderer`: the first voxel above a threshold along each ray.

    wobblebench run --renderer first='python3 examples/renderers/renderer.py' --set render.program=first
"""
import json
import sys

import numpy as np


def rays(camera):
    """Start and unit direction, mm, of the ray of each pixel (docs/units.md)."""
    to_world = np.linalg.inv(camera["world_to_ndc"])
    middles = (2 * np.arange(camera["image_size"]) + 1) / camera["image_size"] - 1
    x, y = np.meshgrid(middles, -middles)
    near, far = (np.stack([x, y, 0 * x + z, 0 * x + 1], -1) @ to_world for z in (0, 0.5))
    near, far = near[..., :3] / near[..., 3:], far[..., :3] / far[..., 3:]
    direction = (far - near) / np.linalg.norm(far - near, axis=-1, keepdims=True)
    eye = np.linalg.inv(camera["world_to_camera"])[3, :3]
    return near if camera["projection"] == "parallel" else 0 * near + eye, direction


def depths(camera, box, grid, threshold=0.45, step_mm=0.5):
    volume = np.load(grid["file"])  # [z, y, x]; NaN, outside the scan, is above no threshold
    start, direction = rays(camera)
    depth = np.full(start.shape[:2], np.nan, np.float32)
    reach_mm = np.linalg.norm(np.array(list(box.values())) - start.mean((0, 1)), axis=1).max()
    for t in np.arange(0, reach_mm + 100, step_mm):
        z_y_x = np.rint((start + t * direction - grid["first_mm"]) / grid["spacing_mm"])[..., ::-1]
        inside = ((z_y_x >= 0) & (z_y_x < volume.shape)).all(-1)
        z, y, x = np.moveaxis(np.where(inside[..., None], z_y_x, 0).astype(int), -1, 0)
        depth[inside & (volume[z, y, x] > threshold) & np.isnan(depth)] = t
    return depth


if __name__ == "__main__":
    for line in sys.stdin:  # the name of a request, for each volume
        request = json.load(open(line.strip()))
        np.save(request["depth"], depths(request["camera"], request["box"], request["cartesian"]))
        print("done", flush=True)
