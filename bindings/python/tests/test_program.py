"""Python's results equal the program's to the last digit."""

import csv
import subprocess

import numpy as np
import pytest

import echomarch as em
from conftest import SCENES


def samples_of(file):
    """The float samples of a WAV file, shape (channels, samples)."""
    data = file.read_bytes()
    place, channels = 12, 0
    while place < len(data):
        name, length = data[place : place + 4], int.from_bytes(data[place + 4 : place + 8], "little")
        body = data[place + 8 : place + 8 + length]
        if name == b"fmt ":
            channels = int.from_bytes(body[2:4], "little")
        if name == b"data":
            return np.frombuffer(body, "<f4").reshape(-1, channels).T
        place += 8 + length + length % 2
    raise AssertionError("the file has no samples")


def or_nan(numbers):
    return np.array([np.nan if number is None else number for number in numbers])


@pytest.mark.parametrize(
    "scene, arguments, settings",
    [
        ("shoebox", ["--accuracy", "5%", "--seconds", "0.4"], {"accuracy": 0.05, "seconds": 0.4}),
        (SCENES / "hall.ron", ["--waves", "4096", "--seconds", "0.5"], {"waves": 4096, "seconds": 0.5}),
        (
            SCENES / "pillar.ron",
            ["--waves", "4096", "--seconds", "0.2", "--diffraction", "--order", "2", "--seed", "7"],
            {"waves": 4096, "seconds": 0.2, "diffraction": True, "order": 2, "seed": 7},
        ),
        (
            SCENES / "attic.ron",
            ["--waves", "2048", "--seconds", "0.2", "--profile", "march", "--directions", "fibonacci"],
            {"waves": 2048, "seconds": 0.2, "profile": "march", "directions": "fibonacci"},
        ),
    ],
)
def test_figures_and_paths_equal_the_programs(figures_of, scene, arguments, settings):
    """Protects every figure, every error and every path: the same settings and seed give the same digits."""
    for item in em.Scene(scene).pairs():
        report = figures_of(scene, "--source", item[1], "--listener", item[2], *arguments)
        [pair] = report["pairs"]
        r = em.response(*item, **settings)
        assert r.renderer == report["renderer"]
        assert_equals(r, pair)


def assert_equals(r, pair):
    """Assert that a response has the digits of the program's JSON."""
    assert (r.source, r.listener) == (pair["source"], pair["listener"])
    assert (r.waves, r.seconds) == (pair["waves"], pair["seconds"])
    for name, column in zip(em._echomarch.FIGURES, em.FIGURES):
        np.testing.assert_array_equal(r.figures[column], or_nan(pair[name]), err_msg=name)
        np.testing.assert_array_equal(r.figures[column + "_error"], or_nan(pair["error"][name]), err_msg=name)
    assert list(r.paths["kind"]) == [path["kind"] for path in pair["paths"]]
    for name in ("delay_s", "order", "azimuth_deg"):
        np.testing.assert_array_equal(r.paths[name], [path[name] for path in pair["paths"]], err_msg=name)
    np.testing.assert_array_equal(r.paths["g_db"], or_nan(path["g_db"] for path in pair["paths"]))
    assert r.left_out_share == pair["left_out_share"]
    assert r.notes == pair["notes"][: len(r.notes)]
    np.testing.assert_array_equal(r.cut_off, or_nan(pair["cut_off"]))


@pytest.mark.parametrize(
    "arguments, settings",
    [
        (["--waves", "4096", "--seconds", "0.3"], {"waves": 4096, "seconds": 0.3}),
        (["--accuracy", "2%", "--seed", "5"], {"accuracy": 0.02, "seed": 5}),
    ],
)
def test_all_pairs_of_a_scene_equal_the_programs(figures_of, room, tmp_path, arguments, settings):
    """Protects many pairs: listeners traced together have the program's digits, in this process and in others."""
    room.add_source("piano", (1, 0.2, 1), level_db=-6)
    room.add_listener("balcony", (-3, 0.8, 2), radius=0.5)
    room.add_listener("door", (3.5, 0, -2))
    file = tmp_path / "room.ron"
    room.save(file)
    expected = figures_of(file, *arguments)["pairs"]
    scene = em.Scene(file)
    found = em.responses(scene.pairs(), **settings)
    assert len(found) == len(expected) == 6
    for r, pair in zip(found, expected):
        assert_equals(r, pair)
    assert em.responses(scene.pairs(), workers=2, **settings) == found


def test_a_scene_made_in_python_equals_its_file(figures_of, room, tmp_path):
    """Protects scenes put together in Python: the written file gives the same digits in the program."""
    room.add_surface("Box(size: (1, 0.8, 0.6))", (0.5, -1.1, 0.2), (0, 20, 0), material=0.3, name="desk")
    room.set_air(18, 40)
    file = tmp_path / "room.ron"
    room.save(file)
    pair = figures_of(file, "--waves", "4096", "--seconds", "0.3")["pairs"][0]
    r = em.response(em.Scene(file), waves=4096, seconds=0.3)
    np.testing.assert_array_equal(r.figures["g"], or_nan(pair["g_db"]))
    np.testing.assert_allclose(em.response(room, waves=4096, seconds=0.3).figures["g"], r.figures["g"], atol=0.1)


