#!/usr/bin/env python3
"""Writes the fuzzers' seeds, small legal inputs of each target, into fuzz/seeds: make_seeds.py [TRILENS]

TRILENS: the program, of which examples are taken; build/release/trilens if it is not named. What once broke is
added to the same folders by hand, under names that begin with "found-", and is left alone.
"""
import base64
import json
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
SEEDS = ROOT / "fuzz" / "seeds"
PROGRAM = str(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/trilens").resolve())

CAMERA = {"name": "c", "type": "perspective", "yfov": 40, "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0]}}
SMALL = {
    "version": 1,
    "film": {"width": 8, "height": 6, "spp": 2},
    "cameras": [CAMERA],
    "background": {"color": [0.2, 0.3, 0.5]},
    "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "glass", "transmissionFactor": 1, "ior": 1.5}],
    "lights": [{"type": "directional", "direction": [0, -1, 0], "shadows": True}],
    "meshes": [
        {"name": "ball", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "radius": 1}},
        {"name": "floor", "role": "object", "points": [[-2, -1, -2], [2, -1, -2], [2, -1, 2], [-2, -1, 2]],
         "faceVertexCounts": [4], "faceVertexIndices": [3, 2, 1, 0]},
    ],
}


def write(target, name, data):
    file = SEEDS / target / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(data.encode() if isinstance(data, str) else data)


def text(value):
    return json.dumps(value, separators=(",", ":"))


def scenes():
    write("scene", "small", text(SMALL))
    glass = json.loads(text(SMALL))
    glass["meshes"][0].update(material="glass", transform={"translate": [1, 0, 0], "rotate": {"euler": [0, 30, 0]}})
    glass["render"] = {"maxDepth": 2, "maxError": 0.5, "paths": ["direct", "refract"]}
    glass["cameras"].append({"name": "fish", "type": "fisheye", "fov": 180, "mapping": "equisolid", "lookAt": CAMERA["lookAt"]})
    write("scene", "glass", text(glass))
    far = {"position": [0, 2, 0], "direction": [0, -1, 0]}
    for name, light in (("rectangle", {"type": "rectangle", "size": [1, 0], **far}), ("disk", {"type": "disk", "radius": 0, **far}),
                        ("sphere", {"type": "sphere", "position": [0, 2, 0], "radius": 0}),
                        ("tiny-rectangle", {"type": "rectangle", "size": [1e-200, 1e-200], **far})):
        write("scene", f"refused-{name}-of-no-area", text(dict(SMALL, lights=[light])))
    sky = {"zenith": [0.2, 0.4, 0.8], "horizon": [0.8, 0.8, 0.9], "ground": [0.2, 0.2, 0.1]}
    write("scene", "sky", text(dict(SMALL, background=sky, lights=[{"type": "environment", "samples": 8, "shadows": True}])))
    moving = dict(SMALL, animation={"fps": 24, "tracks": [
        {"target": "/meshes/0/primitive/radius", "keys": [{"frame": 0, "value": 1}, {"frame": 8, "value": 0.5}]},
        {"target": "/cameras/0/yfov", "keys": [{"frame": 0, "value": 30}, {"frame": 4, "value": 60}], "interpolation": "smooth"}]})
    write("animation", "moving", b"\x24" + text(moving).encode())


def tables():
    write("points", "plain", "# points\n0,0,1\n1.5,-2,3e-2\n\n-1, 0 , 4\n")
    write("points", "header", "x,y,z\n0,0,1\n")
    write("points", "colored", "0,0,1,0.5,0.25,1\n")
    head = "element vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n" \
           "property uchar blue\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
    write("points", "ply-text", f"ply\nformat ascii 1.0\n{head}0 0 1 255 0 9\n1.5 -2 3e-2 1 2 3\n3 0 1 0\n")
    write("points", "ply-binary", f"ply\nformat binary_little_endian 1.0\n{head}".encode() + struct.pack("<3f3B3f3BB3i", 0, 0, 1, 255, 0, 9, 1, 2, 3, 4, 5, 6, 3, 0, 1, 0))
    write("pairs", "plain", "320,240,0.5,-0.5,1.5\n10.5,20.25,1,2,3\n")
    write("pairs", "header", "x,y,X,Y,Z,sigma,camera,path,image\n3,4,0.5,0,1,0.25,c,R,0\n5,6,1,1,1,0.5,c,TT,1\n")
    write("wish", "driver", subprocess.run([PROGRAM, "design", "--example"], check=True, capture_output=True).stdout)


def lenses():
    for name in ("cooke-triplet.zmx", "double-gauss.seq"):
        write("lens", name.split(".")[0], (ROOT / "scenes/lenses" / name).read_text())
    write("lens", "asphere", "SURF 0\n DISZ INFINITY\nSURF 1\n TYPE EVENASPH\n CURV .02\n CONI -1.5\n PARM 2 -2e-6\n DISZ 4\n"
          " GLAS ___BLANK 1 0 1.6 50.5\n DIAM 9\nSURF 2\n STOP\n DIAM 9\nSURF 3\n")


def volumes():
    write("vtk", "cells", """# vtk DataFile Version 3.0
all shapes
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 9 float
0 0 0 1 0 0 1 1 0 0 1 0
0 0 1 1 0 1 1 1 1 0 1 1 .5 .5 2
CELLS 5 33
8 0 1 2 3 4 5 6 7
5 4 5 6 7 8
6 0 1 3 4 5 7
4 0 1 3 4
3 0 1 2
CELL_TYPES 5
12 14 13 10 5
POINT_DATA 9
VECTORS v float
0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0
SCALARS heat float 1
LOOKUP_TABLE default
0 1 2 3 4 5 6 7 8e-1
""")
    write("vtk", "grid", """# vtk DataFile Version 5.1
a grid
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 2 2 2
ORIGIN 0 0 -1
SPACING 1 .5 1
POINT_DATA 8
FIELD FieldData 1
s 1 8 double
0 1 2 3 4 5 6 7
METADATA
INFORMATION 0

""")
    places, heat = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1), struct.pack("<4d", 0, 1, 2, 2.5)
    write("vtk", "binary", b"# vtk DataFile Version 3.0\nbytes\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n" +
          struct.pack(">12f", *struct.unpack("<12f", places)) + b"\nCELLS 1 5\n" + struct.pack(">5i", 4, 0, 1, 2, 3) +
          b"\nCELL_TYPES 1\n" + struct.pack(">i", 10) + b"\nCELL_DATA 1\nSCALARS part int\nLOOKUP_TABLE default\n" +
          struct.pack(">i", 7) + b"\nPOINT_DATA 4\nSCALARS heat double\nLOOKUP_TABLE default\n" +
          struct.pack(">4d", *struct.unpack("<4d", heat)) + b"\n")
    # What is packed unpacks to itself in the fuzzer.
    for packed in (False, True):
        data, tags = b"", {}
        for name, content in (("", places), ("connectivity", struct.pack("<4q", 0, 1, 2, 3)), ("offsets", struct.pack("<i", 4)),
                              ("types", b"\x0a"), ("heat", heat)):
            kind = {"": "Float32", "connectivity": "Int64", "offsets": "Int32", "types": "UInt8", "heat": "Float64"}[name]
            stored = struct.pack("<4I", 1, len(content), 0, len(content)) if packed else struct.pack("<I", len(content))
            tags[name] = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{1 if name else 3}" format='
            if packed:
                tags[name] += f'"appended" offset="{len(data)}"/>'
                data += stored + content
            else:
                tags[name] += f'"binary">{base64.b64encode(stored + content).decode()}</DataArray>'
        write("vtk", "xml-appended" if packed else "xml", (
            '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" byte_order="LittleEndian"' +
            (' compressor="vtkZLibDataCompressor"' if packed else "") + '><UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1">'
            f'<Points>{tags[""]}</Points><Cells>{tags["connectivity"]}{tags["offsets"]}{tags["types"]}</Cells><PointData>{tags["heat"]}'
            '</PointData></Piece></UnstructuredGrid>' + ('<AppendedData encoding="raw">_' if packed else "")).encode() + data +
            (b"</AppendedData>" if packed else b"") + b"</VTKFile>")

    head = "NRRD0004\n# seed\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nspace origin: (0,0,1)\n"
    write("nrrd", "raw", (head + "spacings: 1 2 3\nencoding: raw\n\n").encode() + bytes(range(8)))
    write("nrrd", "text", head + "space directions: (0,1,0) (1,0,0) (0,0,2)\nencoding: ascii\nkey:=value\n\n0 1 2 3 4 5 6 7\n")
    write("nrrd", "gzip", (head + "spacings: 1 2 3\nencoding: gzip\n\n").encode() + bytes(range(8)))
    write("nrrd", "detached", head + "encoding: raw\nbyte skip: 56\ndata file: x.raw\n")


