#!/usr/bin/env python3
"""Draws the level behind a thin wall over the height of the listener, beside the exact solution for a half plane.

usage: scripts/report/shadow.py [PROGRAM] [-o docs/images/shadow.svg]

PROGRAM is the echomarch program (default target/release/echomarch). Needs nothing but Python.
"""

import argparse
import cmath
import json
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from common import plot  # noqa: E402

BANDS_HZ = [63, 250, 1000, 4000]
SPEED = 343.0
# Heights of source and listeners above the edge of the wall, and distances from the wall, in metres.
SOURCE = (-3.0, -1.0)
LISTENER_X = 4.0
HEIGHTS = [-2.4 + 0.1 * step for step in range(55)]
# Frequencies of an octave band, as exponents of 2 in relation to its centre.
OCTAVE = [(index - 6) / 13 for index in range(13)]

# Intervals of the integral of an edge wave.
STEPS = 600

SCENE = """Scene(
    surfaces: [Surface(shape: Box(size: (0.0001, 2000, 2000)), position: (0, -1000, 0))],
    source: Source(position: ({}, {}, 0)),
    listener: Listener(position: ({}, {}, 0), radius: 0.05),
)
"""


def level_of_program(program, height, folder):
    """Levels of the bands relative to the open, in dB."""
    scene = folder / "wall.ron"
    scene.write_text(SCENE.format(*SOURCE, LISTENER_X, height))
    command = [program, "impulse", str(scene), "--diffraction", "--waves", "64", "--seconds", "0.1", "--json"]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{ran.stderr}")
    answer = json.loads(ran.stdout)
    pair = answer["pairs"][0]
    at = [pair["bands_hz"].index(hertz) for hertz in BANDS_HZ]
    energies = [sum(10 ** (path["g_db_bands"][band] / 10) for path in pair["paths"]) for band in at]
    apart = math.dist(SOURCE, (LISTENER_X, height))
    # G is relative to the open at 10 m.
    return [10 * math.log10(energy) + 20 * math.log10(apart / 10) for energy in energies]


def exact_level(hertz, height):
    """Level of an octave band behind a rigid half plane, relative to the open, in dB."""
    energies = [abs(half_plane(2 * math.pi * hertz * 2**octave / SPEED, height)) ** 2 for octave in OCTAVE]
    apart = math.dist(SOURCE, (LISTENER_X, height))
    return 10 * math.log10(sum(energies) / len(energies)) + 20 * math.log10(apart)


def half_plane(k, height):
    """The pressure of a point source of strength 1 at a half plane that hangs down from the origin.

    The solution of Biot and Tolstoy in the frequency domain (Svensson, Fred and Vanderkooy 1999) for an air angle of 360°,
    with the direct and the mirrored sound where they exist.
    """
    ends = SOURCE, (LISTENER_X, height)
    # Angles from the face that the source sees: clockwise from below.
    angles = [(-math.pi / 2 - math.atan2(y, x)) % (2 * math.pi) for x, y in ends]
    lengths = [math.hypot(x, y) for x, y in ends]
    total = 0
    for between in (angles[0] - angles[1], angles[0] + angles[1]):
        if abs(between) < math.pi:
            apart = math.sqrt(sum(r * r for r in lengths) - 2 * math.prod(lengths) * math.cos(between))
            total += cmath.exp(1j * k * apart) / apart
    turns = [math.pi + one * angles[0] + other * angles[1] for one in (1, -1) for other in (1, -1)]
    return total - sum(edge_wave(k, turn, lengths) for turn in turns) / (4 * math.pi)


def edge_wave(k, turn, lengths):
    """The integral of sin ½φ / (cosh ½η − cos ½φ) · e^{ikl} / l over η, on the path η = x + i·atan x, for φ = `turn`."""
    sine, cosine = math.sin(turn / 2), math.cos(turn / 2)

    def integrand(x):
        eta = complex(x, math.atan(x))
        way = cmath.sqrt(sum(r * r for r in lengths) + 2 * math.prod(lengths) * cmath.cosh(eta))
        value = sine / (cmath.cosh(eta / 2) - cosine) * cmath.exp(1j * k * way) / way
        return value * complex(1, 1 / (1 + x * x))

    # Simpson's rule over ln x: the integrand has a narrow peak at 0 near the boundary of the shadow.
    low, high = math.log(1e-8), math.log(12)
    width = (high - low) / STEPS
    weights = [1 if step in (0, STEPS) else 4 if step % 2 else 2 for step in range(STEPS + 1)]
    places = [math.exp(low + step * width) for step in range(STEPS + 1)]
    return sum(weight * x * integrand(x) for weight, x in zip(weights, places)) * width / 3


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program", nargs="?", default="target/release/echomarch", metavar="PROGRAM")
    options.add_argument("-o", default="docs/images/shadow.svg", metavar="FILE", help="the picture to write")
    options = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        levels = [level_of_program(options.program, height, pathlib.Path(folder)) for height in HEIGHTS]
    panels, errors = [], []
    for band, hertz in enumerate(BANDS_HZ):
        exact = [exact_level(hertz, height) for height in HEIGHTS]
        found = [level[band] for level in levels]
        errors += [one - other for one, other in zip(found, exact)]
        lines = {"exact": list(zip(HEIGHTS, exact)), "echomarch": list(zip(HEIGHTS, found))}
        panels.append((f"{hertz} Hz", "height of the listener above the edge in m", "level in dB", lines))
    title = "Level behind a half plane, relative to the open"
    pathlib.Path(options.o).write_text(plot.svg(title, panels, columns=2, scale=plot.Linear))
    rms = math.sqrt(sum(error * error for error in errors) / len(errors))
    print(f"{len(errors)} levels: root mean square of the errors {rms:.2f} dB, greatest {max(map(abs, errors)):.2f} dB")


if __name__ == "__main__":
    main()
