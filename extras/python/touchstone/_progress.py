"""How long work shows its progress."""

import atexit
import sys
from typing import Any, Callable, Literal, Union

from . import _touchstone
from ._tables import escape

#: what, done, total; total is 0 where it is unknown.
Report = Callable[[str, int, int], Any]


def _in_notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and "IPKernelApp" in getattr(shell, "config", {})


class _Line:
    """One line of a notebook's cell that is drawn anew; a new cell has a line of its own."""

    def __init__(self) -> None:
        self._cell: Any = None
        self._handle: Any = None

    def __call__(self, what: str, done: int, total: int) -> None:
        from IPython import get_ipython
        from IPython.display import HTML, display

        share = f' <progress value="{done}" max="{total}"></progress> {done}/{total}' if total else f" {done}"
        html = HTML(f"<small>{escape(what)}:{share}</small>")
        cell = get_ipython().execution_count
        if self._handle is None or self._cell != cell:
            self._cell, self._handle = cell, display(html, display_id=True)
        else:
            self._handle.update(html)


def progress(call: Union[Report, None, Literal["auto"]] = "auto") -> None:
    """Chooses how long work shows its progress.

    Args:
        call: `call(what, done, total)`, total 0 where it is unknown, at most ten times a second; None for nothing;
            "auto" (the default) draws a bar in a notebook, and on a terminal what the program draws there.
    """
    if call == "auto":
        call = _Line() if _in_notebook() else None
    _touchstone.report_progress(call)


progress()
atexit.register(_touchstone.report_progress, None)
