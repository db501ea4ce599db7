"""Materials: absorption, scattering and transmission in octave bands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Mapping, Optional, Sequence, Union

import numpy as np

from . import _arguments
from ._echomarch import BUILTIN_MATERIALS
from ._echomarch import Scene as _Scene

PerBand = Union[float, Sequence[float]]
"""One number for all octave bands, or eight numbers: 63, 125, 250, 500 Hz, 1, 2, 4 and 8 kHz."""


@dataclass(frozen=True)
class Material:
    """What a surface does with sound.

    Parameters
    ----------
    absorption : float or 8 floats
        Share of the energy that a reflection absorbs, 0 to 1, for all octave bands or for each of 63 Hz to 8 kHz.
    scattering : float or 8 floats, optional
        Share of the reflected energy that is scattered (Lambert's law), 0 to 1. Without it, the scattering of the scene.
    density : float, optional
        Density in kg/m³ of a solid that transmits sound by the mass law.
    coincidence : float, optional
        Product of coincidence frequency and thickness in Hz·m.
    reduction : float or 8 floats, optional
        Sound reduction index in dB of a solid of the stated thickness.
    thickness : float, optional
        Thickness in m that the reduction index holds for.

    Examples
    --------
    >>> Material(0.2)
    Material(absorption=0.2, scattering=None, density=None, coincidence=None, reduction=None, thickness=None)
    """

    absorption: PerBand
    scattering: Optional[PerBand] = None
    density: Optional[float] = None
    coincidence: Optional[float] = None
    reduction: Optional[PerBand] = None
    thickness: Optional[float] = None

    def __post_init__(self) -> None:
        """Refuse values out of range, and fields that need others."""
        _Scene.empty("").add_material("", fields(self, 0.0), "the material")


def fields(material: Union[PerBand, Material], scattering: PerBand) -> str:
    """Return the fields of a material or of an absorption in the notation of scene files.

    `scattering` stands for a scattering that is not stated.
    """
    stated = dict(vars(material)) if isinstance(material, Material) else {"absorption": material}
    if stated.get("scattering") is None:
        stated["scattering"] = scattering
    given = {name: value for name, value in stated.items() if name == "absorption" or value is not None}
    return ", ".join(f"{name}: {_in_notation(name, value)}" for name, value in given.items())


AnyMaterial = Union[float, Sequence[float], str, Material]
"""An absorption (one or eight numbers), the name of a material, or a :class:`Material`."""


_PER_BAND = {
    "absorption": "a share of 0 to 1, or 8 for the octave bands",
    "scattering": "a share of 0 to 1, or 8 for the octave bands",
    "reduction": "a number of dB, or 8 for the octave bands",
}
_TAKES = {
    **_PER_BAND,
    "density": "a density in kg/m³",
    "coincidence": "a product of frequency and thickness in Hz·m",
    "thickness": "a length in m",
}
"""What the arguments of :class:`Material` take."""


def number(name: str, takes: str, value: float) -> str:
    """Return a number in the notation of scene files, with all digits, after a check."""
    text = repr(_arguments.real(name, takes, value))
    return {"nan": "NaN"}.get(text, text)


def _in_notation(name: str, value: PerBand) -> str:
    """Return one number or a list of numbers in the notation of scene files, after a check."""
    takes = _TAKES[name]
    try:
        is_one = isinstance(value, str) or np.ndim(value) == 0 or name not in _PER_BAND
    except ValueError:
        raise _arguments.refused(name, takes, value) from None
    if is_one:
        return number(name, takes, value)  # type: ignore[arg-type]
    return f"[{', '.join(number(name, takes, each) for each in value)}]"  # type: ignore[union-attr]


def builtin_materials() -> Mapping[str, Material]:
    """Return the built-in materials by name; their absorption is from published tables (see docs/scene-format.md)."""
    return {name: Material(list(absorption)) for name, _, _, absorption in BUILTIN_MATERIALS}
