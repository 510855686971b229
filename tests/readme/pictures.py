"""What can be told of a picture file without a library: its kind, its size, and whether it shows more than one colour."""
import re
import struct
import xml.etree.ElementTree

# Deflated bytes over raw bytes of a frame: a picture of one colour takes less than a hundredth of this.
LEAST_SHARE = 0.003


class Blank(Exception):
    """A picture that shows nothing, or that is none; says why."""


def png_frames(data, name):
    """(width, height, deflated bytes, raw bytes) of each frame of a PNG or an APNG."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise Blank(f"{name} is no PNG")
    frames, at, channels, bits = [], 8, 0, 0
    while at + 8 <= len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        at += 12 + length
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", body[:10])
            channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
            size = (width, height)
        elif kind == b"fcTL":
            size = struct.unpack(">II", body[4:12])
            frames.append([*size, 0])
        elif kind in (b"IDAT", b"fdAT"):
            if not frames:
                frames.append([*size, 0])
            frames[-1][2] += length - (4 if kind == b"fdAT" else 0)
    if not frames:
        raise Blank(f"{name} has no frame")
    return [(w, h, deflated, w * h * channels * bits // 8) for w, h, deflated in frames]


def require_png(data, name):
    """Every frame shows more than one colour."""
    for i, (width, height, deflated, raw) in enumerate(png_frames(data, name)):
        if width * height < 64 or deflated < LEAST_SHARE * raw:
            raise Blank(f"{name}: frame {i} of {width} x {height} shows nothing: {deflated} of {raw} bytes")


def require_file(path):
    """A picture that a page may show, or that a command wrote, is one and shows something."""
    data = path.read_bytes()
    if path.suffix in (".png", ".apng"):
        require_png(data, path.name)
    elif path.suffix == ".svg":
        drawn = [e for e in xml.etree.ElementTree.fromstring(data).iter()
                 if re.sub(r"{.*}", "", e.tag) in ("path", "line", "circle", "polyline", "rect", "polygon")]
        if len(drawn) < 3:
            raise Blank(f"{path.name} draws {len(drawn)} shapes")
    elif path.suffix == ".jpg":
        if data[:3] != b"\xff\xd8\xff" or data[-2:] != b"\xff\xd9" or len(data) < 4000:
            raise Blank(f"{path.name} is no whole JPEG")
        if b"oiiotool " in data:
            raise Blank(f"{path.name} holds the command that wrote it, with its maker's paths: oiiotool --nosoftwareattrib")
    elif path.suffix == ".exr":
        if data[:4] != b"\x76\x2f\x31\x01" or len(data) < 4000:
            raise Blank(f"{path.name} is no OpenEXR picture")
    elif not data:
        raise Blank(f"{path.name} is empty")
