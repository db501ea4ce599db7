"""Responses: results, exports, progress."""

import pickle
import sys
import warnings

import numpy as np
import pytest

import echomarch as em

CHEAP = {"waves": 2048, "seconds": 0.3}


def test_a_known_room_has_its_reverberation_time():
    """Protects the physics across the interface: an even room of little absorption decays as Eyring says, in all bands."""
    size, absorption = np.array([7.0, 3.0, 5.0]), 0.1
    room = em.Scene.shoebox(size, absorption, scattering=0.5)
    room.add_source("s", (-2, 0, -1))
    room.add_listener("l", (2, 0.3, 1))
    r = em.response(room, accuracy=0.02)
    area = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0])
    eyring = 24 * np.log(10) / 343 * size.prod() / (-area * np.log(1 - absorption))
    np.testing.assert_allclose(r.figures["t30"], eyring, rtol=0.06)
    assert np.all(r.figures["t30_error"] <= 0.02 * r.figures["t30"])


def test_figures_are_a_table(room):
    """Protects the form of the results: names, units by size, shapes and types."""
    r = em.response(room, **CHEAP)
    assert r.figures.shape == (8,) and r.figures.dtype.names[:3] == ("band_hz", "edt", "edt_error")
    assert list(r.figures["band_hz"]) == [63, 125, 250, 500, 1000, 2000, 4000, 8000] == list(em.BANDS_HZ)
    assert em.FIGURES == ("edt", "t20", "t30", "c50", "c80", "d50", "ts", "g")
    assert r.paths.dtype["energy"].shape == (8,) and r.echogram.dtype["flow"].shape == (8, 3)
    assert len(r.paths) == len(r.path_points) == len(r.path_surfaces) > 100
    direct = r.paths[0]
    assert direct["kind"] == "direct" and direct["order"] == 0
    assert direct["length_m"] == pytest.approx(np.hypot(4, np.hypot(3, 0.3)), abs=1e-6)
    assert direct["delay_s"] == pytest.approx(direct["length_m"] / r.speed_of_sound)
    np.testing.assert_allclose(direct["energy"], 1 / (4 * np.pi * direct["length_m"] ** 2))
    assert r.path_surfaces[0] == () and all(name.startswith("room/") for name in r.path_surfaces[5])
    assert np.all(np.diff(r.paths["delay_s"]) >= 0)
    assert pickle.loads(pickle.dumps(r)) == r
    assert r != em.response(room, seed=2, **CHEAP) and r == em.response(room, seed=1, **CHEAP)
    assert "talker at seat" in repr(r)


def test_impulse_responses_have_channels_and_samples(room, hrirs):
    """Protects the form of impulse responses, and their seeds."""
    r = em.response(room, **CHEAP)
    for format, channels in (("mono", 1), ("stereo", 2), ("ambisonics", 4)):
        samples = r.ir(rate=16000, format=format)
        assert samples.shape == (channels, 4800) and samples.dtype == np.float32
    third = r.ir(format="ambisonics", order=3)
    assert third.shape == (16, 14400)
    np.testing.assert_array_equal(third[:4], r.ir(format="ambisonics"))
    assert r.ir(format="binaural", sofa=hrirs).shape == (2, 14400)
    np.testing.assert_array_equal(r.ir(), r.ir(seed=1))
    assert not np.array_equal(r.ir(), r.ir(seed=2))
    for bad, sentence in (
        ({"format": "binaural"}, "needs head-related impulse responses"),
        ({"format": "quad"}, "there is no format \"quad\""),
        ({"format": "ambisonics", "order": 8}, "the order of ambisonics must be 1 to 7, not 8"),
        ({"order": 3}, "order= has no effect on the format mono"),
        ({"sofa": hrirs}, "sofa= has no effect on the format mono"),
        ({"rate": 10}, "a sampling rate of 10 Hz"),
    ):
        with pytest.raises(em.SettingsError, match=sentence):
            r.ir(**bad)
    for bad, sentence in (
        ({"rate": 44100.5}, "rate must be a whole number of samples per second, not 44100.5"),
        ({"format": None}, "format must be the name of a format, not None"),
        ({"format": "ambisonics", "order": "two"}, "order must be a whole number, 1 to 7, not 'two'"),
        ({"seed": "x"}, "seed must be a whole number of 0 to 4294967295, not 'x'"),
    ):
        with pytest.raises(em.SettingsError, match=sentence):
            r.ir(**bad)
    with pytest.raises(em.SofaError, match="none.sofa"):
        r.ir(format="binaural", sofa="none.sofa")


def test_the_decay_begins_at_0_db_and_falls(room):
    """Protects the decay curve: it starts at the whole energy, falls, and its slope is the reverberation time."""
    r = em.response(room, accuracy=0.05)
    times, levels = r.decay()
    assert levels.shape == (len(times), 8) and np.all(levels[0] == 0)
    assert np.all(np.diff(levels, axis=0)[np.isfinite(np.diff(levels, axis=0))] <= 0)
    for band in range(8):
        part = (levels[:, band] < -5) & (levels[:, band] > -35)
        slope = np.polyfit(times[part], levels[part, band], 1)[0]
        assert -60 / slope == pytest.approx(r.figures["t30"][band], rel=0.03)


