"""How far a long work is: a bar in a notebook, a line on a terminal, nothing elsewhere."""
import sys
import time

_INTERVAL = 0.1  # seconds between two updates


def _in_notebook():
    """Whether a kernel shows what is displayed; a shell on a terminal does not."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and hasattr(shell, "kernel")


class ProgressBar:
    """What progress=True calls: bar(done, job), done in 0..1."""

    def __init__(self):
        self._shown = None  # the notebook's display, once there is one
        self._last = None

    def __call__(self, done, job):
        now = time.monotonic()
        if done < 1 and self._last is not None and now - self._last < _INTERVAL:
            return
        self._last = now
        if _in_notebook():
            self._display(done, job)
        elif sys.stderr is not None and sys.stderr.isatty():
            sys.stderr.write(f"\r{job} {100 * done:3.0f} %" + ("\n" if done >= 1 else ""))
            sys.stderr.flush()

    def _display(self, done, job):
        from IPython.display import HTML, display

        bar = HTML(f'<progress max="1" value="{done:.3f}"></progress> {job} {100 * done:.0f} %')
        if self._shown is None:
            self._shown = display(bar, display_id=True)
        else:
            self._shown.update(bar)
