"""Echomarch: the sound of rooms and of worlds made of implicit surfaces, traced with OpenGL.

World axes: **x to the right, y up, z backwards**; a listener without a rotation looks along −z. pyfar, SOFA and
ambisonics use x ahead, y to the left, z up: ``axes="pyfar"`` of a :class:`Scene` converts. Lengths are in metres, angles
in degrees, times in seconds, frequencies in hertz. Octave bands: 63, 125, 250, 500 Hz, 1, 2, 4 and 8 kHz.

Examples
--------
>>> import echomarch as em
>>> room = em.Scene.shoebox((8, 3, 5), absorption=0.2)
>>> room.add_source("talker", (-2, 0, -1.5))
>>> room.add_listener("seat", (2, -0.3, 1.5))
>>> r = em.response(room, accuracy=0.02, seed=1)
>>> r.figures["t30"].shape, r.ir(rate=48000).dtype
((8,), dtype('float32'))
"""

import atexit as _atexit

from . import _echomarch
from ._axes import from_pyfar, to_pyfar
from ._echomarch import BUILTIN_SCENES, __version__
from ._errors import (
    EchomarchError,
    ForkError,
    MissingPackageError,
    RendererError,
    SceneError,
    SettingsError,
    SofaError,
    StudyError,
    WorkerError,
)
from ._material import Material, builtin_materials
from ._progress import Progress
from ._renderer import renderer, use_renderer
from ._response import BANDS_HZ, FIGURES, Response, response, write_sofa
from ._responses import responses
from ._scene import WALLS, Scene
from ._study import Study
from ._trace import Frame, trace

__all__ = [
    "BANDS_HZ",
    "BUILTIN_SCENES",
    "FIGURES",
    "WALLS",
    "EchomarchError",
    "ForkError",
    "Frame",
    "Material",
    "MissingPackageError",
    "Progress",
    "RendererError",
    "Response",
    "Scene",
    "SceneError",
    "SettingsError",
    "SofaError",
    "Study",
    "StudyError",
    "WorkerError",
    "__version__",
    "builtin_materials",
    "from_pyfar",
    "renderer",
    "response",
    "responses",
    "to_pyfar",
    "trace",
    "use_renderer",
    "write_sofa",
]

# A driver may crash if the process ends while a thread draws.
_atexit.register(_echomarch.close)
