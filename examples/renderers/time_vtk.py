#!/usr/bin/python3
"""How long VTK takes for an iso-surface by rays, on the driver that the display has: quartiles of three pictures.

    wobblebench export sim --to volume.mha,content=cartesian,spacing_mm=0.2
    xvfb-run python3 examples/renderers/time_vtk.py volume.mha

512 x 512 pixels, parallel, of the default volume of interest (100 x 100 x 80 mm), a sample each 80 / 512 mm.
"""
import sys
import time

import numpy as np
import vtk

LEVEL = 110  # of 255
CENTRE_MM, SIZE_MM = (0, 0, 120), (100, 100, 80)

reader = vtk.vtkMetaImageReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
box = vtk.vtkExtractVOI()
box.SetInputData(grid)
first = [round((c - s / 2 - o) / d) for c, s, o, d in zip(CENTRE_MM, SIZE_MM, grid.GetOrigin(), grid.GetSpacing())]
last = [f + round(s / d) for f, s, d in zip(first, SIZE_MM, grid.GetSpacing())]
box.SetVOI(*[i for ends in zip(first, last) for i in ends])
box.Update()

mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
mapper.SetInputData(box.GetOutput())
mapper.SetBlendModeToIsoSurface()
mapper.AutoAdjustSampleDistancesOff()
mapper.SetSampleDistance(SIZE_MM[2] / 512)
colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
colour.AddRGBPoint(LEVEL, 1, 0.8, 0.7)
opacity.AddPoint(LEVEL, 1)
look = vtk.vtkVolumeProperty()
look.SetInterpolationTypeToLinear()
look.ShadeOn()
look.GetIsoSurfaceValues().SetValue(0, LEVEL)
look.SetColor(colour)
look.SetScalarOpacity(opacity)
volume = vtk.vtkVolume()
volume.SetMapper(mapper)
volume.SetProperty(look)

renderer = vtk.vtkRenderer()
renderer.AddVolume(volume)
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetMultiSamples(0)
window.SetSize(512, 512)
window.AddRenderer(renderer)
camera = renderer.GetActiveCamera()
camera.ParallelProjectionOn()
camera.SetPosition(0, 0, -100)
camera.SetFocalPoint(*CENTRE_MM)
camera.SetViewUp(0, -1, 0)
times_ms = []
for picture in range(4):
    camera.SetParallelScale(SIZE_MM[1] / 2 + 1e-3 * picture)  # another view, so that it is drawn again
    renderer.ResetCameraClippingRange()
    start = time.perf_counter()
    window.Render()
    window.WaitForCompletion()
    times_ms.append(1e3 * (time.perf_counter() - start))
capabilities = window.ReportCapabilities().splitlines()
print(*[line for line in capabilities if "renderer string" in line])
print("voxels", box.GetOutput().GetDimensions(), "milliseconds", np.percentile(times_ms[1:], [25, 50, 75]).round())
