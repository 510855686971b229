"""Pictures in a viewer that speaks tev's protocol, while they are drawn: by the command and by Renderer."""
import socket
import struct
import threading

import numpy as np
import pytest

import trilens
from conftest import SMALL, SOURCE, size_options


class Viewer:
    """Takes connections one after the other, and hangs up after `most` bytes of each."""

    def __init__(self, most=None):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.most, self.bytes = most, b""
        self.thread = threading.Thread(target=self.take, daemon=True)
        self.thread.start()

    def take(self):
        connection, _ = self.listener.accept()
        self.listener.close()
        with connection:
            while (some := connection.recv(65536 if self.most is None else self.most)):
                self.bytes += some
                if self.most is not None:
                    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                    return

    def pictures(self):
        self.thread.join(30)
        shown, rest = {}, self.bytes
        while rest:
            size, operation = struct.unpack_from("<IB", rest)
            body, rest = rest[6:size], rest[size:]
            name, body = body.split(b"\0", 1)
            if operation == 4:
                width, height, count = struct.unpack_from("<iii", body)
                names = body[12:].split(b"\0")[:count]
                shown[name.decode()] = {one.decode(): np.full((height, width), np.nan, np.float32) for one in names}
                continue
            assert operation == 6
            count, = struct.unpack_from("<i", body)
            *names, body = body[4:].split(b"\0", count)
            x, y, width, height = struct.unpack_from("<iiii", body)
            values = np.frombuffer(body[16 + 16 * count:], "<f4").reshape(count, height, width)
            for one, part in zip(names, values):
                shown[name.decode()][one.decode()][y:y + height, x:x + width] = part
        return shown


@pytest.mark.parametrize("way", ["render", "trace"])
def test_a_viewer_shows_what_is_drawn(renderer, way, tmp_path):
    viewer = Viewer()
    image = getattr(renderer, way)(display_server=viewer.address)
    (name, shown), = viewer.pictures().items()
    assert name == way and {"R", "G", "B", "A", "Z", "reflectP.X"} <= set(shown)
    for channel, values in shown.items():
        np.testing.assert_array_equal(values, image[channel], err_msg=channel)
    plain = getattr(renderer, way)()
    for channel in shown:
        np.testing.assert_array_equal(plain[channel], image[channel], err_msg=channel)

    viewer = Viewer()
    file = tmp_path / "picture.exr"
    getattr(renderer, way)(file=file, display_server=viewer.address)
    np.testing.assert_array_equal(viewer.pictures()[str(file)]["G"], plain["G"])
    np.testing.assert_array_equal(trilens.read_image(file)["G"], plain["G"])


def test_a_viewer_that_goes_away_is_one_warning(renderer):
    told = []
    image = renderer.render(display_server=Viewer(most=100).address, warn=told.append)
    assert len([one for one in told if "went away" in one]) == 1, told
    np.testing.assert_array_equal(image["R"], renderer.render()["R"])
    with pytest.raises(trilens.OutputError, match="no display server answers"):
        renderer.render(display_server="127.0.0.1:1")
    with pytest.raises(trilens.UsageError, match="HOST:PORT"):
        renderer.render(display_server="localhost")


def test_the_command_shows_pictures_and_comparisons(renderer, command, tmp_path):
    truth, mine = tmp_path / "truth.exr", tmp_path / "mine.exr"
    renderer.trace(file=truth)
    viewer = Viewer()
    code, _ = command("render", SOURCE / "scenes/sphere.json", *size_options(SMALL), "-o", mine, "--display-server",
                      viewer.address)
    assert code == 0 and viewer.pictures()[str(mine)]["R"].shape == (96, 128)
    viewer = Viewer()
    code, _ = command("compare", truth, mine, "--max", "lost_percent=100", "--display-server", viewer.address)
    shown = viewer.pictures()
    assert code == 0 and set(shown) == {str(truth), str(mine), "difference"}
    np.testing.assert_array_equal(shown["difference"]["G"], shown[str(mine)]["G"] - shown[str(truth)]["G"])
    code, answer = command("compare", truth, mine, "--display-server", "127.0.0.1:1")
    assert code == 4 and "no display server answers" in str(answer["errors"])
    code, answer = command("render", SOURCE / "scenes/sphere.json", "-o", tmp_path / "x.svg", "--display-server",
                           "127.0.0.1:1")
    assert code == 2 and "--display-server" in str(answer["errors"])
