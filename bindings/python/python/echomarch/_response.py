"""Responses: the sound of one source at one listener."""

from __future__ import annotations

import importlib
import os
import warnings
from typing import Any, Callable, Dict, Iterable, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _arguments, _axes, _echomarch, _progress
from ._errors import SettingsError, needed
from ._scene import Scene, chosen_pair

AnyPath = Union[str, "os.PathLike[str]"]
AnyLabel = Union[str, int, None]

BANDS_HZ = np.array(_echomarch.BANDS_HZ)
"""Centre frequencies of the octave bands in Hz."""

FIGURES = tuple(name.split("_")[0] for name in _echomarch.FIGURES)
"""Names of the figures, with their units in :attr:`Response.figures`, in the order edt, t20, t30 (s), c50, c80 (dB), d50
(0 to 1), ts (s), g (dB)."""

_FIGURES_DTYPE = np.dtype(
    [("band_hz", "f8"), *((name + end, "f8") for name in FIGURES for end in ("", "_error"))]
)
_PATHS_DTYPE = np.dtype(
    [
        ("kind", "U11"),
        ("order", "i4"),
        ("delay_s", "f8"),
        ("length_m", "f8"),
        ("g_db", "f8"),
        ("energy", "f8", (8,)),
        ("error_db", "f8", (8,)),
        ("direction", "f8", (3,)),
        ("azimuth_deg", "f8"),
        ("elevation_deg", "f8"),
        ("is_focus", "?"),
    ]
)
_ECHOGRAM_DTYPE = np.dtype([("time_s", "f8"), ("energy", "f8", (8,)), ("flow", "f8", (8, 3))])

_DEFAULT_ACCURACY = 0.02

_SEED = "a whole number of 0 to 4294967295"

_SETTINGS: Dict[str, Callable[[str, Any], Any]] = {
    "accuracy": lambda name, given: _arguments.optional_real(name, "a share, such as 0.02 for 2 %", given),
    "waves": lambda name, given: _arguments.optional_whole(name, "a whole number of waves", given),
    "seed": lambda name, given: _arguments.whole(name, _SEED, given),
    "seconds": lambda name, given: _arguments.optional_real(name, "a time in s", given),
    "order": lambda name, given: _arguments.optional_whole(name, "a whole number of reflections", given),
    "diffraction": _arguments.flag,
    "transmission": _arguments.flag,
    "profile": lambda name, given: _arguments.text(name, "the name of an algorithm", given),
    "directions": lambda name, given: _arguments.text(name, "the name of start directions", given),
    "time_limit": lambda name, given: _arguments.optional_real(name, "a time in s", given),
}
"""The checks of the settings, by their names."""


