"""An opening in an endless rigid wall, line source in front: the modes of the opening, a short duct, are matched to the
fields of the two half spaces. See boundary_elements.py for the conventions and the environment.

    VENV/bin/python scripts/references/doorway.py

writes tests/diffraction/oracle/doorways.tsv: levels in octave bands behind openings of several sizes.
"""

from pathlib import Path

import numpy as np
from scipy.special import hankel1

WIDTH = 0.9  # m
THICKNESS = 0.1  # m
LOWEST = 250  # Hz
# Modes of the duct: eight times those that propagate at 4 kHz.
MODES = 168
# Places as distance in m from the middle of the wall and from the axis.
SOURCES = [(-2.0, 0.0), (-2.0, 1.0)]
RECEIVERS = [(2.0, 0.0), (4.0, 0.0), (3.0, 0.6), (3.0, 1.5), (2.0, 2.0), (1.0, 2.5), (3.0, -1.5)]


def places():
    return tuple(np.array([complex(*place) for place in group]) for group in (SOURCES, RECEIVERS))


def panels(limits, order=16):
    """Nodes and weights of Gauss's rule on the panels between the limits."""
    node, weight = np.polynomial.legendre.leggauss(order)
    middle, half = (limits[1:] + limits[:-1]) / 2, (limits[1:] - limits[:-1]) / 2
    return (middle[:, None] + half[:, None] * node).ravel(), (half[:, None] * weight).ravel()


def mode(number, y):
    """Modes of the duct, whose mean square over the width is 1/WIDTH; y from the axis."""
    norm = np.where(number == 0, 1.0, np.sqrt(2.0)) / np.sqrt(WIDTH)
    return norm * np.cos(number * np.pi * (y / WIDTH + 0.5))


def cosine_integral(rate, phase, end):
    """Integral of cos(rate y + phase) from 0 to end."""
    flat = end * np.cos(phase)
    steep = np.where(rate == 0, 1.0, rate)
    return np.where(rate == 0, flat, (np.sin(rate * end + phase) - np.sin(phase)) / steep)


def overlap(m, n, shift):
    """Integral over y of mode m at y times mode n at y + shift."""
    a, b, end = m * np.pi / WIDTH, n * np.pi / WIDTH, WIDTH - shift
    norm = np.where(m == 0, 1, np.sqrt(2)) * np.where(n == 0, 1, np.sqrt(2)) / WIDTH
    both = cosine_integral(a - b, -b * shift, end) + cosine_integral(a + b, b * shift, end)
    return norm / 2 * both


def impedance(k, modes):
    """Pressure of mode m on the wall for the gradient of mode n, half space with a rigid wall: (i/2) H0."""
    # Panels shrink towards the logarithm of H0 at 0.
    graded = WIDTH * 0.5 ** np.arange(40, 6, -1)
    shift, weight = panels(np.concatenate([[0.0], graded, WIDTH * np.arange(1, 65) / 64]))
    kernel = 0.5j * hankel1(0, k * shift) * weight
    number = np.arange(modes)
    m, n = number[:, None], number[None, :]
    return sum((overlap(m, n, u) + overlap(n, m, u)) * value for u, value in zip(shift, kernel))


def duct_amplitudes(k, sources, modes):
    """Gradients of the modes at the far end of the duct, a column for each source."""
    number = np.arange(modes)
    y, weight = panels(WIDTH * (np.arange(65) / 64 - 0.5))
    shapes = mode(number[:, None], y) * weight
    away = np.abs(sources[:, None] - (-THICKNESS / 2 + 1j * y))
    incident = shapes @ (2 * 0.25j * hankel1(0, k * away)).T
    axial = np.sqrt((k**2 - (number * np.pi / WIDTH) ** 2).astype(complex))
    decay = np.exp(1j * axial * THICKNESS)
    z, one = impedance(k, modes), np.eye(modes)
    # Forward waves f and backward waves b: pressure f + decay b in front, decay f + b behind.
    front = np.hstack([one - z * (1j * axial), one * decay + z * (1j * axial * decay)])
    back = np.hstack([one * decay + z * (1j * axial * decay), one - z * (1j * axial)])
    right = np.vstack([incident, np.zeros_like(incident)])
    forward, backward = np.split(np.linalg.solve(np.vstack([front, back]), right), 2)
    return 1j * axial[:, None] * (decay[:, None] * forward - backward)


def pressures(k, sources, receivers, modes=MODES):
    """Total field behind the wall relative to the free field, a row for each source."""
    gradients = duct_amplitudes(k, sources, modes)
    y, weight = panels(WIDTH * (np.arange(65) / 64 - 0.5))
    away = np.abs(receivers[:, None] - (THICKNESS / 2 + 1j * y))
    radiated = -(0.5j * hankel1(0, k * away) * weight) @ mode(np.arange(modes)[:, None], y).T @ gradients
    free = 0.25j * hankel1(0, k * np.abs(sources[:, None] - receivers))
    return radiated.T / free


SPEED_OF_SOUND = 343.0  # m/s
OCTAVES = [125, 250, 500, 1000, 2000, 4000]  # Hz
OUTPUT = Path(__file__).parents[2] / "tests/diffraction/oracle/doorways.tsv"
# Thickness and width in m.
OPENINGS = [(0.1, 0.9), (0.2, 0.9), (0.3, 0.9), (0.1, 1.5), (0.25, 0.7), (0.15, 1.2)]
# Places drawn for each opening, besides the fixed ones.
DRAWN_SOURCES, DRAWN_RECEIVERS, SEED = 1, 5, 3


def octave_levels(centre, sources, receivers):
    """Levels in dB relative to the open: means of nine frequencies, a row for each source."""
    energy = 0
    for step in range(-4, 5):
        k = 2 * np.pi * centre * 2 ** (step / 9) / SPEED_OF_SOUND
        modes = max(24, int(6 * WIDTH * k / np.pi) + 8)
        energy = energy + np.abs(pressures(k, sources, receivers, modes)) ** 2
    return 10 * np.log10(energy / 9)


def rows(thickness, width, random):
    global THICKNESS, WIDTH
    THICKNESS, WIDTH = thickness, width
    fixed_sources, fixed_receivers = places()
    drawn = [-random.uniform(1.5, 4, DRAWN_SOURCES), random.uniform(-1, 1.5, DRAWN_SOURCES)]
    sources = np.concatenate([fixed_sources, drawn[0] + 1j * drawn[1]]).round(2)
    drawn = [random.uniform(1, 4, DRAWN_RECEIVERS), random.uniform(-2.5, 2.5, DRAWN_RECEIVERS)]
    receivers = np.concatenate([fixed_receivers, drawn[0] + 1j * drawn[1]]).round(2)
    levels = np.array([octave_levels(centre, sources, receivers) for centre in OCTAVES])
    for s, source in enumerate(sources):
        for r, receiver in enumerate(receivers):
            ends = [source.real, source.imag, receiver.real, receiver.imag]
            yield [thickness, width, *ends, *levels[:, s, r].round(2)]


def main():
    random = np.random.default_rng(SEED)
    bands = "\t".join(f"{centre} Hz" for centre in OCTAVES)
    lines = [
        "# Levels in dB of a line source behind an opening in an endless rigid wall, relative to the open: means of octave",
        "# bands, made by: python scripts/references/doorway.py",
        f"# thick_m\twidth_m\tsource x\ty\treceiver x\ty\t{bands}",
    ]
    for opening in OPENINGS:
        lines += ["\t".join(f"{number:g}" for number in row) for row in rows(*opening, random)]
    OUTPUT.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