def models():
    write("obj", "all", """# a comment
mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0.5
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/1/1 4/2/1
f 1 2 -1 \\
 -2
l 1 2
t crease 2/1/0 0 1 2.5
t corner 1/1/0 3 4
t hole 1/0/0 1
t interpolateboundary 1/0/0 2
""")
    write("mtl", "all", "newmtl red\nNs 225\nKa 1 1 1\nKd 0.8 0.1 1e-1\nKs 0.5 0.5 0.5\nd 0.5\n\nnewmtl b\nKd 1\n"
          "map_Kd -s 1 1 1 -clamp on brick wall.png\nmap_Bump -bm 2 b.png\n")
    corners = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0) + struct.pack("<6H", 0, 1, 2, 2, 1, 3)
    times = struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 1, 0, 0)
    data = corners + times
    gltf = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2, 3]}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}},
        "nodes": [{"mesh": 0, "name": "mirror", "children": [1], "scale": [1, 2, 1]},
                  {"mesh": 0, "rotation": [0, 0, 0, 1], "translation": [1, 2, 3]},
                  {"camera": 0, "translation": [0, 0, 4]}, {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 1, "roughnessFactor": 0}}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                        "samplers": [{"input": 2, "output": 3}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
                      {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
                        {"buffer": 0, "byteOffset": 60, "byteLength": 8}, {"buffer": 0, "byteOffset": 68, "byteLength": 24}],
        "buffers": [{"byteLength": len(data)}],
    }
    document = text(gltf).encode()
    document += b" " * (-len(document) % 4)
    write("gltf", "room.glb", b"glTF" + struct.pack("<II", 2, 28 + len(document) + len(data))
          + struct.pack("<I", len(document)) + b"JSON" + document + struct.pack("<I", len(data)) + b"BIN\0" + data)
    gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    write("gltf", "room.gltf", text(gltf))
    instances = json.loads(text(gltf))
    instances["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    instances["extensionsUsed"] += instances["extensionsRequired"]
    instances["nodes"][1]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0, "SCALE": 0}}}
    write("gltf", "instances.gltf", text(instances))
    bad_models(gltf, data)