@pytest.mark.parametrize("format, option", [("mono", "mono"), ("stereo", "stereo"), ("ambisonics", "ambisonic")])
def test_samples_equal_the_programs(program, tmp_path, format, option):
    """Protects impulse responses: every sample of every channel is the program's."""
    file = tmp_path / "ir.wav"
    done = program(
        "impulse", "shoebox", "-o", file, "--format", option, "--rate", 44100, "--waves", 2048, "--seconds", "0.2"
    )
    assert done.returncode == 0, done.stderr
    r = em.response(em.Scene("shoebox"), waves=2048, seconds=0.2)
    samples = r.ir(rate=44100, format=format)
    assert samples.dtype == np.float32 and np.abs(samples).max() > 0
    np.testing.assert_array_equal(samples, samples_of(file))


def test_binaural_samples_equal_the_programs(program, tmp_path, hrirs):
    """Protects binaural impulse responses, at a rate other than that of the SOFA file."""
    file = tmp_path / "ir.wav"
    settings = ["--rate", 44100, "--waves", 2048, "--seconds", "0.2"]
    done = program("impulse", "shoebox", "-o", file, "--format", "binaural", "--sofa", hrirs, *settings)
    assert done.returncode == 0, done.stderr
    r = em.response(em.Scene("shoebox"), waves=2048, seconds=0.2)
    samples = r.ir(rate=44100, format="binaural", sofa=hrirs)
    assert not np.array_equal(samples[0], samples[1])
    np.testing.assert_array_equal(samples, samples_of(file))


def test_the_echogram_equals_the_programs(program, tmp_path):
    """Protects the echogram: times, energies and directions of each bin and band."""
    file = tmp_path / "echogram.csv"
    done = program("impulse", "shoebox", "--echogram", file, "--waves", 2048, "--seconds", "0.1")
    assert done.returncode == 0, done.stderr
    rows = np.array([list(map(float, row)) for row in list(csv.reader(file.open()))[1:]]).reshape(-1, 8, 6)
    echogram = em.response(em.Scene("shoebox"), waves=2048, seconds=0.1).echogram
    np.testing.assert_array_equal(echogram["time_s"], rows[:, 0, 0])
    np.testing.assert_array_equal(echogram["energy"], rows[:, :, 2])
    np.testing.assert_array_equal(echogram["flow"], rows[:, :, 3:])


def test_frames_equal_the_programs(program):
    """Protects frames: the balance and the counts of waves."""
    import json

    for scene, profile in (("corner", "hybrid"), ("obstacles", "thesis")):
        done = program("trace", scene, "--json", "--waves", 4096, "--profile", profile, "--seed", 3)
        assert done.returncode == 0, done.stderr
        frame = em.trace(em.Scene(scene), waves=4096, profile=profile, seed=3)
        text = json.dumps(json.loads(done.stdout))
        for number in (frame.left, frame.right, frame.pan):
            assert repr(number) in text, (scene, number, text)


def test_refusals_have_the_programs_sentences(program, tmp_path):
    """Protects the sentences of errors: an exception says what the program says."""
    broken = tmp_path / "broken.ron"
    broken.write_text("Scene(surfaces: [Surface(shape: Bx)])")
    for scene in ("cornr", str(broken), str(tmp_path / "none.ron")):
        done: subprocess.CompletedProcess = program("impulse", scene, "--quiet")
        with pytest.raises(em.SceneError) as refused:
            em.Scene(scene)
        assert done.returncode == 2 and str(refused.value) in done.stderr, done.stderr


def test_studies_equal_the_programs(program, tmp_path):
    """Protects studies: the same table, from one process, from two, and continued."""
    study = tmp_path / "study.ron"
    study.write_text(
        'Study(scenes: [Scene(of: "corner")], listeners: Grid(from: (-9, 0, 0), to: (9, 0, 0), counts: (5, 1, 1)), '
        "settings: All(waves: [1024]), seeds: Range(from: 1, count: 8))"
    )
    done = program("study", study, "-o", tmp_path / "program", "--quiet")
    assert done.returncode == 0, done.stderr
    expected = (tmp_path / "program" / "study.csv").read_bytes()
    read = em.Study(study)
    counts = []
    rows = read.run(tmp_path / "one", progress=counts.append)
    assert (tmp_path / "one" / "study.csv").read_bytes() == expected
    assert len(rows) == read.points == 40 and counts[-1] == 40
    assert rows["pan"].min() < rows["pan"].max()
    read.run(tmp_path / "two", workers=2)
    assert (tmp_path / "two" / "study.csv").read_bytes() == expected
    np.testing.assert_array_equal(read.run(), rows)
    with pytest.raises(em.StudyError, match="none.ron"):
        em.Study(tmp_path / "none.ron")


def test_a_study_maps_an_own_scene(room, tmp_path):
    """Protects maps of scenes whose listener has a name, as the listeners of this package do."""
    room.save(tmp_path / "room.ron")
    study = tmp_path / "map.ron"
    study.write_text(
        'Study(scenes: [Scene(of: "room.ron")], settings: All(waves: [4096]), '
        "listeners: Grid(from: (-3, 0, -2), to: (3, 0, 2), counts: (2, 1, 2)), "
        "keep: Keep(response: Response(figures: [g], bands_hz: [1000], seconds: 1)))"
    )
    table = em.Study(study).run()
    assert list(table["listener_x_m"]) == [-3, 3, -3, 3]
    assert len(np.unique(table["g_db_1000"])) == 4 and np.all(table["g_db_1000"] > 0)