def response(
    scene: Scene,
    source: AnyLabel = None,
    listener: AnyLabel = None,
    *,
    accuracy: Optional[float] = None,
    waves: Optional[int] = None,
    seed: int = 1,
    seconds: Optional[float] = None,
    order: Optional[int] = None,
    diffraction: bool = False,
    transmission: bool = True,
    profile: str = "hybrid",
    directions: str = "random",
    time_limit: Optional[float] = None,
    progress: _progress.AnyProgress = None,
) -> "Response":
    """Trace the sound of a source at a listener.

    Results depend on the scene, the settings, the seed and the renderer only. They equal those of the program
    (``echomarch impulse``) for this pair alone (``--source``, ``--listener``) with the same seed, to the last
    digit. The GIL is released while waves are traced. All calls of a process share one OpenGL context on a thread of its
    own, so that calls from several threads wait for each other.

    Parameters
    ----------
    scene : Scene
        The scene.
    source, listener : str or int, optional
        Name or number (from 1) of the source and of the listener; not needed if there is only one.
    accuracy : float, optional
        Standard error of EDT, T20 and T30 as a share of the time, 0.001 to 0.05: 0.02 is 2 %. C50, C80 and G have a
        tenth of a decibel for each per cent. The number of waves grows until all figures have this error. The default is 0.02
        unless `waves` is given.
    waves : int, optional
        Number of waves; with `accuracy` the maximum number.
    seed : int
        Seed of the start directions, and of the noise in :meth:`Response.ir`.
    seconds : float, optional
        Length of the record in s. By default it ends when all bands have decayed by 60 dB, at most after 10 s.
    order : int, optional
        Maximum number of reflections of exact paths; 8 by default if all surfaces are flat, otherwise 3.
    diffraction : bool
        Whether the direct sound, and reflections at plane faces, bend around obstacles.
    transmission : bool
        Whether sound passes through solids whose material transmits sound.
    profile : {"hybrid", "march"}
        The algorithm.
    directions : {"random", "fibonacci"}
        Start directions.
    time_limit : float, optional
        Time limit in s: waves are added for `accuracy` only as far as the time is predicted to suffice. The result then
        depends on the speed of the machine.
    progress : callable, bool or None
        A function that receives a :class:`Progress` after each round. True shows progress on standard error or in a
        notebook, None only in a notebook, False never.

    Returns
    -------
    Response

    Warns
    -----
    UserWarning
        The warnings of the scene, for example a source or a listener in a solid, or walls without a material; if waves
        were lost, or not followed to the end of the record, so that figures may be wrong. :attr:`Response.notes` has
        all remarks, also on missing figures.

    Raises
    ------
    SceneError, SettingsError, RendererError
        With the sentences of the program.
    ForkError
        In a process that was forked after OpenGL had been opened.
    KeyboardInterrupt
        Within 50 ms of Ctrl+C. The interrupted round ends in the background.
    """
    given = settings_of_response(
        accuracy=accuracy,
        waves=waves,
        seed=seed,
        seconds=seconds,
        order=order,
        diffraction=diffraction,
        transmission=transmission,
        profile=profile,
        directions=directions,
        time_limit=time_limit,
    )
    source_index, listener_index = chosen_pair(scene, source, listener)
    show = _progress.of_rounds(progress, scene.name)
    warn(scene._raw.warnings_of_pairs(source_index, [listener_index]))
    found = traced(scene, source_index, [listener_index], given, show)[0]
    warn(found._heard.warnings())
    return found


def warn(texts: Iterable[str]) -> None:
    """Issue warnings that point to the caller of the function that calls this one."""
    for text in texts:
        warnings.warn(text, UserWarning, stacklevel=3)


def settings_of_response(
    *,
    accuracy: Optional[float] = None,
    waves: Optional[int] = None,
    time_limit: Optional[float] = None,
    **others: Any,
) -> Dict[str, Any]:
    """Return the settings that the extension module takes, by their names."""
    if accuracy is None and waves is None:
        accuracy = _DEFAULT_ACCURACY
    if time_limit is not None and accuracy is None:
        raise SettingsError("time_limit needs accuracy: without it, exactly the given number of waves is traced")
    return checked({"accuracy": accuracy, "waves": waves, "time_limit": time_limit, **others})


def checked(given: Dict[str, Any]) -> Dict[str, Any]:
    """Return settings after a check of their names and types. The extension module refuses bad ranges."""
    for name in given:
        if name not in _SETTINGS:
            known = [*_SETTINGS, "workers", "progress"]
            raise SettingsError(_echomarch.there_is_no("setting", name, known))
    return {name: _SETTINGS[name](name, value) for name, value in given.items()}


def traced(
    scene: Scene, source: int, listeners: List[int], given: Dict[str, Any], on_round: _progress.OnRound = None
) -> List["Response"]:
    """Trace a source at several listeners, given by their indices. One trace of the source serves all listeners."""
    heard = _echomarch.responses(scene._raw, source, listeners, given, on_round)
    return [Response(one, scene.axes) for one in heard]