def bad_models(gltf, data):
    """The room, each with one thing that must be refused; tests/fuzz/replay_test.cpp has the reasons."""
    def refused(name, change):
        room = json.loads(text(gltf))
        change(room)
        write("gltf", f"refused-{name}.gltf", text(room))

    def embedded(content, **more):
        return {"uri": "data:application/octet-stream;base64," + base64.b64encode(content).decode(), "byteLength": len(content)} | more

    none = struct.pack("<f", float("nan"))
    short = gltf["buffers"][0]["uri"]
    refused("buffer-too-short", lambda room: room["buffers"][0].update(byteLength=len(data) + 4))
    refused("buffer-missing", lambda room: room["buffers"][0].update(uri="none.bin"))
    refused("not-base64", lambda room: room["buffers"][0].update(uri=short.replace(";base64,", ",")))
    refused("view-beyond-buffer", lambda room: room["bufferViews"][3].update(byteLength=4096))
    refused("nan-in-animation", lambda room: room["buffers"].__setitem__(0, embedded(data[:-4] + none)))
    refused("nan-in-times", lambda room: room["buffers"].__setitem__(0, embedded(data[:64] + none + data[68:])))
    refused("cyclic-nodes", lambda room: room["nodes"][1].update(children=[0]))
    refused("two-parents", lambda room: room["nodes"][3].update(children=[1]))
    refused("unknown-extension", lambda room: room.update(extensionsRequired=["EXT_of_tomorrow"]))


