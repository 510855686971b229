"""The page with the projector in it, in a headless Chromium: it draws, a drag changes the picture, nothing is said on the console.

page_test.py [PICTURE.png]: builds the page by scripts/browser first; exit code 77: there is no Emscripten or no Chromium. Talks the DevTools protocol over pipes.
"""

import base64
import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time


class Browser:
    """One page of a headless Chromium."""

    def __init__(self, program, profile):
        to_read, ours = os.pipe()
        theirs, to_write = os.pipe()
        command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-pipe",
                   f"--user-data-dir={profile}", "--window-size=660,740", "about:blank"]

        def pipes():
            # Copies first: either end may lie where another is to go.
            ends = os.dup(to_read), os.dup(to_write)
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(command, preexec_fn=pipes, close_fds=False, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, start_new_session=True)
        os.close(to_read)
        os.close(to_write)
        self.out, self.inward, self.rest, self.number, self.said = ours, theirs, b"", 0, []
        targets = self.call("Target.getTargets", session=None)["targetInfos"]
        target = next(one["targetId"] for one in targets if one["type"] == "page")
        self.session = self.call("Target.attachToTarget", {"targetId": target, "flatten": True}, session=None)["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.call(f"{domain}.enable")

    def message(self):
        while b"\0" not in self.rest:
            more = os.read(self.inward, 1 << 20)
            assert more, "Chromium has ended"
            self.rest += more
        one, self.rest = self.rest.split(b"\0", 1)
        return json.loads(one)

    def call(self, method, params=None, session=""):
        self.number += 1
        request = {"id": self.number, "method": method, "params": params or {}}
        if session is not None:
            request["sessionId"] = session or self.session
        os.write(self.out, json.dumps(request).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("method") in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"):
                self.said.append(answer["params"])
            if answer.get("id") == self.number:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]

    def value(self, expression):
        return self.call("Runtime.evaluate", {"expression": expression, "returnByValue": True})["result"].get("value")

    def mouse(self, kind, x, y):
        self.call("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1,
                                               "buttons": 0 if kind == "mouseReleased" else 1})

    def end(self):
        """Asks Chromium to end, which ends what it started; its whole group is killed where it does not."""
        with contextlib.suppress(OSError):
            os.write(self.out, b'{"id": 0, "method": "Browser.close"}\0')
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(timeout=10)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


def wait(condition, what, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"not in {seconds} s: {what}"
        time.sleep(0.02)


def at_rest(browser):
    """Waits until the finest picture of what is asked for is there."""
    wait(lambda: browser.value("window.mirror?.side === 4 && !busy"), "the finest picture")


def picture(browser):
    return browser.value("document.getElementById('picture').toDataURL()")


def drag(browser, start, way, steps=12):
    browser.mouse("mousePressed", *start)
    wait(lambda: browser.value("hand?.place !== undefined"), "the worker says what is under the mouse")
    for k in range(1, steps + 1):
        before = browser.value("window.mirror.frames")
        browser.mouse("mouseMoved", start[0] + way[0] * k / steps, start[1] + way[1] * k / steps)
        wait(lambda: browser.value("window.mirror.frames") > before, "a picture of the moved mouse")
    browser.mouse("mouseReleased", start[0] + way[0], start[1] + way[1])
    at_rest(browser)


def main():
    program = shutil.which("chromium")
    if not program:
        print("skipped: there is no Chromium (apt install chromium)")
        return 77
    source = pathlib.Path(__file__).resolve().parents[2]
    built = subprocess.run([source / "scripts/browser"], stdout=subprocess.PIPE, text=True)
    if built.returncode:
        return built.returncode
    page = source / built.stdout.strip()
    assert page.stat().st_size < 2e6, "the page is larger than 2 MB"
    # A process of Chromium that is still dying may write into its profile while that is removed.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        try:
            browser.call("Page.navigate", {"url": page.as_uri()})
            at_rest(browser)
            box = browser.value("(b => [b.left, b.top, b.width, b.height])(document.getElementById('film').getBoundingClientRect())")
            at = lambda x, y: (box[0] + x * box[2], box[1] + y * box[3])
            colours = browser.value("new Set(new Uint32Array(document.getElementById('picture').getContext('2d')"
                                    ".getImageData(0, 0, 640, 480).data.buffer)).size")
            assert colours > 1000, f"{colours} colours"

            first, bulge = picture(browser), browser.value("window.mirror.view.bulge")
            drag(browser, at(0.5, 0.5), (0, 60))
            bent = picture(browser)
            assert bent != first, "a drag on the mirror changes nothing"
            assert browser.value("window.mirror.view.bulge") != bulge, "a drag on the mirror does not bend it"
            assert browser.value("window.mirror.view.azimuth") == -24, "a drag on the mirror walks"

            bulge = browser.value("window.mirror.view.bulge")
            drag(browser, at(0.04, 0.9), (90, 10))
            walked = picture(browser)
            assert walked != bent, "a drag beside the mirror changes nothing"
            assert browser.value("window.mirror.view.azimuth") != -24, "a drag beside the mirror does not walk"
            assert browser.value("window.mirror.view.bulge") == bulge, "a drag beside the mirror bends it"

            # Coarser facets show something else; the same facets show the same again.
            set_n = "(n => { const e = document.getElementById('n'); e.value = n; e.dispatchEvent(new Event('input')); })"
            browser.value(f"{set_n}(2)")
            at_rest(browser)
            assert picture(browser) != walked, "n changes nothing"
            browser.value(f"{set_n}(8); document.getElementById('facets').click()")
            at_rest(browser)
            assert picture(browser) == walked, "the same numbers give another picture"
            assert browser.value("new Uint32Array(document.getElementById('lines').getContext('2d')"
                                 ".getImageData(0, 0, 640, 480).data.buffer).some(x => x)"), "no lines of facets"
            if len(sys.argv) > 1:
                shot = browser.call("Page.captureScreenshot", {"format": "png"})["data"]
                pathlib.Path(sys.argv[1]).write_bytes(base64.b64decode(shot))
            said = [one for one in browser.said if one.get("type") != "log"]
            assert not said, f"said on the console: {said}"
            for side, what in ((0.5, "320x240"), (1, "640x480")):
                times = sorted(browser.value(f"window.mirror.milliseconds[{side}]"))
                if times:
                    print(f"{what}: {len(times)} pictures, median {times[len(times) // 2]:.0f} ms, "
                          f"{browser.value('window.mirror.workers')} workers")
        finally:
            browser.end()
    return 0


if __name__ == "__main__":
    sys.exit(main())
