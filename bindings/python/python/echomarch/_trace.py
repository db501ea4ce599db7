"""Frames: the balance of the sound at the two ears, as in the thesis."""

from __future__ import annotations

from typing import Any, NamedTuple

from . import _arguments, _echomarch
from ._response import AnyLabel, checked
from ._scene import Scene, chosen_pair


class Frame(NamedTuple):
    """The sound of one frame."""

    pan: float
    """Balance, from −1 (left) over 0 (the middle) to 1 (right)."""
    left: float
    """Sum of the waves at the left ear."""
    right: float
    """Sum of the waves at the right ear."""
    listener_hits: int
    """Number of waves that reached the listener."""
    dead: int
    """Number of waves that left the scene."""
    travelling: int
    """Number of waves still in flight after the last iteration."""
    milliseconds: float
    """Time of the frame in ms."""
    renderer: str
    """Name of the OpenGL renderer."""


def trace(
    scene: Scene,
    source: AnyLabel = None,
    listener: AnyLabel = None,
    *,
    waves: int = 65_536,
    iterations: int = 8,
    seed: int = 1,
    profile: str = "hybrid",
    directions: str = "random",
) -> Frame:
    """Trace one frame: the balance between the ears from the waves that reach the listener.

    Parameters
    ----------
    scene : Scene
        The scene.
    source, listener : str or int, optional
        Name or number (from 1); not needed if there is only one.
    waves : int
        Number of waves, 1 to 16,777,216.
    iterations : int
        Number of segments of each wave, 1 to 4095.
    seed : int
        Seed of the start directions.
    profile : {"hybrid", "march", "thesis"}
        The algorithm.
    directions : {"random", "fibonacci"}
        Start directions.

    Returns
    -------
    Frame
    """
    pair = chosen_pair(scene, source, listener)
    given = checked({"waves": waves, "seed": seed, "profile": profile, "directions": directions})
    if waves is None:
        raise _arguments.refused("waves", "a whole number of waves", waves)
    count = _arguments.whole("iterations", "a whole number of iterations", iterations)
    found: Any = _echomarch.trace(
        scene._raw, *pair, given["waves"], count, given["seed"], given["profile"], given["directions"]
    )
    return Frame(**found)
