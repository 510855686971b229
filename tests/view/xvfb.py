"""A display of its own for a window, by Xvfb, with OpenGL by software."""
import contextlib
import os
import subprocess

#: This process's environment without a display.
NO_DISPLAY = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}


@contextlib.contextmanager
def display():
    """The environment of a program that is to open its window there; needs Xvfb in the path."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x900x24", "-nolisten", "tcp"], pass_fds=[write],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        os.close(write)
        with os.fdopen(read) as number:
            yield {**NO_DISPLAY, "DISPLAY": ":" + number.readline().strip(), "LIBGL_ALWAYS_SOFTWARE": "1"}
    finally:
        server.terminate()
        server.wait()
