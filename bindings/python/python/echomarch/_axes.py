"""Conversion between the axes of scene files and those of pyfar, SOFA and ambisonics."""

from __future__ import annotations

from typing import Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _arguments
from ._errors import SettingsError

AXES = ("echomarch", "pyfar")

_VECTORS = "an array of numbers with 3 columns"


def checked(axes: str) -> str:
    """Return the name of the axes after a check."""
    if not isinstance(axes, str) or axes not in AXES:
        raise SettingsError(f"there are no axes {axes!r}: use echomarch or pyfar")
    return axes


def to_pyfar(vectors: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Convert vectors from the axes of scene files to those of pyfar.

    Parameters
    ----------
    vectors : array_like, shape (..., 3)
        x to the right, y up, z backwards (the default view is along −z), in any unit.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        x ahead, y to the left, z up.
    """
    given = _vectors(vectors)
    return np.stack([-given[..., 2], -given[..., 0], given[..., 1]], axis=-1) + 0.0


def from_pyfar(vectors: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Convert vectors from the axes of pyfar to those of scene files.

    Parameters
    ----------
    vectors : array_like, shape (..., 3)
        x ahead, y to the left, z up, in any unit.

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        x to the right, y up, z backwards.
    """
    given = _vectors(vectors)
    return np.stack([-given[..., 1], given[..., 2], -given[..., 0]], axis=-1) + 0.0


def _vectors(given: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return an array of vectors after a check."""
    try:
        vectors = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise _arguments.refused("vectors", _VECTORS, given) from None
    if vectors.shape[-1:] != (3,):
        raise _arguments.refused("vectors", _VECTORS, given)
    return vectors


def given_in(axes: str, vectors: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Convert vectors from these axes to those of scene files."""
    given = np.asarray(vectors, dtype=np.float64)
    return from_pyfar(given) if axes == "pyfar" else given


def shown_in(axes: str, vectors: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Convert vectors from the axes of scene files to these axes."""
    given = np.asarray(vectors, dtype=np.float64)
    return to_pyfar(given) if axes == "pyfar" else given


def yaw_and_pitch(view: Sequence[float]) -> Tuple[float, float]:
    """Return yaw and pitch in degrees of a direction in the axes of scene files."""
    x, y, z = view
    if x == y == z == 0.0:
        raise SettingsError("a view must not be (0, 0, 0)")
    yaw = np.degrees(np.arctan2(x, -z))
    return float(yaw), float(np.degrees(np.arctan2(y, np.hypot(x, z))))
