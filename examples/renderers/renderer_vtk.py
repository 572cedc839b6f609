#!/usr/bin/python3
"""VTK as a renderer for `wobblebench --renderer`: Gaussian, flying edges, rays.

    wobblebench run --renderer vtk='python3 examples/renderers/renderer_vtk.py' --set render.program=vtk
"""
import json
import sys

import numpy as np
import vtk
from renderer import rays
from vtk.util.numpy_support import numpy_to_vtk


def otsu(values):
    """The threshold between two kinds of samples with the greatest variance between them."""
    counts, edges = np.histogram(values, 128)
    middles, below = (edges[1:] + edges[:-1]) / 2, np.cumsum(counts)
    sums = np.cumsum(counts * middles)
    between = (sums[-1] * below - sums * below[-1]) ** 2 / np.maximum(below * (below[-1] - below), 1)
    return middles[np.argmax(between)]


def surface(grid, sigma_mm=1.0):
    samples = np.load(grid["file"])  # [z, y, x]
    image = vtk.vtkImageData()
    image.SetDimensions(samples.shape[::-1])
    image.SetOrigin(grid["first_mm"])
    image.SetSpacing([grid["spacing_mm"]] * 3)
    image.GetPointData().SetScalars(numpy_to_vtk(np.nan_to_num(samples).ravel(), deep=True))
    smooth = vtk.vtkImageGaussianSmooth()
    smooth.SetInputData(image)
    smooth.SetStandardDeviation(sigma_mm / grid["spacing_mm"])
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputConnection(smooth.GetOutputPort())
    edges.SetValue(0, otsu(samples[np.isfinite(samples)]))
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


for line in sys.stdin:
    request = json.load(open(line.strip()))
    np.save(request["depth"], depths(request["camera"], surface(request["cartesian"])))
    print("done", flush=True)
