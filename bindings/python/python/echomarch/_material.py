"""Materials: absorption, scattering and transmission in octave bands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Mapping, Optional, Sequence, Union

from ._echomarch import BUILTIN_MATERIALS

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

    def _fields(self, scattering: PerBand) -> str:
        """Return the fields in the notation of scene files. `scattering` stands for a scattering that is not stated."""
        stated = self.scattering if self.scattering is not None else scattering
        fields = [f"absorption: {in_notation(self.absorption)}", f"scattering: {in_notation(stated)}"]
        for name in ("density", "coincidence", "reduction", "thickness"):
            value = getattr(self, name)
            if value is not None:
                fields.append(f"{name}: {in_notation(value)}")
        return ", ".join(fields)


AnyMaterial = Union[float, Sequence[float], str, Material]
"""An absorption (one or eight numbers), the name of a material, or a :class:`Material`."""


def number(value: float) -> str:
    """Return a number in the notation of scene files, with all digits."""
    text = repr(float(value))
    return {"nan": "NaN"}.get(text, text)


def in_notation(value: PerBand) -> str:
    """Return one number or a list of numbers in the notation of scene files."""
    try:
        numbers = list(value)  # type: ignore[arg-type]
    except TypeError:
        return number(value)  # type: ignore[arg-type]
    return f"[{', '.join(number(each) for each in numbers)}]"


def builtin_materials() -> Mapping[str, Material]:
    """Return the built-in materials by name; their absorption is from published tables (see docs/scene-format.md)."""
    return {name: Material(list(absorption)) for name, _, _, absorption in BUILTIN_MATERIALS}
