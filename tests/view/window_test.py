#!/usr/bin/python3
"""The viewer as a program: by a script in memory, in a window of OpenGL on a display of its own, and where it cannot.

    python3 window_test.py BUILD FOLDER      ends with 77 where Xvfb is missing"""
import json
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import sys
import threading
import zlib

from xvfb import NO_DISPLAY, display

BUILD, FOLDER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def trilens(*words, code=0, environment=NO_DISPLAY):
    run = subprocess.run([BUILD / "trilens", *map(str, words)], cwd=FOLDER, env=environment, capture_output=True, text=True,
                         stdin=subprocess.DEVNULL, timeout=300)
    assert run.returncode == code, (words, run.returncode, run.stdout[-500:], run.stderr[-500:])
    return run.stdout, run.stderr


def png(path):
    """Width, height and rows of RGB bytes of an 8-bit PNG; all five filters."""
    data, at, packed, head = path.read_bytes(), 8, b"", None
    while at < len(data):
        length, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + length]
        head = body if kind == b"IHDR" else head
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    width, height, step = int.from_bytes(head[:4], "big"), int.from_bytes(head[4:8], "big"), {2: 3, 6: 4}[head[9]]
    raw, rows, before, at = zlib.decompress(packed), [], bytearray(width * step), 0
    for _ in range(height):
        kind, row = raw[at], bytearray(raw[at + 1:at + 1 + width * step])
        at += 1 + width * step
        for i in range(len(row)):
            left, up, corner = (row[i - step], before[i], before[i - step]) if i >= step else (0, before[i], 0)
            if kind == 4:
                p = left + up - corner
                near = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
            row[i] = (row[i] + (0, left, up, (left + up) // 2, near if kind == 4 else 0)[kind]) & 255
        rows.append(row)
        before = row
    return width, height, rows, step


def difference(one, other):
    """The mean difference of bytes of two pictures, and the share of pixels that differ by more than 40."""
    (w, h, a, step_a), (w2, h2, b, step_b) = png(one), png(other)
    assert (w, h) == (w2, h2)
    total = far = 0
    for row_a, row_b in zip(a, b):
        for x in range(w):
            d = [abs(row_a[x * step_a + c] - row_b[x * step_b + c]) for c in range(3)]
            total += sum(d)
            far += max(d) > 40
    return total / (3 * w * h), far / (w * h)


def in_memory(scene, steps):
    """Mouse and script without a window: what they lead to, and what is saved."""
    out, _ = trilens("view", scene, "--script", steps, "--screenshot", "memory.png", "--window-size", "800x500", "--json")
    answer = json.loads(out)
    assert answer["opengl"] == "" and answer["error"] == "" and answer["written"] == ["memory.png"], answer
    assert answer["first_picture_seconds"] > 0 and answer["shown"]["film"] == [96, 72], answer
    saved = json.loads((FOLDER / "turned.json").read_text())
    eye = json.loads((FOLDER / scene).read_text())["cameras"][0]["lookAt"]["eye"]
    assert saved["cameras"][0]["lookAt"]["eye"] != eye, "the mouse did not turn the camera"
    # The ctrl-click's path: in the middle of the picture stands the mirror ball.
    paths = answer["shown"]["pixel_paths"]
    assert paths[0]["path"] == "R" and paths[0]["corners"][0]["event"] == "eye", paths
    # The place that an alt-click picks is seen where it was clicked, after the ball.
    images = answer["shown"]["place_images"]
    assert any(image["path"] == "R" and image["visible"] for image in images), images
    return answer


def undone(scene):
    """A step of a script is one step of undo, however many frames it has."""
    steps = [{"orbit": [30, 5], "frames": 5}, {"dolly": 0.8, "frames": 3}, {"undo": 2}, {"save": "undone.json"}]
    (FOLDER / "undo.json").write_text(json.dumps(steps))
    trilens("view", scene, "--script", "undo.json", "--screenshot", "undone.png", "--window-size", "300x200")
    before = json.loads((FOLDER / scene).read_text())
    assert json.loads((FOLDER / "undone.json").read_text())["cameras"] == before["cameras"]


def refused(scene):
    """What the viewer says where it cannot show: each with its exit code."""
    _, err = trilens("view", scene, code=5)
    assert "no display" in err and "--script" in err, err
    _, err = trilens("view", "missing.json", "--screenshot", "none.png", code=3)
    assert "missing.json" in err, err
    (FOLDER / "bad.json").write_text('{"steps": [{"wait": "done"}, {"orbitt": [1, 2]}]}')
    _, err = trilens("view", scene, "--script", "bad.json", code=3)
    assert "/steps/1" in err and "orbit" in err, err
    trilens("view", scene, "--script", "bad.json", "--window-size", "0x3", code=2)
    assert not (FOLDER / "none.png").exists()


class DisplayServer(threading.Thread):
    """Takes one connection of tev's protocol: everything, or so many bytes and then hangs up hard."""

    def __init__(self, most=None):
        super().__init__(daemon=True)
        self.listener, self.most, self.bytes = socket.create_server(("127.0.0.1", 0)), most, b""
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.start()

    def run(self):
        connection, _ = self.listener.accept()
        self.listener.close()
        with connection:
            while some := connection.recv(65536 if self.most is None else self.most - len(self.bytes)):
                self.bytes += some
                if self.most is not None and len(self.bytes) >= self.most:
                    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                    return

    def messages(self):
        """(operation, what follows the name) of each message."""
        self.join(60)
        found, rest = [], self.bytes
        while rest:
            size, operation = struct.unpack_from("<IB", rest)
            found.append((operation, rest[6:size].split(b"\0", 1)[1]))
            rest = rest[size:]
        return found


def on_a_display_server(scene):
    """Pictures and facets go to a display server; one that goes away in the middle of a tile is a warning."""
    (FOLDER / "facets.json").write_text('[{"show": {"facets": true}}, {"wait": "done"}]')
    words = ["view", scene, "--script", "facets.json", "--display-server"]
    server = DisplayServer()
    out, _ = trilens(*words, server.address, "--json")
    assert json.loads(out)["warnings"] == []
    messages = server.messages()
    operations = [operation for operation, _ in messages]
    assert operations[:2] == [4, 6] and 8 in operations, operations
    assert struct.unpack_from("<ii", messages[0][1]) == (96, 72)
    lines = [body for operation, body in messages if operation == 8][-1]
    count, = struct.unpack_from("<xi", lines)
    # Each facet's edge: colour, path, from, to, stroke; ends on the film or a little beside it.
    assert count % 5 == 0 and count > 500, count
    for first in range(5, len(lines), 37):
        assert (lines[first], lines[first + 17], lines[first + 18], lines[first + 27], lines[first + 36]) == (4, 6, 10, 11, 5)
        ends = struct.unpack_from("<ff", lines, first + 19) + struct.unpack_from("<ff", lines, first + 28)
        assert all(-96 < end < 192 for end in ends), ends
    for most in (1, 40, 5000):
        (FOLDER / "turn.json").write_text('[{"wait": "done"}, {"orbit": [9, 0], "frames": 3}, {"wait": "done"}]')
        words[3] = "turn.json"
        out, _ = trilens(*words, DisplayServer(most).address, "--json")
        answer = json.loads(out)
        assert answer["error"] == "" and answer["shown"]["stage"] == "done"
        assert [one for one in answer["warnings"] if "went away" in one], answer["warnings"]
    trilens(*words, "127.0.0.1:1", code=4)
    trilens(*words, "localhost", code=2)


def in_window(scene, steps):
    """The same script in OpenGL shows the same window as in memory, but for how edges of glyphs are rounded."""
    if not shutil.which("Xvfb"):
        print("skipped: Xvfb is missing")
        sys.exit(77)
    with display() as environment:
        out, _ = trilens("view", scene, "--script", steps, "--screenshot", "window.png", "--window-size", "480x300", "--window",
                         "--json", environment=environment)
        answer = json.loads(out)
        assert answer["opengl"] != "" and answer["window_frames"] > 10, answer
        mean, far = difference(FOLDER / "memory-window.png", FOLDER / "window.png")
        assert mean < 2 and far < 0.02, (mean, far)
        _, err = trilens("view", scene, "--script", steps, "--window", code=5,
                         environment={**environment, "MESA_GL_VERSION_OVERRIDE": "2.1"})
        assert "OpenGL 3.2" in err and "--script" in err, err
        return mean, far


FOLDER.mkdir(parents=True, exist_ok=True)
scene_text = json.loads(re.sub(r"^\s*//.*$", "", trilens("scene", "example", "mirror-sphere")[0], flags=re.M))
scene_text["film"] = {"width": 96, "height": 72}
(FOLDER / "small.json").write_text(json.dumps(scene_text))
(FOLDER / "mouse.json").write_text(json.dumps({"steps": [
    {"click": [231, 228], "keys": "ctrl"}, {"wait": "done"}, {"click": [231, 144], "keys": "alt"}, {"wait": "done"},
    {"drag": [[231, 144], [241, 146]], "frames": 4}, {"drag": [[200, 100], [204, 100]], "button": "middle"},
    {"drag": [[200, 100], [204, 100]], "button": "right"}, {"wheel": [231, 144, 1]},
    {"save": "turned.json"}, {"wait": "done"}]}))
(FOLDER / "steps.json").write_text(json.dumps({"steps": [
    {"show": {"birdsEye": True, "facets": True, "wipe": 0.5}}, {"orbit": [20, 5], "frames": 12}, {"pixel": [48, 36]},
    {"wait": "done"}]}))
in_memory("small.json", "mouse.json")
undone("small.json")
refused("small.json")
on_a_display_server("small.json")
trilens("view", "small.json", "--script", "steps.json", "--screenshot", "memory-window.png", "--window-size", "480x300")
print("in memory and in a window: mean difference %.2f of 255, %.2f %% of pixels far off" %
      (lambda found: (found[0], 100 * found[1]))(in_window("small.json", "steps.json")))
