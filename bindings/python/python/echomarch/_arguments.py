"""Checks of the types of arguments: a refusal names the argument, what it takes, and what was given."""

from __future__ import annotations

import operator
import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from ._errors import SettingsError

_MOST_WHOLE = 2**32 - 1
"""The largest whole number that the extension module takes."""


def refused(name: str, takes: str, given: Any) -> SettingsError:
    """Return the exception for an argument that does not have the type or shape that it takes."""
    return SettingsError(f"{name} must be {takes}, not {given!r}")


def real(name: str, takes: str, given: Any) -> float:
    """Return a number after a check. `takes` says what it measures, with the unit: ``"a time in s"``."""
    try:
        if isinstance(given, (str, bytes)):
            raise TypeError
        return float(given)
    except (TypeError, ValueError, OverflowError):
        raise refused(name, takes, given) from None


def whole(name: str, takes: str, given: Any) -> int:
    """Return a whole number, 0 to 4294967295, after a check."""
    try:
        number = operator.index(given)
    except TypeError:
        raise refused(name, takes, given) from None
    if not 0 <= number <= _MOST_WHOLE:
        raise refused(name, takes, given)
    return number


def flag(name: str, given: Any) -> bool:
    """Return True or False after a check. NumPy's truth values count too."""
    if type(given).__name__ not in ("bool", "bool_"):
        raise refused(name, "True or False", given)
    return bool(given)


def text(name: str, takes: str, given: Any) -> str:
    """Return a text after a check."""
    if not isinstance(given, str):
        raise refused(name, takes, given)
    return given


def triple(name: str, takes: str, given: Any) -> Tuple[float, float, float]:
    """Return three numbers after a check."""
    takes = f"three numbers, {takes}"
    try:
        if isinstance(given, (str, bytes)):
            raise TypeError
        x, y, z = given
        return real(name, takes, x), real(name, takes, y), real(name, takes, z)
    except (TypeError, ValueError, SettingsError):
        raise refused(name, takes, given) from None


def shares(name: str, given: Any) -> List[float]:
    """Return the shares of the eight octave bands, given as one share of 0 to 1 or as eight, after a check."""
    takes = "one share of 0 to 1, or 8 for the octave bands"
    try:
        bands = [given] * 8 if np.ndim(given) == 0 else list(given)
        numbers = [real(name, takes, each) for each in bands]
    except (TypeError, ValueError):
        raise refused(name, takes, given) from None
    if len(numbers) != 8 or not all(0.0 <= each <= 1.0 for each in numbers):
        raise refused(name, takes, given)
    return numbers


def path(name: str, given: Any) -> str:
    """Return a path as a text after a check."""
    try:
        text = os.fspath(given)
    except TypeError:
        text = None
    if not isinstance(text, str) or "\0" in text:
        raise refused(name, "a path", given)
    return text


def mapping(name: str, takes: str, given: Any) -> Dict[str, Any]:
    """Return a dictionary with texts as keys after a check."""
    if not isinstance(given, Mapping) or not all(isinstance(key, str) for key in given):
        raise refused(name, takes, given)
    return dict(given)


def choice(name: str, choices: Sequence[str], given: Any) -> str:
    """Return one of a few words after a check."""
    if not isinstance(given, str) or given not in choices:
        raise refused(name, " or ".join(choices), given)
    return given


def optional_real(name: str, takes: str, given: Any) -> Optional[float]:
    """Return a number or None after a check."""
    return None if given is None else real(name, takes, given)


def optional_whole(name: str, takes: str, given: Any) -> Optional[int]:
    """Return a whole number or None after a check."""
    return None if given is None else whole(name, takes, given)
