"""Work runs without the GIL, from any thread, with the same result."""
import concurrent.futures
import sys
import threading
import time

import numpy as np
import pytest

import trilens
from conftest import SOURCE


@pytest.fixture
def no_switches():
    """Threads change places only where the GIL is given up."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(60)
    yield
    sys.setswitchinterval(interval)


def ticks_during(work):
    """How often another thread ran between the work's start and its end."""
    ticks, done = [0], False

    def tick():
        while not done:
            ticks[0] += 1
            time.sleep(0)

    ticker = threading.Thread(target=tick)
    ticker.start()
    while not ticks[0]:
        time.sleep(0)
    before = ticks[0]
    work()
    during = ticks[0] - before
    done = True
    ticker.join()
    return during


def test_other_threads_run_while_trilens_works(no_switches, tmp_path, image, truth):
    scene = trilens.load_scene(SOURCE / "scenes/sphere.json", {"/film/width": 320, "/film/height": 240})
    renderer = trilens.Renderer(scene)
    points = np.random.default_rng(1).uniform(-1, 2, (3000, 3))
    cage = trilens.limit_surface([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2, 3]])
    work = {
        "render": lambda: renderer.render(resolution=8),
        "trace": renderer.trace,
        "project": lambda: renderer.project(points),
        "compare": lambda: trilens.compare(truth, image),
        "save": lambda: image.save(tmp_path / "image.exr"),
        "load": lambda: trilens.load_scene(SOURCE / "scenes/torus.json"),
        "grid": lambda: cage.grid(200),
    }
    # A busy machine may wake the other thread too late: it has many chances, each impossible with the GIL kept.
    for name, call in work.items():
        assert any(ticks_during(call) > 0 for _ in range(200)), name


def test_the_other_thread_does_not_run_while_the_gil_is_kept(no_switches):
    """What the test above counts is real: plain Python work lets nobody in."""
    assert not any(ticks_during(lambda: sum(range(200000))) for _ in range(20))


def test_one_renderer_draws_in_several_threads_at_once(renderer, image):
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for drawn in pool.map(lambda _: renderer.render(resolution=6), range(8)):
            assert all(drawn[name].tobytes() == image[name].tobytes() for name in image)


def test_callbacks_work_from_threads_that_are_not_the_main_one(renderer):
    told = []
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda _: renderer.render(resolution=2, progress=lambda done, job: told.append(done)), range(2)))
    assert told.count(1) == 2


def test_pictures_do_not_depend_on_the_number_of_threads(renderer, image):
    assert trilens.threads() >= 1
    try:
        trilens.set_threads(1)
        assert trilens.threads() == 1
        drawn = renderer.render(resolution=6)
    finally:
        trilens.set_threads(0)
    assert all(drawn[name].tobytes() == image[name].tobytes() for name in image)
    with pytest.raises(trilens.UsageError):
        trilens.set_threads(-1)