def exr(channels, zipped):
    """A scan-line OpenEXR of 3 x 2 pixels (Technical Introduction to OpenEXR)."""
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    window = struct.pack("<4i", 0, 0, 2, 1)
    types = {"R": 2, "G": 2, "B": 2, "A": 1, "optic.object": 0}
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iiii", types[name], 0, 1, 1) for name in sorted(channels)) + b"\0"
    header = (b"\x76\x2f\x31\x01\x02\0\0\0" + attribute("channels", "chlist", listed)
              + attribute("compression", "compression", bytes([3 if zipped else 0]))
              + attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
              + attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
              + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
              + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
              + attribute("trilens:camera", "string", b"c") + b"\0")
    def row(y):
        parts = {2: lambda: struct.pack("<3f", 0.1 + y, 0.5, 2), 1: lambda: struct.pack("<3e", 1, 1, 0), 0: lambda: struct.pack("<3I", 1, 2, 0xffffffff)}
        return b"".join(parts[types[name]]() for name in sorted(channels))
    if zipped:
        raw = row(0) + row(1)
        parted = raw[0::2] + raw[1::2]
        delta = bytes([parted[0]]) + bytes((b - a + 128) & 255 for a, b in zip(parted, parted[1:]))
        packed = zlib.compress(delta)
        blocks = [(0, packed if len(packed) < len(raw) else raw)]
    else:
        blocks = [(0, row(0)), (1, row(1))]
    at = len(header) + 8 * len(blocks)
    table, body = b"", b""
    for y, block in blocks:
        table += struct.pack("<Q", at + len(body))
        body += struct.pack("<ii", y, len(block)) + block
    return header + table + body


def png(bits, colour, extra=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    samples = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    rows = b"".join(b"\0" + bytes((17 * i) & 255 for i in range((3 * samples * bits + 7) // 8)) for _ in range(2))
    palette = chunk(b"PLTE", bytes(range(48))) if colour == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 3, 2, bits, colour, 0, 0, 0)) + extra + palette
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def pictures():
    write("exr", "plain", exr(["R", "G", "B"], False))
    write("exr", "zip", exr(["R", "G", "B", "A", "optic.object"], True))
    for bits, colour in ((8, 2), (8, 6), (8, 0), (16, 2), (4, 3)):
        write("png", f"bits{bits}-colour{colour}", png(bits, colour))


def studies():
    write("sweep", "all", text({"version": 1, "title": "All", "scenes": ["scene.json"], "zip": False, "over": [
        {"axis": "resolution", "values": "1..8:x2"}, {"axis": "engine", "values": ["exact", "facets"]}]}))
    write("test", "golden", text({"against": ["golden", "truth"], "tags": ["fast"], "fail": 0.01, "max": {"rmse": 0.1}}))
    write("test", "resolutions", text({"against": ["facets"], "resolution": [2, 4, 8], "set": {"/film/width": 16}}))
    write("report", "plain", "ball\nlens\nTwo balls\ntrilens sweep run a.json\n")
    write("report", "marked-up", "<b>ball</b>\n</script><script>alert(1)</script>\n<!-- \"&amp;' -->\n$(ls) | `ls` <tt>\n")
    write("report", "alike", "all\nall\n\n\n")
    write("report", "letters", "Spiegelkügelchen 球 \u202e\n,;\"\t\n\\%_&#{}\n{} {0} {1} {{\n")
    with tempfile.TemporaryDirectory() as place:
        (pathlib.Path(place) / "small.json").write_text(text(SMALL))
        subprocess.run([PROGRAM, "sweep", "run", "small.json", "--over", "resolution=1", "-o", "made", "-q"], check=True, cwd=place)
        failed = text({"id": "n0001", "error": "it failed", "exit_code": 5})
        parts = [(pathlib.Path(place) / "made" / name).read_text() for name in ("manifest.json", "plan.jsonl")]
        write("run", "one", "\n---\n".join([*parts, failed]).replace(place, "/tmp/seed"))


def random_bytes():
    for seed in range(12):
        write("laws", f"random{seed:02}", random.Random(seed).randbytes(160))
        if seed not in (4, 10):  # whose lights take many seconds
            write("caustics", f"random{seed:02}", random.Random(100 + seed).randbytes(160))
        write("maps", f"random{seed:02}", random.Random(400 + seed).randbytes(160))
        write("radiosity", f"random{seed:02}", random.Random(300 + seed).randbytes(160))
        write("terrain", f"random{seed:02}", random.Random(200 + seed).randbytes(400))
    for seed in range(6):
        write("suite", f"random{seed:02}", random.Random(600 + seed).randbytes(165))
    for seed in (3, 11, 12, 13, 17, 19, 21, 22):  # that see enough of their objects
        write("fit", f"random{seed:02}", random.Random(500 + seed).randbytes(200))


for make in (scenes, tables, lenses, volumes, models, pictures, studies, random_bytes):
    make()