def test_a_plot_shows_each_band(room):
    """Protects plots: one line for each band, in given axes or new ones."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    ax = em.response(room, **CHEAP).plot()
    assert len(ax.lines) == 8 and ax.get_xlabel().endswith("in s")


def test_a_signal_of_pyfar_has_the_samples(room):
    """Protects the export to pyfar: samples, rate and normalisation."""
    pytest.importorskip("pyfar")
    r = em.response(room, **CHEAP)
    signal = r.to_pyfar(rate=44100, format="stereo")
    np.testing.assert_array_equal(signal.time, r.ir(44100, "stereo"))
    assert signal.sampling_rate == 44100 and signal.fft_norm == "none" and "talker at seat" in signal.comment


def test_a_sofa_file_has_samples_and_places(room, tmp_path):
    """Protects the export to SOFA: sofar reads it back with samples, positions and view in the axes of SOFA."""
    sofar = pytest.importorskip("sofar")
    r = em.response(room, **CHEAP)
    for format, channels in (("mono", 1), ("ambisonics", 4)):
        file = tmp_path / f"{format}.sofa"
        r.to_sofa(file, rate=44100, format=format)
        read = sofar.read_sofa(str(file))
        samples = np.reshape(read.Data_IR, (channels, -1))
        np.testing.assert_allclose(samples, r.ir(44100, format), rtol=1e-6)
        np.testing.assert_allclose(np.squeeze(read.SourcePosition), em.to_pyfar(r.source_position))
        np.testing.assert_allclose(np.squeeze(read.ListenerPosition), em.to_pyfar(r.listener_position))
        # A yaw of 30 degrees is to the right, and y of SOFA is to the left.
        np.testing.assert_allclose(np.squeeze(read.ListenerView), [np.cos(np.pi / 6), -0.5, 0], atol=1e-6)
        assert read.verify(issue_handling="return") is None
    file = tmp_path / "both.sofa"
    em.write_sofa(file, [r, em.response(room, **{**CHEAP, "seconds": 0.1})], rate=44100)
    both = sofar.read_sofa(str(file)).Data_IR
    assert both.shape[:2] == (2, 1) and not both[1, 0, 4410:].any() and both[1, 0, :4410].any()
    with pytest.raises(em.SofaError, match="no measurements"):
        em.write_sofa(file, [])


@pytest.mark.parametrize(
    "package, call", [("pyfar", "to_pyfar"), ("matplotlib.pyplot", "plot")]
)
def test_missing_packages_are_named(room, monkeypatch, package, call):
    """Protects users without the optional packages: the exception says what to install."""
    monkeypatch.setitem(sys.modules, package, None)
    r = em.response(room, **CHEAP)
    with pytest.raises(em.MissingPackageError, match=f"python -m pip install {package.split('.')[0]}"):
        getattr(r, call)()


def test_progress_reports_each_round(room, capsys):
    """Protects progress: each round is reported, the last one as the last, and a text goes to standard error."""
    rounds = []
    r = em.response(room, accuracy=0.004, progress=rounds.append)
    assert len(rounds) > 1 and rounds[-1].next_waves is None and rounds[-1].share == 1.0
    assert [after.waves for after in rounds[1:]] == [before.next_waves for before in rounds[:-1]]
    assert rounds[-1].waves == r.waves and 0 < rounds[0].accurate < rounds[0].defined
    em.response(room, **CHEAP, accuracy=0.05, progress=True)
    assert "shoebox: 100%" in capsys.readouterr().err
    with pytest.raises(ZeroDivisionError):
        em.response(room, accuracy=0.004, progress=lambda _: 1 / 0)
    assert em.response(room, accuracy=0.004) == r


@pytest.mark.parametrize(
    "settings, sentence",
    [
        ({"accuracy": 0.5}, "accuracy of figures must be a share of 0.001 to 0.05"),
        ({"waves": 0}, "waves must be 1 to 16777216, not 0"),
        ({"waves": 100, "time_limit": 1}, "time_limit needs accuracy"),
        ({"seconds": 100}, "an impulse response of 100 s: it must be longer than 0 s and no longer than 60 s"),
        ({"seconds": 0}, "an impulse response of 0 s: it must be longer than 0 s and no longer than 60 s"),
        ({"seconds": "long"}, "seconds must be a time in s, not 'long'"),
        ({"accuracy": "x"}, "accuracy must be a share, such as 0.02 for 2 %, not 'x'"),
        ({"waves": 1e5}, "waves must be a whole number of waves, not 100000.0"),
        ({"waves": -1}, "waves must be a whole number of waves, not -1"),
        ({"seed": 1.5}, "seed must be a whole number of 0 to 4294967295, not 1.5"),
        ({"seed": 2**32}, "seed must be a whole number of 0 to 4294967295"),
        ({"order": "all"}, "order must be a whole number of reflections, not 'all'"),
        ({"diffraction": 1}, "diffraction must be True or False, not 1"),
        ({"transmission": None}, "transmission must be True or False, not None"),
        ({"profile": 3}, "profile must be the name of an algorithm, not 3"),
        ({"directions": None}, "directions must be the name of start directions, not None"),
        ({"time_limit": "8 s"}, "time_limit must be a time in s, not '8 s'"),
        ({"order": 99}, "order of exact paths must be 0 to 16, not 99"),
        ({"profile": "fast"}, "fast"),
        ({"profile": "thesis"}, "thesis"),
        ({"directions": "spiral"}, "spiral"),
    ],
)
def test_bad_settings_are_refused_in_sentences(room, settings, sentence):
    """Protects users from tracebacks: a setting out of range is named with its range."""
    with pytest.raises(em.SettingsError, match=sentence):
        em.response(room, **settings)


def test_arrays_of_numpy_are_arguments(room):
    """Protects users of NumPy from the checks of types: its numbers and arrays are as good as those of Python."""
    numbers = {"waves": np.int64(2048), "seed": np.uint8(1), "seconds": np.float32(0.25), "order": np.int8(2)}
    r = em.response(room, diffraction=np.bool_(False), **numbers)
    assert r == em.response(room, waves=2048, seed=1, seconds=0.25, order=2)
    np.testing.assert_array_equal(r.ir(rate=np.int32(8000)), r.ir(rate=8000))
    room.add_listener("stalls", np.array([1.0, 0.2, 1.0]), view=np.array([1, 0, 0]), radius=np.float32(0.25))
    assert room.listeners["stalls"] == (1.0, pytest.approx(0.2), 1.0)


def test_a_frame_knows_left_and_right():
    """Protects frames: a source on the left is heard on the left."""
    scene = em.Scene.shoebox((8, 3, 5), 0.5)
    scene.add_source("s", (-3, 0, 0))
    scene.add_listener("l", (1, 0, 0))
    frame = em.trace(scene, waves=16384)
    assert -1 <= frame.pan < -0.1 and frame.left > frame.right and frame.listener_hits > 0
    assert frame.renderer == em.renderer()


def test_missing_figures_and_odd_places_are_reported():
    """Protects newcomers from silent NaN: a reason by band, and a warning for a listener inside a wall."""
    room = em.Scene.shoebox((8, 3, 5), absorption=0.05)
    room.add_source("talker", (-2, 0, -1.5))
    room.add_listener("seat", (2, -0.3, 1.4))
    room.add_listener("ceiling", (2, 1.75, 1.4))
    short = em.response(room, listener="seat", waves=2048, seconds=0.2)
    assert np.isnan(short.figures["t30"][4])
    assert short.gaps[4] == "record too short"
    assert any("use a longer record (seconds)" in note for note in short.notes), short.notes
    assert pickle.loads(pickle.dumps(short)).notes == short.notes
    with pytest.warns(UserWarning, match=r"0\.25 m inside .*room"):
        em.response(room, listener="ceiling", waves=64, seconds=0.2)
    room.add_listener("garden", (7, 0, 0))
    with pytest.warns(UserWarning, match=r"inside the solid around .*room"):
        outside = em.response(room, listener="garden", waves=64, seconds=0.2)
    assert outside.gaps == ["in a solid or outside the room"] * 8
    with pytest.warns(UserWarning, match=r"0\.25 m inside .*room"):
        em.responses([(room, "talker", "ceiling")], waves=64, seconds=0.2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        em.response(room, listener="seat", waves=64, seconds=0.2)
        close = room.copy()
        close.add_listener("close", (-2, 0, -1.4))
        em.response(close, listener="close", waves=64, seconds=0.2)
    bare = em.Scene.shoebox((8, 3, 5), {"floor": "carpet"})
    bare.add_source("talker", (-2, 0, -1.5))
    bare.add_listener("seat", (2, -0.3, 1.4))
    with pytest.warns(UserWarning, match="room/left, room/right, room/ceiling.* have no material"):
        em.response(bare, waves=64, seconds=0.2)


def test_lost_waves_are_warnings():
    """Protects figures from a silent loss of waves: a march that ends at its step limit is a note and a warning."""
    scene = em.Scene.empty()
    # Waves fly far between tori that repeat endlessly.
    scene.add_surface("Repeat(of: Torus(ring: 0.3, tube: 0.05), period: (4, 4, 4))")
    scene.add_source("s", (2, 2, 2))
    scene.add_listener("l", (6, 2, 2), radius=0.5)
    with pytest.warns(UserWarning, match="step limit"):
        r = em.response(scene, waves=4096, seconds=0.1)
    assert any("step limit" in note for note in r.notes)
