#!/usr/bin/python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Compares Limber's raymarcher with vtkGPUVolumeRayCastMapper: the same volume, cameras, sizes and software OpenGL,
in one run.

    render_vtk.py RENDER_VIEWS VOLUME.mha

RENDER_VIEWS draws first and prints its cameras and times; VTK then draws the same pictures. This program prints as JSON
for each view the CPU seconds of both programs (median of five, all threads), how many times faster Limber is, and by
how much the silhouettes differ in area; then the geometric means. If there is no display, it starts a virtual one
(Xvfb).
"""
import json
import math
import os
import resource
import subprocess
import sys
import zlib


def cpu_seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def read_mha(path):
    """Returns the labels (x fastest) and the header of an 8-bit MetaImage with local data."""
    import numpy
    with open(path, "rb") as file:
        content = file.read()
    end = content.index(b"ElementDataFile = LOCAL") + len(b"ElementDataFile = LOCAL\n")
    header = dict(line.split(" = ", 1) for line in content[:end].decode("latin1").splitlines() if " = " in line)
    data = content[end:]
    if header.get("CompressedData") == "True":
        data = zlib.decompress(data)
    numbers = lambda key: [float(word) for word in header[key].split()]
    size = [int(n) for n in numbers("DimSize")]
    labels = numpy.frombuffer(data, numpy.uint8)[: size[0] * size[1] * size[2]]
    return labels, size, numbers("ElementSpacing"), numbers("Offset"), numbers("TransformMatrix")


def make_volume(vtk, path, display):
    import numpy
    from vtk.util.numpy_support import numpy_to_vtk
    labels, size, spacing, offset, matrix = read_mha(path)
    image = vtk.vtkImageData()
    image.SetDimensions(size)
    image.SetSpacing(spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(labels, deep=True))

    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    bones = {111, 209, 253, 133, 65, 189, 11}  # labels that stay solid in X-ray: bone, cartilage, vessels, nerves
    for label in range(256):
        colour.AddRGBPoint(label, 0.5 + label / 512, 0.7 - label / 1024, 0.6)
        solid = display == "solid" or label in bones
        opacity.AddPoint(label, 0.0 if label == 0 else 1.0 if solid else 0.02)
    properties = vtk.vtkVolumeProperty()
    properties.SetColor(colour)
    properties.SetScalarOpacity(opacity)
    properties.SetScalarOpacityUnitDistance(spacing[0])
    properties.SetInterpolationTypeToNearest()
    properties.ShadeOn()

    mapper = vtk.vtkGPUVolumeRayCastMapper()
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1.0)
    mapper.SetLockSampleDistanceToInputSpacing(1)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(properties)
    world = vtk.vtkMatrix4x4()
    for row in range(3):
        for column in range(3):
            world.SetElement(row, column, matrix[column * 3 + row])
        world.SetElement(row, 3, offset[row])
    volume.SetUserMatrix(world)
    return volume


def draw(vtk, path, view):
    """Returns the CPU seconds of each picture, and which of its pixels are not background."""
    from vtk.util.numpy_support import vtk_to_numpy
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(make_volume(vtk, path, view["display"]))
    renderer.SetBackground(0, 0, 0)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(view["size"])
    window.AddRenderer(renderer)

    def turn(camera):
        mine = renderer.GetActiveCamera()
        mine.SetPosition(camera["eye"])
        mine.SetFocalPoint(camera["centre"])
        mine.SetViewUp(camera["up"])
        mine.SetViewAngle(camera["angle"])
        renderer.ResetCameraClippingRange()

    def wait():
        pixels = vtk.vtkUnsignedCharArray()
        window.GetPixelData(0, 0, 0, 0, 0, pixels, 0)  # reading one pixel waits until everything is drawn
        return pixels

    turn(view["cameras"][-1])
    window.Render()
    wait()
    seconds, covered = [], []
    for camera in view["cameras"]:
        turn(camera)
        begin = cpu_seconds()
        window.Render()
        wait()
        seconds.append(cpu_seconds() - begin)
        pixels = vtk.vtkUnsignedCharArray()
        window.GetPixelData(0, 0, view["size"][0] - 1, view["size"][1] - 1, 0, pixels, 0)
        covered.append(int(vtk_to_numpy(pixels).reshape(-1, 3).any(axis=1).sum()))
    window.Finalize()
    return sorted(seconds)[len(seconds) // 2], covered


def main():
    program, path = sys.argv[1:3]
    if "DISPLAY" not in os.environ:
        os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable] + sys.argv)
    import vtk
    ours = json.loads(subprocess.run([program, path], check=True, capture_output=True, text=True).stdout)
    rows = []
    for view in ours["views"]:
        seconds, covered = draw(vtk, path, view)
        row = {"view": view["view"], "limber": view["cpu_seconds"], "vtk": round(seconds, 6), "ahead": round(seconds / view["cpu_seconds"], 1)}
        if view["display"] == "solid":
            row["silhouette_difference_percent"] = round(max(100 * abs(a / b - 1) for a, b in zip(view["pixels"], covered)), 2)
        rows.append(row)
    mean = lambda display: round(math.exp(sum(math.log(r["ahead"]) for r in rows if r["view"].endswith(display)) /
                                          sum(r["view"].endswith(display) for r in rows)), 1)
    print(json.dumps({"upload_cpu_seconds": ours["upload_cpu_seconds"], "turning": ours["turning"], "turning_at_scale": ours["turning_at_scale"], "views": rows,
                      "geometric_mean": {"solid": mean("solid"), "xray": mean("xray")}, "vtk": vtk.vtkVersion().GetVTKVersion()}, indent=1))


if __name__ == "__main__":
    main()
