"""Scenes: surfaces, materials, air, sources and listeners."""

from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _arguments, _axes, _echomarch
from ._errors import SettingsError
from ._material import AnyMaterial, Material, PerBand, fields as _fields, number

Vector = Sequence[float]
AnyPath = Union[str, "os.PathLike[str]"]

WALLS = ("left", "right", "floor", "ceiling", "front", "back")
"""Names of the walls of a room at −x, +x, −y, +y, −z, +z in the axes of scene files; the front wall is ahead."""

_LISTENER_RADIUS_M = 0.3
"""Default radius of a listener in metres; waves that cross this sphere are heard."""


_PLACE = "coordinates in m"
_ANGLE = "an angle in degrees"


def _as_given(place: List[float]) -> List[float]:
    """Return numbers of 32 bits as the shortest decimal numbers that stand for them: 1.6 for 1.600000023841858."""
    return [float(str(np.float32(each))) for each in place]


def _quoted(name: str) -> str:
    """Return a name in the notation of scene files, after a check."""
    escaped = _arguments.text("name", "a text", name).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _vector(name: str, takes: str, numbers: Sequence[Union[float, str]]) -> str:
    """Return a vector in the notation of scene files. A text is a number in this notation."""
    return f"({', '.join(each if isinstance(each, str) else number(name, takes, each) for each in numbers)})"