class Response:
    """The sound of one source at one listener: figures, exact paths, echogram, impulse responses.

    :func:`response` and :func:`responses` return it. A response is plain data. It can be pickled, copied, and used on
    any thread.

    Attributes
    ----------
    scene, source, listener : str
        Names of the scene, the source and the listener.
    renderer : str
        Name of the OpenGL renderer.
    source_position, listener_position : tuple of 3 floats
        In m, in the axes of the scene.
    speed_of_sound : float
        In m/s.
    seed, waves : int
        The seed, and the number of waves for late arrivals.
    seconds : float
        Length of the record in s after the source's impulse.
    milliseconds : float
        Time of the computation in ms; that of all listeners of the source if they were traced together.
    gaps : list of str or None
        Why figures of a band are missing, for all eight bands; None if all decay times are there: ``"nothing arrives"``,
        ``"in a solid or outside the room"``, ``"record too short"`` (set `seconds`), ``"no late sound"``, ``"too noisy"``
        (more `waves`).
    notes : list of str
        Why figures are missing or inexact, and what to do about it; the sentences of the program. Empty if nothing is to
        be said. ``Scene.warnings`` has those about the scene itself.
    time_origin_s, time_origin_error_s : float
        Time origin of the figures in s after the source's impulse, and its standard error; NaN if nothing arrives.
    cut_off : numpy.ndarray, shape (8,)
        Share, 0 to 1, of each band's energy that is estimated to arrive after the record; NaN if it cannot be estimated.
    missed_early_share : float
        Estimated share, 0 to 1, of exact paths that no wave found, in the energy of all paths; NaN if no wave found a
        path.
    left_out_share : float
        Share, 0 to 1, of the energy in early arrivals whose exact paths were not searched for. The echogram contains
        these arrivals.
    search_left_out_share : float
        Share, 0 to 1, of the directions that the search for paths over planes left out, because the scene has too many
        surfaces.
    followed_s : float or None
        Time in s until which the waves were followed, if more than one in a thousand waves was given up before the end
        of the record; the figures are valid until this time.
    listener_view, listener_up : tuple of 3 floats
        Unit vectors of the listener's view and of the direction above it, in the axes of the scene.
    """

    scene: str
    source: str
    listener: str
    renderer: str
    source_position: Tuple[float, float, float]
    listener_position: Tuple[float, float, float]
    speed_of_sound: float
    seed: int
    waves: int
    seconds: float
    milliseconds: float
    time_origin_s: float
    time_origin_error_s: float
    gaps: List[Optional[str]]
    notes: List[str]
    missed_early_share: float
    left_out_share: float
    search_left_out_share: float
    followed_s: Optional[float]

    def __init__(self, heard: "_echomarch.Heard", axes: str) -> None:
        self._heard = heard
        self._axes = axes
        about = heard.about()
        for name in ("source_position", "listener_position", "listener_view", "listener_up"):
            about[name] = tuple(_axes.shown_in(axes, about[name]).tolist())
        about["cut_off"] = np.array(about["cut_off"])
        del about["bands_hz"]
        self.__dict__.update(about)

    def __reduce__(self) -> Any:
        return _restored, (self._heard.to_bytes(), self._axes)

    def __eq__(self, other: object) -> bool:
        """Whether both responses have the same numbers, apart from the time that they took."""
        return isinstance(other, Response) and self._heard == other._heard

    __hash__ = None  # type: ignore[assignment]

    @property
    def figures(self) -> npt.NDArray[Any]:
        """Room acoustic figures by octave band (ISO 3382-1), and their standard errors.

        Returns
        -------
        numpy.ndarray, shape (8,), structured
            ``band_hz`` (Hz); ``edt``, ``t20``, ``t30``, ``ts`` (s); ``c50``, ``c80``, ``g`` (dB); ``d50`` (0 to 1);
            each with ``…_error``, one standard deviation in the same unit. NaN where a figure is not defined or too
            noisy. ``pandas.DataFrame(r.figures)`` is a table.
        """
        table = np.zeros(8, _FIGURES_DTYPE)
        table["band_hz"] = BANDS_HZ
        values, errors = self._heard.figures(), self._heard.errors()
        for column, name in enumerate(FIGURES):
            table[name] = values[:, column]
            table[name + "_error"] = errors[:, column]
        return table

    @property
    def paths(self) -> npt.NDArray[Any]:
        """Exact paths by arrival time.

        Returns
        -------
        numpy.ndarray, shape (paths,), structured
            ``kind`` (direct, mirrored, diffracted, transmitted, added); ``order``, the number of reflections;
            ``delay_s`` after the source's impulse; ``length_m``; ``g_db``, strength *G* of the mean energy of all
            bands; ``energy`` (8 bands, 1/m²); ``error_db`` (8 bands, of diffracted paths); ``direction`` of flight at
            the listener, in the axes of the scene; ``azimuth_deg`` to the right of the view, ``elevation_deg``;
            ``is_focus``. Take samples from `ir`: those of paths around the same obstacle interfere, and have another
            energy.
        """
        found = self._heard.paths()
        table = np.zeros(len(found), _PATHS_DTYPE)
        if not found:
            return table
        kind, order, delay, length, energy, error, direction, focus = zip(*found)
        table["kind"], table["order"], table["delay_s"], table["length_m"] = kind, order, delay, length
        table["energy"], table["error_db"], table["is_focus"] = energy, error, focus
        table["direction"] = _axes.shown_in(self._axes, direction)
        table["g_db"] = [self._heard.strength_db(sum(bands) / 8) for bands in energy]
        table["azimuth_deg"], table["elevation_deg"] = zip(*self._heard.path_angles())
        return table

    @property
    def path_points(self) -> List[npt.NDArray[np.float64]]:
        """Points in m, shape (points, 3), at which each path of :attr:`paths` is reflected, bends or enters a solid."""
        return [_axes.shown_in(self._axes, np.reshape(points, (-1, 3))) for points in self._heard.path_points()]

    @property
    def path_surfaces(self) -> List[Tuple[str, ...]]:
        """Names of the surfaces of each path of :attr:`paths`, for example ``("room/floor", "desk")``."""
        return [tuple(names) for names in self._heard.path_surfaces()]

    @property
    def echogram(self) -> npt.NDArray[Any]:
        """Energy of all arrivals except the exact paths, by time and band.

        Returns
        -------
        numpy.ndarray, shape (bins,), structured
            ``time_s``, the middle of the bin after the source's impulse; ``energy`` (8 bands) in 1/m² for a source of
            power 1; ``flow`` (8 bands × 3): energy × direction of flight in 1/m², in the axes of the scene.
        """
        times = self._heard.bin_times()
        table = np.zeros(len(times), _ECHOGRAM_DTYPE)
        table["time_s"], table["energy"] = times, self._heard.bin_energies()
        table["flow"] = _axes.shown_in(self._axes, self._heard.bin_flows())
        return table

    def ir(
        self,
        rate: int = 48_000,
        format: str = "mono",
        sofa: Optional[AnyPath] = None,
        seed: Optional[int] = None,
        order: Optional[int] = None,
    ) -> npt.NDArray[np.float32]:
        """Return an impulse response.

        Sample 0 is the time of the source's impulse. Amplitude 1 is the direct sound at 1 m.

        Parameters
        ----------
        rate : int
            Samples per second.
        format : {"mono", "stereo", "binaural", "ambisonics"}
            The channels: one; left and right; the two ears (needs `sofa`); ambisonics (AmbiX: channels in the order
            ACN, SN3D; x ahead of the listener, y to the left, z up).
        sofa : path, optional
            A SOFA file of the convention SimpleFreeFieldHRIR, for the format "binaural".
        seed : int, optional
            Seed of the noise of the late part; the seed of the response by default.
        order : int, optional
            Order of the format "ambisonics", 1 to 7, 1 by default: (order + 1)² channels.

        Returns
        -------
        numpy.ndarray of float32, shape (channels, samples)
        """
        return self._heard.impulse_response(*_impulse_settings(rate, format, sofa, seed, order))

    def decay(self) -> Tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Return the decay curves: backward integrals of the energy (Schroeder 1965), without an estimated tail.

        Returns
        -------
        times : numpy.ndarray, shape (n,)
            Times in s after the source's impulse.
        levels : numpy.ndarray, shape (n, 8)
            Level in dB of all later energy, relative to the whole energy, by band.
        """
        step, count = self._heard.bin_s, int(np.ceil(self.seconds / self._heard.bin_s)) + 1
        energy = np.zeros((count, 8))
        for part in (self.echogram["time_s"], self.echogram["energy"]), (self.paths["delay_s"], self.paths["energy"]):
            np.add.at(energy, np.minimum((part[0] / step).astype(int), count - 1), part[1])
        later = np.cumsum(energy[::-1], axis=0)[::-1]
        with np.errstate(divide="ignore", invalid="ignore"):
            levels: npt.NDArray[np.float64] = 10.0 * np.log10(later / later[0])
        return step * np.arange(count, dtype=np.float64), levels

    def plot(self, ax: Any = None) -> Any:
        """Plot the decay curve of each band (needs matplotlib), and return the axes.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            The axes to draw in; new ones by default.
        """
        plt = _optional("matplotlib.pyplot", "a plot")
        if ax is None:
            _, ax = plt.subplots()
        times, levels = self.decay()
        for band, hertz in enumerate(BANDS_HZ):
            ax.plot(times, levels[:, band], label=f"{hertz:g} Hz")
        ax.set(xlabel="time after the impulse in s", ylabel="level of later energy in dB", ylim=(-60.0, 1.0))
        ax.set_title(": ".join(filter(None, (self.scene, f"{self.source} at {self.listener}"))))
        ax.legend(fontsize="small")
        return ax

    def to_pyfar(
        self,
        rate: int = 48_000,
        format: str = "mono",
        sofa: Optional[AnyPath] = None,
        seed: Optional[int] = None,
    ) -> Any:
        """Return the impulse response as a ``pyfar.Signal`` (needs pyfar); the parameters are those of :meth:`ir`."""
        pyfar = _optional("pyfar", "to_pyfar")
        samples = self.ir(rate, format, sofa, seed).astype(np.float64)
        comment = f"{self.scene}: {self.source} at {self.listener}, {format}"
        return pyfar.Signal(samples, rate, fft_norm="none", comment=comment)

    def to_sofa(
        self,
        file: AnyPath,
        rate: int = 48_000,
        format: str = "mono",
        sofa: Optional[AnyPath] = None,
        seed: Optional[int] = None,
        order: Optional[int] = None,
    ) -> None:
        """Write the impulse response as a SOFA file: :func:`write_sofa` with this response only.

        Parameters
        ----------
        file, rate, format, sofa, seed, order
            As in :func:`write_sofa`.
        """
        write_sofa(file, [self], rate, format, sofa, seed, order)

    def __repr__(self) -> str:
        t30 = self.figures["t30"][4]
        heard = "T30 not defined" if np.isnan(t30) else f"T30 {t30:.2f} s"
        return f"<echomarch.Response of {self.scene!r}: {self.source} at {self.listener}, {heard} at 1 kHz>"


def write_sofa(
    file: AnyPath,
    responses: Iterable[Response],
    rate: int = 48_000,
    format: str = "mono",
    sofa: Optional[AnyPath] = None,
    seed: Optional[int] = None,
    order: Optional[int] = None,
) -> None:
    """Write impulse responses as a SOFA file of the convention SingleRoomSRIR (AES69).

    Each response is a measurement of the file, and each channel a receiver. Positions and directions in the file have
    the axes of SOFA: x ahead, y to the left, z up. Shorter responses end with silence.

    Parameters
    ----------
    file : path
        The file to write, ending in ``.sofa``.
    responses : iterable of Response
        The responses, such as all pairs of a scene.
    rate, format, sofa, seed, order
        As in :meth:`Response.ir`.
    """
    path = _arguments.path("file", file)
    if not path.lower().endswith(".sofa"):
        raise _arguments.refused("file", "a path that ends in .sofa", file)
    settings = _impulse_settings(rate, format, sofa, seed, order)
    takes = "a list of responses"
    if not hasattr(responses, "__iter__"):
        raise _arguments.refused("responses", takes, responses)
    heard = []
    for each in responses:
        if not isinstance(each, Response):
            raise _arguments.refused("responses", takes, responses)
        heard.append(each._heard)
    _echomarch.Heard.write_sofa(path, heard, *settings)


def _impulse_settings(
    rate: int, format: str, sofa: Optional[AnyPath], seed: Optional[int], order: Optional[int]
) -> Tuple[int, str, Optional[int], Optional[str], Optional[int]]:
    """Return the checked settings of an impulse response, in the order of the extension module."""
    return (
        _arguments.whole("rate", "a whole number of samples per second", rate),
        _arguments.text("format", "the name of a format", format),
        _arguments.optional_whole("order", "a whole number, 1 to 7", order),
        None if sofa is None else _arguments.path("sofa", sofa),
        _arguments.optional_whole("seed", _SEED, seed),
    )


def _optional(module: str, what: str) -> Any:
    """Import a module of an optional package."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise needed(module.split(".")[0], what) from None


def _restored(data: bytes, axes: str) -> Response:
    """Return a pickled response."""
    return Response(_echomarch.Heard.from_bytes(data), axes)
