"""Many responses: in this process, or in worker processes."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple, Union

from . import _arguments, _progress, _workers
from ._errors import SettingsError
from ._response import Response, settings_of_response, traced, warn
from ._scene import Scene, chosen_pair

Item = Union[Scene, Tuple[Scene, Union[str, int, None], Union[str, int, None]]]


class _Group(NamedTuple):
    """The items with the same scene and source. They are traced together."""

    scene: Scene
    source: int
    places: List[int]
    """The places of the items in the list of all items."""
    listeners: List[int]


def responses(
    items: Iterable[Item],
    workers: int = 1,
    *,
    progress: _progress.AnyProgress = None,
    **settings: Any,
) -> List[Response]:
    """Trace many responses, in the order of the items.

    Items with the same scene (the same object) and the same source are traced together: the waves of the source serve
    all its listeners. Each response then has the accuracy that it would have alone, but other random numbers than with
    :func:`response`. It depends on the listeners that are traced with it, and equals that of the program for these
    listeners.

    Parameters
    ----------
    items : iterable of Scene, or of (Scene, source, listener)
        :meth:`Scene.pairs` lists all pairs of a scene.
    workers : int
        Number of processes, each with its own OpenGL context and an equal share of the processor cores. With 1 the
        responses are traced in this process. A process traces all listeners of a source. The results do not depend on
        the number.
    progress : callable, bool or None
        A function that receives the number of completed responses; True, False and None as in :func:`response`.
    **settings
        The keyword arguments of :func:`response`. `time_limit` applies to each source.

    Returns
    -------
    list of Response

    Warns
    -----
    UserWarning
        As in :func:`response`.

    Raises
    ------
    WorkerError
        A worker process ended without a result.
    """
    if _arguments.whole("workers", "a whole number of processes", workers) < 1:
        raise SettingsError(f"workers must be 1 or more, not {workers}")
    given = settings_of_response(**settings)
    chosen = _checked(items)
    groups = _groups(chosen)
    for group in groups:
        warn(group.scene._raw.warnings_of_pairs(group.source, group.listeners))
    done = _Done(progress, len(chosen))
    if workers > 1 and len(groups) > 1:
        tasks = [("responses", group.scene, group.source, group.listeners, given) for group in groups]
        traced_groups = _workers.run(tasks, workers, lambda _, result: done.add(len(result)))
    else:
        traced_groups = [_here(group, given, done) for group in groups]
    in_order = {
        place: response
        for group, found in zip(groups, traced_groups)
        for place, response in zip(group.places, found)
    }
    found = [in_order[place] for place in range(len(chosen))]
    warn(text for response in found for text in response._heard.warnings())
    return found


def _checked(items: Any) -> List[Tuple[Any, ...]]:
    """Return the items as triples after a check."""
    takes = "a list of scenes or of (scene, source, listener), such as scene.pairs()"
    if isinstance(items, (str, bytes)) or not hasattr(items, "__iter__"):
        raise _arguments.refused("items", takes, items)
    chosen = [item if isinstance(item, tuple) else (item, None, None) for item in items]
    for item in chosen:
        if len(item) != 3:
            raise _arguments.refused("an item", "a scene or (scene, source, listener)", item)
    return chosen


def _groups(items: List[Tuple[Any, ...]]) -> List[_Group]:
    """Return the items by scene and source, in the order of their first items."""
    groups: Dict[Tuple[int, int], _Group] = {}
    for place, (scene, source, listener) in enumerate(items):
        source_index, listener_index = chosen_pair(scene, source, listener)
        new = _Group(scene, source_index, [], [])
        group = groups.setdefault((id(scene), source_index), new)
        group.places.append(place)
        group.listeners.append(listener_index)
    return list(groups.values())


def _here(group: _Group, given: Dict[str, Any], done: "_Done") -> List[Response]:
    """Trace a group in this process."""
    before = done.count

    def on_round(finished: int, *_: Any) -> None:
        if finished > 0:
            done.add(finished)

    found = traced(group.scene, group.source, group.listeners, given, on_round)
    # Rounds are reported only if an accuracy is requested.
    rest = before + len(found) - done.count
    if rest > 0:
        done.add(rest)
    return found


class _Done:
    """Tells the number of completed responses."""

    def __init__(self, progress: _progress.AnyProgress, of: int) -> None:
        self.count = 0
        self._of = of
        self._call = progress if callable(progress) else None
        self._bar: Optional[_progress.Bar] = None if self._call else _progress.of_counts(progress, "responses")

    def add(self, count: int) -> None:
        """Add completed responses."""
        self.count += count
        if self._call is not None:
            self._call(self.count)
        if self._bar is not None:
            self._bar.show(self.count / self._of, f"{self.count} of {self._of}")
