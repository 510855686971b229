#!/usr/bin/python3
"""A volume seen directly, by trilens and by VTK's ray caster for unstructured grids: how alike, and in what time.

    PYTHONPATH=build/release/python xvfb-run -a /usr/bin/python3 bench/volumes.py TRILENS FOLDER [WIDTHxHEIGHT [REPEATS]]

The volume is scenes/volumes/jet.vtk, alone before black. VTK (Debian's python3-vtk9) reads the same file, cuts it by
its own filter and draws it by vtkUnstructuredGridVolumeRayCastMapper with its linear ray integrator, in 8 bits; its
rays stand half a pixel left of ours, for which its columns are averaged in pairs before they are compared. Times are
medians: of the whole command, which reads the file; of VTK also of a drawing alone, with all of its set-up done.
Writes FOLDER/volumes.md, and FOLDER/volumes.png: the middles of `trilens render` and of VTK side by side.
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
EYE, AT, YFOV = (0.2, 1.6, 6.4), (0, 1.5, 0), 34
LOW, HIGH, EXTINCTION = 0.02, 0.9, 6
HEAT = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1))


def scene(size):
    return {"version": 1, "film": {"width": size[0], "height": size[1]},
            "cameras": [{"yfov": YFOV, "lookAt": {"eye": EYE, "at": AT}}], "background": {"color": [0, 0, 0]},
            "volumes": [{"file": str(SOURCE / "scenes/volumes/jet.vtk"),
                         "transferFunction": {"map": "heat", "range": [LOW, HIGH], "extinction": EXTINCTION}}]}


def vtk_window(vtk, size):
    """A window that draws the jet, and its camera."""
    reader = vtk.vtkUnstructuredGridReader()
    reader.SetFileName(str(SOURCE / "scenes/volumes/jet.vtk"))
    tetrahedra = vtk.vtkDataSetTriangleFilter()
    tetrahedra.SetInputConnection(reader.GetOutputPort())
    mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper()
    mapper.SetInputConnection(tetrahedra.GetOutputPort())
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1)
    mapper.SetRayIntegrator(vtk.vtkUnstructuredGridLinearRayIntegrator())
    color, extinction = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for k, rgb in enumerate(HEAT):
        value = LOW + (HIGH - LOW) * k / (len(HEAT) - 1)
        color.AddRGBPoint(value, *rgb)
        extinction.AddPoint(value, EXTINCTION * k / (len(HEAT) - 1))
    look = vtk.vtkVolumeProperty()
    look.SetColor(color)
    look.SetScalarOpacity(extinction)
    look.SetScalarOpacityUnitDistance(1)
    look.SetInterpolationTypeToLinear()
    look.ShadeOff()
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    renderer = vtk.vtkRenderer()
    renderer.AddVolume(volume)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*EYE)
    camera.SetFocalPoint(*AT)
    camera.SetViewUp(0, 1, 0)
    camera.SetViewAngle(YFOV)
    renderer.ResetCameraClippingRange()
    return window, camera


def vtk_pixels(vtk, np, window, size):
    from vtk.util.numpy_support import vtk_to_numpy
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    rows = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(size[1], size[0], -1)[::-1]
    light = rows[..., :3].astype(float) / 255
    return 0.5 * (light + np.roll(light, -1, 1))


def timed(work):
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main():
    if not 3 <= len(sys.argv) <= 5:
        sys.exit(__doc__)
    try:
        import numpy as np
        import trilens as module
        import vtk
    except ImportError as missing:
        sys.exit(f"skipped: {missing}")
    trilens, folder = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    size = tuple(int(n) for n in (sys.argv[3] if len(sys.argv) > 3 else "640x480").split("x"))
    repeats = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "jet.json").write_text(json.dumps(scene(size)))

    def draw(command):
        subprocess.run([trilens, command, "jet.json", "-q", "-o", f"{command}.exr"], cwd=folder, check=True)

    def draw_all():
        window, _ = vtk_window(vtk, size)
        window.Render()

    window, camera = vtk_window(vtk, size)
    window.Render()

    def draw_again():
        camera.Modified()
        window.Render()

    works = {"trilens render": lambda: draw("render"), "trilens trace": lambda: draw("trace"),
             "VTK, file and set-up": draw_all, "VTK, drawing alone": draw_again}
    times = {name: [] for name in works}
    for _ in range(repeats):
        for name, work in works.items():
            times[name].append(timed(work))
    theirs = vtk_pixels(vtk, np, window, size)
    lines = [f"{size[0]} x {size[1]}, {os.cpu_count()} processors, VTK {vtk.VTK_VERSION}, medians of {repeats}", "",
             "| | wall s | mean difference from VTK | most |", "|---|---|---|---|"]
    for name, seconds in times.items():
        unlike = " | |"
        if name.startswith("trilens"):
            picture = module.read_image(folder / f"{name.split()[1]}.exr")
            ours = np.stack([picture[channel] for channel in "RGB"], axis=-1)
            off = np.abs(ours - theirs)[:, 1:-1]
            unlike = f" {off.mean():.5f} | {off.max():.3f} |"
        lines.append(f"| {name} | {statistics.median(seconds):.3f} |{unlike}")
    import matplotlib.image
    picture = module.read_image(folder / "render.exr")
    middle = slice(size[0] // 4, size[0] * 3 // 4)
    both = np.concatenate([np.stack([picture[channel] for channel in "RGB"], axis=-1)[:, middle], theirs[:, middle]], axis=1)
    matplotlib.image.imsave(folder / "volumes.png", np.clip(both, 0, 1) ** (1 / 2.2))
    (folder / "volumes.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
