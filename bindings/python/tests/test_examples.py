"""The notebook and the examples run, and say what they should."""

import pathlib
import re
import subprocess
import sys

import pytest

import echomarch as em

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"


def test_the_notebook_runs(tmp_path):
    """Protects the notebook: every cell runs; curtains shorten the decay, and the walk goes from one ear to the other."""
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.read(EXAMPLES / "first_room.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "commit the notebook without outputs"
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "".join(output.get("text", "") for output in shown)
    plaster, curtain = (numbers(text, f"{name} T30 in s by octave band:") for name in ("plaster", "curtain"))
    assert len(plaster) == 8 and all(a > b for a, b in zip(plaster[1:], curtain[1:]))
    walk = numbers(text, "left minus right in dB by step:")
    # The talker is first on the right of the listener, then on the left.
    assert walk[0] < -0.5 and walk[-1] > 0.5
    kinds = [kind for output in shown for kind in output.get("data", {})]
    assert kinds.count("image/png") == 3 and any("<audio" in output.get("data", {}).get("text/html", "") for output in shown)


def numbers(text, label):
    """The numbers in brackets after a label."""
    found = re.search(re.escape(label) + r" \[([^\]]*)\]", text)
    assert found, text
    return [float(number.strip(",")) for number in found.group(1).split()]


def test_the_tutorial_runs_side_by_side():
    """Protects the tutorial: both programs give the same reverberation time, and the direct sound is in time."""
    pytest.importorskip("pyroomacoustics")
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "beside_pyroomacoustics.py")], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    names = ("echomarch", "pyroomacoustics")
    ours, theirs = ([float(number) for number in re.findall(rf"{name} +T30 ([\d.]+) s", done.stdout)] for name in names)
    # The responses of pyroomacoustics vary by some per cent from run to run.
    assert len(ours) == 2 and ours == pytest.approx(theirs, rel=0.1), done.stdout
    direct = [float(number) for number in re.findall(r"direct sound after ([\d.]+) ms", done.stdout)]
    peaks = [float(number) for number in re.findall(r"echomarch .* peak after ([\d.]+) ms", done.stdout)]
    # Half a sample at 16 kHz, and the rounding of the output.
    assert peaks == pytest.approx(direct, abs=0.04)


def test_the_measurement_runs():
    """Protects the measurement: a rough run gives a row for each program."""
    pytest.importorskip("pyroomacoustics")
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "measure.py"), "--quick", "--rooms", "shoebox"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("| shoebox |") == 3 and "times as fast" in done.stdout


def test_the_models_of_scattering_differ():
    """Protects the reason for different decay times: image sources, and rays that scatter by two models."""
    pytest.importorskip("pyroomacoustics")
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "decay_models.py"), "--rays", "3000", "--rounds", "1", "--quick"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    chance, blend = (float(re.search(rf"L, {model}: ([\d.]+)", done.stdout)[1]) for model in ("chance", "blend"))
    # 0.80 and 0.71 s with many rays; the spread of 3,000 rays is 0.01 s.
    assert chance == pytest.approx(0.80, abs=0.04) and blend == pytest.approx(0.71, abs=0.04), done.stdout
    ours = em.responses(measured_room("L").echomarch().pairs(), waves=16384, seed=1)[0].figures["t30"][4]
    assert ours == pytest.approx(chance, abs=0.04)


def measured_room(name):
    """A room of measure.py."""
    sys.path.insert(0, str(EXAMPLES))
    try:
        import measure
    finally:
        sys.path.pop(0)
    return measure.ROOMS[name]
