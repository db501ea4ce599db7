"""Fixtures: rooms, the program, files."""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import echomarch as em

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
SCENES = REPOSITORY / "examples" / "scenes"


@pytest.fixture
def room():
    """A room that takes a tenth of a second."""
    room = em.Scene.shoebox((8, 3, 5), {"floor": "carpet", "ceiling": 0.6, "left": 0.2, "right": 0.3, "front": 0.1, "back": 0.2})
    room.add_source("talker", (-2, 0, -1.5))
    room.add_listener("seat", (2, -0.3, 1.5), yaw=30)
    return room


@pytest.fixture(scope="session")
def program():
    """Run the program echomarch; ECHOMARCH names its file."""
    path = os.environ.get("ECHOMARCH")
    if not path:
        pytest.skip("ECHOMARCH does not name the program")

    def run(*arguments):
        done = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True)
        return done

    return run


@pytest.fixture
def figures_of(program):
    """The JSON output of ``echomarch impulse``."""

    def run(scene, *arguments):
        done = program("impulse", scene, "--json", "--quiet", *arguments)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


@pytest.fixture
def python(tmp_path):
    """Run a script in a new Python process, outside of the repository."""

    def run(script, **keywords):
        file = tmp_path / "script.py"
        file.write_text(script)
        return subprocess.run(
            [sys.executable, str(file)], capture_output=True, text=True, cwd=tmp_path, timeout=300, **keywords
        )

    return run


@pytest.fixture(scope="session")
def hrirs(tmp_path_factory):
    """A SOFA file with head-related impulse responses of a made-up head."""
    sofar = pytest.importorskip("sofar")
    azimuths, elevations = np.meshgrid(np.arange(0, 360, 30), [-60, -30, 0, 30, 60])
    angles = np.stack([azimuths.ravel(), elevations.ravel()], axis=1).astype(float)
    angles = np.vstack([angles, [0, 90], [0, -90]])
    count = len(angles)
    # The ear on the side of the source is louder and earlier.
    side = np.sin(np.radians(angles[:, 0])) * np.cos(np.radians(angles[:, 1]))
    samples = np.zeros((count, 2, 64))
    for ear, sign in enumerate((1.0, -1.0)):
        delays = np.round(16 - 12 * sign * side).astype(int)
        samples[np.arange(count), ear, delays] = 0.6 + 0.4 * sign * side
    made = sofar.Sofa("SimpleFreeFieldHRIR")
    made.SourcePosition = np.column_stack([angles, np.full(count, 1.5)])
    made.Data_IR = samples
    made.Data_SamplingRate = 48000.0
    made.Data_Delay = np.zeros((1, 2))
    made.ReceiverPosition = np.array([[0, 0.09, 0], [0, -0.09, 0]])
    file = tmp_path_factory.mktemp("sofa") / "head.sofa"
    sofar.write_sofa(str(file), made)
    return file
