"""One renderer asked from eight threads at once, and from a process that was forked: the answers of one thread."""
import os
import random
import threading

import numpy as np

import trilens

THREADS, ROUNDS = 8, 6


def questions(renderer):
    """What may be asked, each with a name; all of it deterministic."""
    points = np.array([[0.5, -0.5, 1.5], [-1.0, 0.25, 1.0], [0.1, 0.7, 2.0]])
    truth, image = renderer.trace(), renderer.render(4)

    def rows(found):
        return {name: np.array(found[name]) for name in ("x", "y", "t")}

    return {
        "render": lambda: {"rgb": renderer.render(4).rgb()},
        "trace": lambda: {"rgb": renderer.trace().rgb()},
        "window": lambda: {"rgb": renderer.render(8, window=(8, 4, 40, 30)).rgb()},
        "project": lambda: rows(renderer.project(points)),
        "compare": lambda: {"mean": np.array(trilens.compare(truth, image).displacement.mean)},
    }


def same(a, b):
    return a.keys() == b.keys() and all(np.array_equal(a[key], b[key], equal_nan=True) for key in a)


def test_eight_threads_get_the_answers_of_one(renderer):
    ask = questions(renderer)
    expected = {name: one() for name, one in ask.items()}
    wrong = []

    def work(seed):
        draws = random.Random(seed)
        for _ in range(ROUNDS):
            name = draws.choice(sorted(ask))
            try:
                if not same(ask[name](), expected[name]):
                    wrong.append((seed, name, "another answer"))
            except Exception as error:  # noqa: BLE001
                wrong.append((seed, name, repr(error)))

    team = [threading.Thread(target=work, args=(seed,)) for seed in range(THREADS)]
    for one in team:
        one.start()
    for one in team:
        one.join(300)
    assert not any(one.is_alive() for one in team)
    assert wrong == []


def test_bad_questions_of_many_threads_each_get_their_own_error(renderer):
    found = [None] * THREADS

    def work(k):
        try:
            renderer.render(4, camera=f"no camera {k}")
        except trilens.Error as error:
            found[k] = str(error)

    team = [threading.Thread(target=work, args=(k,)) for k in range(THREADS)]
    for one in team:
        one.start()
    for one in team:
        one.join(60)
    assert all(f"no camera {k}" in (found[k] or "") for k in range(THREADS)), found


def test_a_forked_process_draws_too(renderer):
    """As multiprocessing and web servers fork, after the parent has drawn."""
    expected = renderer.render(4).rgb()
    child = os.fork()
    if child == 0:
        try:
            os._exit(0 if np.array_equal(renderer.render(4).rgb(), expected) else 1)
        except BaseException:
            os._exit(2)
    for _ in range(600):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        threading.Event().wait(0.1)
    else:
        os.kill(child, 9)
        os.waitpid(child, 0)
        raise AssertionError("the forked process has not ended in a minute")
    assert os.waitstatus_to_exitcode(status) == 0
