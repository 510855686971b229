"""Volumes that VTK itself has written, in every way that it knows."""
import gzip
import itertools
import subprocess

import numpy as np
import pytest

import trilens

WRITER = '''
import random, sys
import vtkmodules.all as vtk
folder, side = sys.argv[1], 6
rnd = random.Random(3)
points, grid, heat = vtk.vtkPoints(), vtk.vtkUnstructuredGrid(), vtk.vtkDoubleArray()
velocity, part = vtk.vtkFloatArray(), vtk.vtkIntArray()
heat.SetName("heat"); velocity.SetName("velocity"); part.SetName("part")
velocity.SetNumberOfComponents(3)
for i in range(side ** 3):
    # Quarters, which text holds to the last bit.
    points.InsertNextPoint(i % side + rnd.choice((0, 0.25)), i // side % side, i // side ** 2)
    heat.InsertNextValue(rnd.randrange(64) / 64); velocity.InsertNextTuple3(i, 0, 1)
grid.SetPoints(points)
number = lambda i, j, k: i + side * (j + side * k)
for k in range(side - 1):
    for j in range(side - 1):
        for i in range(side - 1):
            ring = ((0, 0), (1, 0), (1, 1), (0, 1))
            grid.InsertNextCell(vtk.VTK_HEXAHEDRON, 8, [number(i + x, j + y, k + z) for z in (0, 1) for x, y in ring])
for i in range(grid.GetNumberOfCells()):
    part.InsertNextValue(10)
grid.GetPointData().AddArray(velocity); grid.GetPointData().AddArray(heat); grid.GetCellData().AddArray(part)
for version in (42, 51):
    for binary in (0, 1):
        writer = vtk.vtkUnstructuredGridWriter()
        writer.SetFileName(f"{folder}/{version}-{binary}.vtk"); writer.SetInputData(grid); writer.SetFileVersion(version)
        (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
        writer.Write()
for mode, name in enumerate(("ascii", "binary", "appended")):
    for packed in (0, 1):
        for big in (0, 1):
            for words in (0, 1):
                for base64 in (0, 1) if name == "appended" else (0,):
                    writer = vtk.vtkXMLUnstructuredGridWriter()
                    writer.SetFileName(f"{folder}/{name}-{packed}{big}{words}{base64}.vtu"); writer.SetInputData(grid)
                    writer.SetDataMode(mode); writer.SetEncodeAppendedData(base64)
                    (writer.SetCompressorTypeToZLib if packed else writer.SetCompressorTypeToNone)()
                    (writer.SetByteOrderToBigEndian if big else writer.SetByteOrderToLittleEndian)()
                    (writer.SetHeaderTypeToUInt64 if words else writer.SetHeaderTypeToUInt32)()
                    if big:
                        writer.SetBlockSize(1024)  # several blocks
                    writer.Write()
'''


def picture(file, **more):
    volume = {"file": str(file), "transferFunction": {"map": "heat", "range": [0, 1], "extinction": 1}, **more}
    scene = trilens.parse_scene({"version": 1, "film": {"width": 24, "height": 18}, "volumes": [volume],
                                 "cameras": [{"yfov": 40, "lookAt": {"eye": [12, 14, 20], "at": [2.5, 2.5, 2.5]}}]})
    with pytest.warns(trilens.TrilensWarning, match="the scene has no optic"):
        image = trilens.Renderer(scene).render()
    return np.stack([np.asarray(image[channel]) for channel in "RGB"])


def test_what_vtk_writes_is_one_volume_in_every_encoding(tmp_path):
    made = subprocess.run(["/usr/bin/python3", "-c", WRITER, tmp_path], capture_output=True, text=True)
    if "No module named 'vtkmodules'" in made.stderr:
        pytest.skip("needs VTK for Python (python3-vtk9)")
    assert made.returncode == 0, made.stderr
    files = sorted(tmp_path.iterdir())
    assert len(files) == 4 + 8 + 8 + 16
    first, *others = [picture(file, field="heat") for file in files]
    assert first.max() > 0.1
    for file, other in zip(files[1:], others):
        assert np.array_equal(first, other), file.name


def test_a_packed_nrrd_is_the_volume_that_it_is_unpacked(tmp_path):
    samples = np.random.default_rng(5).integers(0, 2**16, (6, 5, 4)).astype(">u2")
    pictures = []
    for encoding, pack in (("raw", bytes), ("gzip", gzip.compress), ("gz", lambda data: gzip.compress(b"four" + data))):
        head = f"NRRD0004\ntype: ushort\ndimension: 3\nsizes: 4 5 6\nendian: big\nencoding: {encoding}\n"
        head += "byte skip: 4\n\n" if encoding == "gz" else "\n"
        file = tmp_path / f"{encoding}.nrrd"
        file.write_bytes(head.encode() + pack(samples.tobytes()))
        change = {"map": "heat", "range": [0, 65535], "extinction": 1}
        pictures.append(picture(file, transferFunction=change))
    assert pictures[0].max() > 0.1
    assert all(np.array_equal(pictures[0], other) for other in pictures[1:])
    whole = (tmp_path / "gzip.nrrd").read_bytes()
    for broken in (whole[:-9], whole[:-60] + bytes(52) + whole[-8:], whole.replace(b"sizes: 4 5 6", b"sizes: 4 5 9")):
        (tmp_path / "broken.nrrd").write_bytes(broken)
        with pytest.raises(trilens.InputError, match="no gzip stream"):
            picture(tmp_path / "broken.nrrd")