class Scene:
    """A scene: surfaces with materials, air, sources and listeners.

    World axes, unless `axes` says otherwise: **x to the right, y up, z backwards**; a listener without a rotation looks
    along −z. pyfar, SOFA and ambisonics use other axes: x ahead, y to the left, z up. With ``axes="pyfar"`` all
    positions, directions and room sizes that this object takes, and all those that its responses return, are in the
    axes of pyfar. Texts in the notation of scene files, rotations, yaw and pitch always have the axes of scene files.

    Lengths are in metres, angles in degrees, times in seconds.

    Parameters
    ----------
    name_or_file : str or path
        A built-in scene (see ``BUILTIN_SCENES``), or a scene file (``.ron``).
    axes : {"echomarch", "pyfar"}
        The axes of this object.

    Raises
    ------
    SceneError
        There is no such scene, or the file cannot be used.

    Examples
    --------
    >>> room = Scene.shoebox((8, 3, 5), absorption=0.2)
    >>> room.add_source("talker", (-2, 0, -1.5))
    >>> room.add_listener("seat", (2, -0.3, 1.5))
    >>> room.sources
    {'talker': (-2.0, 0.0, -1.5)}
    """

    def __init__(self, name_or_file: AnyPath, *, axes: str = "echomarch") -> None:
        self._begin(axes, "load", _arguments.path("the name or file of a scene", name_or_file))

    def _begin(self, axes: str, start: str, *arguments: Any) -> None:
        self._axes = _axes.checked(axes)
        self._start = (start, arguments)
        self._raw: _echomarch.Scene = getattr(_echomarch.Scene, start)(*arguments)
        self._calls: List[Tuple[str, Tuple[Any, ...]]] = []
        self._materials: Dict[str, Union[PerBand, Material]] = {}
        self._scattering: PerBand = 0.0

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            raise AttributeError(f"a Scene has no attribute {name!r} that can be set: set scattering, or call a method")
        object.__setattr__(self, name, value)

    @classmethod
    def _of(cls, axes: str, start: str, *arguments: Any) -> "Scene":
        scene = cls.__new__(cls)
        scene._begin(axes, start, *arguments)
        return scene

    def _do(self, method: str, *arguments: Any) -> Any:
        """Change the scene. The calls are recorded, so that a copy in another process has the same bits."""
        result = getattr(self._raw, method)(*arguments)
        self._calls.append((method, arguments))
        return result

    # Construction

    @classmethod
    def from_ron(cls, text: str, *, folder: AnyPath = "", axes: str = "echomarch") -> "Scene":
        """Read a scene from the text of a scene file.

        Parameters
        ----------
        text : str
            The text, ``Scene(…)``.
        folder : path
            The folder of the files that the text names; the current folder by default.
        axes : {"echomarch", "pyfar"}
            The axes of the returned object. The text has the axes of scene files.
        """
        text = _arguments.text("text", "the text of a scene file", text)
        return cls._of(axes, "from_ron", text, "text", _arguments.path("folder", folder))

    @classmethod
    def empty(cls, name: str = "scene", *, axes: str = "echomarch") -> "Scene":
        """Return a scene without surfaces, sources and listeners."""
        return cls._of(axes, "empty", _arguments.text("name", "a text", name))

    @classmethod
    def shoebox(
        cls,
        size: Vector,
        absorption: Union[AnyMaterial, Mapping[str, AnyMaterial]] = 0.1,
        scattering: PerBand = 0.0,
        *,
        axes: str = "echomarch",
    ) -> "Scene":
        """Return a rectangular room, centred on the origin.

        Parameters
        ----------
        size : 3 floats
            Extent in m along x, y and z of `axes`: (width, height, depth) by default, (depth, width, height) with
            ``axes="pyfar"``.
        absorption : float, 8 floats, str, Material, or dict
            Absorption of all walls (one number, or one for each octave band from 63 Hz to 8 kHz), the name of a
            built-in material, or these by wall: ``{"floor": "carpet", "ceiling": 0.6}``. A wall that the dictionary does
            not name reflects all sound, and responses warn of it. The walls are left, right, floor, ceiling, front (−z)
            and back.
        scattering : float or 8 floats
            Share of the reflected energy that is scattered, for materials that state none.

        Examples
        --------
        >>> Scene.shoebox((5, 2.5, 4), {"floor": "carpet", "front": 0.3}).surfaces
        ['room']
        """
        scene = cls.empty("shoebox", axes=axes)
        scene.scattering = scattering
        lengths = _arguments.triple("the size of a room", "lengths in m", size)
        if not min(lengths) > 0.0:
            raise SettingsError(f"the size of a room must be three lengths above 0 m, not {size!r}")
        extent = _vector("size", "lengths in m", list(np.abs(_axes.given_in(axes, lengths))))
        scene._do("add_surface", f'name: "room", shape: Room(size: {extent})', "the room", "")
        if isinstance(absorption, Mapping):
            walls = _arguments.mapping("absorption", "a material, or a dictionary of materials by wall", absorption)
            for wall, material in walls.items():
                scene.set_material("room", material, part=wall)
        else:
            scene.set_material("room", absorption)
        return scene

    @classmethod
    def from_mesh(
        cls,
        file: AnyPath,
        absorption: AnyMaterial = 0.1,
        materials: Optional[Mapping[str, AnyMaterial]] = None,
        *,
        inside: Optional[str] = None,
        scale: float = 1.0,
        up: str = "y",
        axes: str = "echomarch",
    ) -> "Scene":
        """Return a scene with a triangle mesh.

        Parameters
        ----------
        file : path
            An OBJ or glTF file (``.obj``, ``.gltf``, ``.glb``).
        absorption : float, 8 floats, str or Material
            The material of faces whose group is neither in `materials` nor has the name of a built-in material.
        materials : dict, optional
            Materials by the names of the file's groups of faces.
        inside : {"air", "solid"}, optional
            The inside of a closed mesh. Without it, the direction of the faces decides.
        scale : float
            Metres per unit of the file.
        up : {"y", "z"}
            The axis of the file that points up. With "z" the mesh is turned, so that y of the file points ahead (−z).

        Warns
        -----
        UserWarning
            For each defect of the mesh that changes what is heard.
        """
        if inside is not None:
            _arguments.choice("inside", ("air", "solid"), inside)
        _arguments.choice("up", ("y", "z"), up)
        path = _arguments.path("file", file)
        takes = "a dictionary of materials by the names of groups"
        known = {} if materials is None else _arguments.mapping("materials", takes, materials)
        scene = cls.empty(os.path.splitext(os.path.basename(path))[0], axes=axes)
        is_hollow = None if inside is None else inside == "air"
        turns = -1 if up == "z" else 0
        groups, warned = scene._do("add_mesh", "mesh", path, is_hollow, _arguments.real("scale", "a number of m", scale), turns)
        for text in warned:
            _warn(f"{path}: {text}")
        unknown = sorted(set(known) - set(groups))
        if unknown:
            refused = f'the mesh {path} has no group "{unknown[0]}"'
            raise SettingsError(_echomarch.which_it_has(refused, unknown[0], groups))
        scene.set_material("mesh", absorption)
        for group, material in known.items():
            scene.set_material("mesh", material, part=group)
        return scene

    def copy(self) -> "Scene":
        """Return a copy that can be changed independently."""
        copied = type(self).__new__(type(self))
        copied.__dict__.update(self.__dict__)
        copied._raw = self._raw.copy()
        copied._calls = list(self._calls)
        copied._materials = dict(self._materials)
        return copied

    def _become(self, changed: "Scene") -> None:
        """Take over a changed copy of this scene. A change of several steps is then made as a whole or not at all."""
        self.__dict__.update(changed.__dict__)

    __copy__ = copy

    def __deepcopy__(self, _memo: Any) -> "Scene":
        return self.copy()

    def __getstate__(self) -> Dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_raw"}

    def __setstate__(self, state: Dict[str, Any]) -> None:
        self.__dict__.update(state)
        start, arguments = self._start
        self._raw = getattr(_echomarch.Scene, start)(*arguments)
        for method, given in self._calls:
            getattr(self._raw, method)(*given)

    # Surfaces and materials

    def add_surface(
        self,
        shape: str,
        position: Sequence[Union[float, str]] = (0.0, 0.0, 0.0),
        rotation: Sequence[Union[float, str]] = (0.0, 0.0, 0.0),
        material: Optional[AnyMaterial] = None,
        *,
        name: Optional[str] = None,
        folder: AnyPath = "",
    ) -> None:
        """Add a surface.

        Parameters
        ----------
        shape : str
            A shape in the notation of scene files, for example ``"Box(size: (2, 1, 0.1))"`` or
            ``'Field(file: "menger.glsl", lipschitz: 1, size: (4, 4, 4))'``. Its axes are those of scene files.
        position : 3 floats
            Place of the shape's origin in m. In the axes of scene files a number may also be a text, such as
            ``'Value("door", 0.9)'``.
        rotation : 3 floats
            Rotations about x, then y, then z of scene files, in degrees.
        material : float, 8 floats, str or Material, optional
            Without a material the surface reflects all sound.
        name : str, optional
            Name of the surface; its number from 1 by default.
        folder : path
            The folder of files that the shape names.
        """
        if isinstance(position, (list, tuple)) and any(isinstance(each, str) for each in position):
            if self._axes != "echomarch":
                raise SettingsError("a position with a text needs the axes of scene files, not those of pyfar")
            if len(position) != 3:
                raise _arguments.refused("the position of a surface", f"three numbers, {_PLACE}", position)
            place: Sequence[Union[float, str]] = position
        else:
            place = self._place("the position of a surface", position)
        label = name if name is not None else str(len(self.surfaces) + 1)
        if label in self.surfaces:
            raise SettingsError(f'the scene already has a surface "{label}": give this one another name')
        fields = [
            f"shape: {_arguments.text('shape', 'a text in the notation of scene files', shape)}",
            f"position: {_vector('the position of a surface', _PLACE, place)}",
            f"rotation: {self._rotation(rotation)}",
        ]
        if name is not None:
            fields.insert(0, f"name: {_quoted(name)}")
        # A wrong material leaves the scene as it was.
        changed = self.copy()
        changed._do("add_surface", ", ".join(fields), f"the surface {label}", _arguments.path("folder", folder))
        if material is not None:
            changed.set_material(label, material)
        self._become(changed)

    @staticmethod
    def _rotation(rotation: Sequence[Union[float, str]]) -> str:
        if isinstance(rotation, (list, tuple)) and len(rotation) == 3 and any(isinstance(each, str) for each in rotation):
            return _vector("the rotation of a surface", "angles in degrees", rotation)
        angles = _arguments.triple("the rotation of a surface", "angles in degrees", rotation)
        return _vector("the rotation of a surface", "angles in degrees", angles)

    def remove_surface(self, surface: Union[str, int]) -> None:
        """Remove a surface. Its material remains in the scene, for other surfaces.

        Parameters
        ----------
        surface : str or int
            Name of the surface, or its number from 1. The numbers of the surfaces after it become one less.
        """
        self._do("remove_surface", _label("surface", surface))

    def add_material(self, name: str, material: Union[PerBand, Material]) -> None:
        """Add a material, or replace the material of this name.

        Parameters
        ----------
        name : str
            The name by which surfaces refer to the material.
        material : float, 8 floats or Material
            The absorption, or the whole material.
        """
        _arguments.text("the name of a material", "a text", name)
        self._do("add_material", name, _fields(material, self._scattering), f"the material {name}")
        self._materials[name] = material

    def set_material(self, surface: Union[str, int], material: AnyMaterial, *, part: Optional[str] = None) -> None:
        """Give a surface, or a part of it, a material.

        Parameters
        ----------
        surface : str or int
            Name of the surface, or its number from 1.
        material : float, 8 floats, str or Material
            An absorption, the name of a built-in or added material, or a material.
        part : str, optional
            A wall of a room ("floor"), a box of rooms ("hall") or one of its walls ("hall/floor"), or a group of faces
            of a mesh.
        """
        surface = _label("surface", surface)
        if part is not None:
            _arguments.text("part", "the name of a part of the surface", part)
        if isinstance(material, str):
            self._raw.check_material(material, f"the surface {surface}")
        else:
            name = self._raw.material_name(surface, part, surface if part is None else f"{surface}/{part}")
            self.add_material(name, material)
            material = name
        self._do("set_material", surface, part, material)

    @property
    def scattering(self) -> PerBand:
        """One number or eight, the share of the reflected energy that is scattered by materials that state none."""
        return self._scattering

    @scattering.setter
    def scattering(self, scattering: PerBand) -> None:
        bands = _arguments.shares("scattering", scattering)
        # A material that is refused leaves the scene as it was.
        changed = self.copy()
        changed._do("set_scattering", bands)
        changed._scattering = bands[0] if np.ndim(scattering) == 0 else bands
        for name, material in self._materials.items():
            changed.add_material(name, material)
        self._become(changed)

    def set_air(
        self,
        temperature: Optional[float] = 20.0,
        humidity: float = 50.0,
        pressure: float = 101.325,
    ) -> None:
        """Set the air, which determines the speed of sound and the losses (ISO 9613-1).

        Parameters
        ----------
        temperature : float or None
            In °C. ``None`` removes the air: 343 m/s and no loss, as in a scene file without air.
        humidity : float
            Relative humidity in per cent.
        pressure : float
            In kPa.
        """
        if temperature is None:
            self._do("set_air", None)
            return
        parts = (
            f"temperature: {number('temperature', 'a number of °C', temperature)}",
            f"humidity: {number('humidity', 'a number of per cent', humidity)}",
            f"pressure: {number('pressure', 'a number of kPa', pressure)}",
        )
        self._do("set_air", ", ".join(parts))

    # Sources and listeners

    def add_source(
        self,
        name: str,
        position: Vector,
        *,
        view: Optional[Vector] = None,
        yaw: float = 0.0,
        pitch: float = 0.0,
        level_db: float = 0.0,
        directivity: str = "Omnidirectional",
        folder: AnyPath = "",
    ) -> None:
        """Add a source.

        Parameters
        ----------
        name : str
            Name of the source.
        position : 3 floats
            In m.
        view : 3 floats, optional
            Direction of the source's axis, in the axes of this scene. Replaces `yaw` and `pitch`.
        yaw, pitch : float
            Direction of the axis in degrees: to the right and upwards from −z of scene files.
        level_db : float
            Level in dB relative to a source of power 1.
        directivity : str
            In the notation of scene files: ``"Cardioid"``, ``"FirstOrder(0.7)"``, ``'Balloon(file: "horn.sofa")'``.
        folder : path
            The folder of a file that the directivity names.
        """
        yaw, pitch = self._angles(view, yaw, pitch)
        place = self._place("the position of a source", position)
        fields = [
            f"name: {_quoted(name)}",
            f"position: {_vector('position', _PLACE, place)}",
            f"yaw: {number('yaw', _ANGLE, yaw)}",
            f"pitch: {number('pitch', _ANGLE, pitch)}",
            f"level_db: {number('level_db', 'a level in dB', level_db)}",
            f"directivity: {_arguments.text('directivity', 'a text in the notation of scene files', directivity)}",
        ]
        self._do("add_source", ", ".join(fields), f"the source {name}", _arguments.path("folder", folder))

    def add_listener(
        self,
        name: str,
        position: Vector,
        *,
        view: Optional[Vector] = None,
        yaw: float = 0.0,
        pitch: float = 0.0,
        radius: float = _LISTENER_RADIUS_M,
    ) -> None:
        """Add a listener.

        Parameters
        ----------
        name : str
            Name of the listener.
        position : 3 floats
            In m.
        view : 3 floats, optional
            Viewing direction, in the axes of this scene. Replaces `yaw` and `pitch`.
        yaw, pitch : float
            Viewing direction in degrees: to the right and upwards from −z of scene files.
        radius : float
            Radius in m of the sphere in which waves are heard.
        """
        yaw, pitch = self._angles(view, yaw, pitch)
        place = self._place("the position of a listener", position)
        fields = [
            f"name: {_quoted(name)}",
            f"position: {_vector('position', _PLACE, place)}",
            f"yaw: {number('yaw', _ANGLE, yaw)}",
            f"pitch: {number('pitch', _ANGLE, pitch)}",
            f"radius: {number('radius', 'a length in m', radius)}",
        ]
        self._do("add_listener", ", ".join(fields), f"the listener {name}")

    def remove_source(self, source: Union[str, int]) -> None:
        """Remove a source.

        Parameters
        ----------
        source : str or int
            Name of the source, or its number from 1. The numbers of the sources after it become one less.
        """
        self._do("remove_source", _label("source", source))

    def remove_listener(self, listener: Union[str, int]) -> None:
        """Remove a listener.

        Parameters
        ----------
        listener : str or int
            Name of the listener, or its number from 1. The numbers of the listeners after it become one less.
        """
        self._do("remove_listener", _label("listener", listener))

    def clear_sources(self) -> None:
        """Remove all sources."""
        self._do("clear_sources")

    def clear_listeners(self) -> None:
        """Remove all listeners."""
        self._do("clear_listeners")

    def _place(self, what: str, position: Sequence[Any]) -> List[float]:
        return [float(each) for each in _axes.given_in(self._axes, _arguments.triple(what, _PLACE, position))]

    def _angles(self, view: Optional[Vector], yaw: float, pitch: float) -> Tuple[float, float]:
        if view is None:
            return yaw, pitch
        direction = _axes.given_in(self._axes, _arguments.triple("view", "a direction", view))
        return _axes.yaw_and_pitch([float(each) for each in direction])

    # Values and time

    @property
    def values(self) -> Dict[str, float]:
        """The named values of the scene and their current numbers, in metres or degrees."""
        return {name: _as_given([number])[0] for name, number in self._raw.values()}

    def set(self, **values: float) -> None:
        """Set named values in the unit of the scene file (m, degrees): ``scene.set(door=90)``."""
        changed = self.copy()
        for name, value in values.items():
            changed.set_value(name, value)
        self._become(changed)

    def set_value(self, name: str, value: float) -> None:
        """Set one named value; the name may be any text."""
        _arguments.text("name", "the name of a value", name)
        self._do("set_value", name, _arguments.real(f"the value {name}", "a number in m or degrees", value))

    def at(self, seconds: float) -> "Scene":
        """Return a copy in which everything that moves is at its place at a time in s."""
        posed = self.copy()
        posed._do("move_to", _arguments.real("seconds", "a time in s", seconds))
        return posed

    # Properties

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self._raw.name

    @property
    def axes(self) -> str:
        """The axes of this object, ``"echomarch"`` or ``"pyfar"``."""
        return self._axes

    @property
    def surfaces(self) -> List[str]:
        """Names of the surfaces; the number from 1 for a surface without a name."""
        return self._raw.surfaces()

    @property
    def materials(self) -> List[str]:
        """Names of the scene's own materials."""
        return self._raw.materials()

    @property
    def sources(self) -> Dict[str, Tuple[float, float, float]]:
        """Positions of the sources in m, by name."""
        return self._shown(self._raw.sources())

    @property
    def listeners(self) -> Dict[str, Tuple[float, float, float]]:
        """Positions of the listeners in m, by name."""
        return self._shown(self._raw.listeners())

    def _shown(self, places: List[Tuple[str, List[float]]]) -> Dict[str, Tuple[float, float, float]]:
        return {label: tuple(_axes.shown_in(self._axes, _as_given(place)).tolist()) for label, place in places}

    @property
    def speed_of_sound(self) -> float:
        """Speed of sound in m/s."""
        return self._raw.speed_of_sound()

    @property
    def warnings(self) -> List[str]:
        """Sentences about oddities, such as a source within a solid."""
        return self._raw.warnings()

    def check(self) -> None:
        """Check all numbers and names.

        Raises
        ------
        SceneError
            With the first fault.
        """
        self._raw.check()

    def distance(self, point: Vector) -> float:
        """Return the signed distance in m from a point to the nearest surface; it is negative within a solid."""
        return self._raw.distance(self._place("a point", point))

    def to_ron(self) -> str:
        """Return the text of a scene file, in the axes of scene files."""
        return self._raw.to_ron()

    def save(self, file: AnyPath) -> None:
        """Write a scene file. File names in it are those that the scene was made with."""
        with open(_arguments.path("file", file), "w", encoding="utf-8") as out:
            out.write(self.to_ron())

    def __repr__(self) -> str:
        counts = (len(self.surfaces), len(self._raw.sources()), len(self._raw.listeners()))
        nouns = ("surface", "source", "listener")
        parts = (f"{count} {noun}{'' if count == 1 else 's'}" for count, noun in zip(counts, nouns))
        return f"<echomarch.Scene {self.name!r}: {', '.join(parts)}>"

    # Choice of pairs

    def _pair(self, source: Union[str, int, None], listener: Union[str, int, None]) -> Tuple[int, int]:
        if source is None:
            source = _only("source", self._raw.sources())
        source_index = self._raw.source_index(_label("source", source))
        if listener is None:
            listener = _only("listener", self._raw.listeners())
        return source_index, self._raw.listener_index(_label("listener", listener))

    def pairs(self) -> List[Tuple["Scene", str, str]]:
        """Return all pairs of a source and a listener, ``(scene, source, listener)``, for :func:`responses`."""
        sources = [label for label, _ in self._raw.sources()]
        listeners = [label for label, _ in self._raw.listeners()]
        return [(self, source, listener) for source in sources for listener in listeners]


def chosen_pair(scene: Any, source: Union[str, int, None], listener: Union[str, int, None]) -> Tuple[int, int]:
    """Return the indices of a source and a listener of a scene, after a check."""
    if not isinstance(scene, Scene):
        raise _arguments.refused("scene", "a Scene", scene)
    return scene._pair(source, listener)


def _label(what: str, given: Any) -> str:
    """Return the name, or the number from 1, of a part of a scene as a text, after a check."""
    if isinstance(given, str):
        return given
    return str(_arguments.whole(what, f"the name or the number of a {what}", given))


def _only(what: str, all_of_them: List[Tuple[str, Any]]) -> str:
    """Return the name of the only source or listener."""
    if not all_of_them:
        raise SettingsError(f"the scene has no {what}: add one with add_{what}")
    labels = [label for label, _ in all_of_them]
    if len(labels) > 1:
        raise SettingsError(f"the scene has {len(labels)} {what}s ({', '.join(labels)}): choose one with {what}=")
    return labels[0]


def _warn(text: str) -> None:
    import warnings

    warnings.warn(text, UserWarning, stacklevel=3)
