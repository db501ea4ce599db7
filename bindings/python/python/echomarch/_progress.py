"""Progress of responses: calls of a function, a bar in a notebook, or lines on a terminal."""

from __future__ import annotations

import importlib
import sys
from typing import Any, Callable, NamedTuple, Optional, Union


class Progress(NamedTuple):
    """A round of a response with a requested accuracy."""

    waves: int
    """Number of waves for late arrivals of this round, those that end early included."""
    next_waves: Optional[int]
    """The same number for the next round; None after the last round."""
    accurate: int
    """Number of figures, over all bands, that have the accuracy."""
    defined: int
    """Number of figures, over all bands, that are defined."""

    @property
    def share(self) -> float:
        """The share of the figures that have the accuracy, 0 to 1; 1 after the last round."""
        if self.next_waves is None or self.defined == 0:
            return 1.0
        return self.accurate / self.defined


AnyProgress = Union[None, bool, Callable[[Any], Any]]

OnRound = Optional[Callable[[int, int, Optional[int], int, int], Any]]
"""Receives the number of listeners that a round completes, and the numbers of a :class:`Progress`."""


def is_notebook() -> bool:
    """Whether this code runs in a notebook, which can show a bar."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")


class Bar:
    """A bar in a notebook, or a line on standard error."""

    def __init__(self, label: str, in_notebook: bool) -> None:
        self._label = label
        self._handle: Any = None
        self._in_notebook = in_notebook

    def show(self, share: float, text: str) -> None:
        """Show a share, 0 to 1, and a text."""
        if not self._in_notebook:
            end = "\n" if share >= 1.0 else ""
            print(f"\r{self._label}: {share:4.0%} {text}".ljust(79), end=end, file=sys.stderr, flush=True)
            return
        shown: Any = importlib.import_module("IPython.display")
        bar = shown.HTML(f'{self._label} <progress value="{share:.3f}" max="1"></progress> {text}')
        if self._handle is None:
            self._handle = shown.display(bar, display_id=True)
        else:
            self._handle.update(bar)


def of_rounds(progress: AnyProgress, label: str) -> OnRound:
    """Return the function that the extension module calls after each round; None for no progress."""
    if callable(progress):
        return lambda _, *numbers: progress(Progress(*numbers))
    bar = of_counts(progress, label)
    if bar is None:
        return None

    def show(_: int, *numbers: Any) -> None:
        done = Progress(*numbers)
        bar.show(done.share, f"{done.waves} waves")

    return show


def of_counts(progress: AnyProgress, label: str) -> Optional[Bar]:
    """Return a bar, or None. `None` shows a bar in notebooks only, True also on a terminal, False never."""
    if progress is False or (progress is None and not is_notebook()):
        return None
    return Bar(label, is_notebook())
