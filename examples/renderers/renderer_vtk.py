#!/usr/bin/python3
"""VTK as a renderer for `wobblebench --renderer`: Gaussian, flying edges, rays.

    wobblebench run --renderer vtk='python3 examples/renderers/renderer_vtk.py' --set render.program=vtk

The default level was chosen by the truth of the default face. `--level` gives another, from 0 to 1.
"""
import argparse
import json
import sys

import numpy as np
import vtk
from renderer import rays
from vtk.util.numpy_support import numpy_to_vtk


def surface(grid, level, sigma):
    samples = np.load(grid["file"])  # [z, y, x]
    image = vtk.vtkImageData()
    image.SetDimensions(samples.shape[::-1])
    image.SetOrigin(grid["first_mm"])
    image.SetSpacing([grid["spacing_mm"]] * 3)
    image.GetPointData().SetScalars(numpy_to_vtk(np.nan_to_num(samples).ravel(), deep=True))
    smooth = vtk.vtkImageGaussianSmooth()
    smooth.SetInputData(image)
    smooth.SetStandardDeviation(sigma)
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputConnection(smooth.GetOutputPort())
    edges.SetValue(0, level)
    edges.Update()
    return edges.GetOutput()


def depths(camera, mesh):
    start, direction = rays(camera)
    depth = np.full(start.shape[:2], np.nan, np.float32)
    if mesh.GetNumberOfCells() == 0:
        return depth
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(mesh)
    locator.BuildLocator()
    part, side, cell, at, where = vtk.mutable(0.0), vtk.mutable(0), vtk.mutable(0), [0] * 3, [0] * 3
    for pixel in np.ndindex(depth.shape):
        near, far = start[pixel], start[pixel] + 2000 * direction[pixel]
        if locator.IntersectWithLine(near, far, 1e-6, part, at, where, side, cell):
            depth[pixel] = 2000 * part
    return depth


options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
options.add_argument("--level", type=float, default=0.38, help="iso-level of the samples")
options.add_argument("--sigma", type=float, default=2, help="of the Gaussian, voxels")
given = options.parse_args()
for line in sys.stdin:
    request = json.load(open(line.strip()))
    mesh = surface(request["cartesian"], given.level, given.sigma)
    np.save(request["depth"], depths(request["camera"], mesh))
    print("done", flush=True)
