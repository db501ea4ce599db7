"""Writes tests/diffraction/oracle/boundary_elements.tsv: thick bars and a doorway between line sources and receivers.

    python3 -m venv VENV && VENV/bin/pip install numpy==2.4.6 scipy==1.17.1
    VENV/bin/python scripts/references/boundary_elements.py

check_boundary_elements.py prints the errors. Two dimensions, rigid surfaces, time dependence e^(-i w t), points as
complex numbers. A pressure is the quotient of the total field and the free field of the line source at the direct
distance.

Bodies in the open: Helmholtz's integral equation for the pressure on the surface, p/2 = p_free + D p, by Nystroem's
method on panels of Gauss nodes that halve towards the corners. It has spurious solutions near the eigenfrequencies of
the body's inside; equations for points inside, where the field is 0, exclude them (H. A. Schenck, J. Acoust. Soc. Am.
44, 1968). The doorway is an opening in an endless wall: see doorway.py.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import solve
from scipy.special import hankel1

import doorway

SPEED_OF_SOUND = 343.0  # m/s
OCTAVES = [63, 125, 250, 500, 1000, 2000, 4000]  # Hz
OUTPUT = Path(__file__).parents[2] / "tests/diffraction/oracle/boundary_elements.tsv"

NODES = 12  # per panel
PANEL_WAVELENGTHS = 1.0  # longest panel
CORNER_PANELS = 9  # that halve towards each corner
INSIDE_POINTS = 80  # in each body, no nearer to its sides than 2/5 of its thickness
SEED = 1

BAR_HEIGHT = 2.0  # m
BAR_WIDTHS = [0.1, 0.3, 1.0]  # m
# Distances in m in front of and behind the bar's faces, and heights above its middle.
BAR_SOURCES = [(2.0, 0.0), (1.5, 0.6)]
BAR_RECEIVERS = [(3.0, 0.0), (3.0, 0.5), (2.0, 1.0), (1.0, 0.8), (3.0, 1.4), (3.0, 2.5), (-0.02, 1.6)]
CYLINDER_RADIUS = 0.5  # m
CYLINDER_SOURCE = (2.0, 0.0)
CYLINDER_RECEIVERS = [(-2.0, 0.0), (-1.5, 0.7), (0.0, 1.5), (1.0, 1.0)]


@dataclass
class Surface:
    """Nodes on closed curves with weights in m, normals into the air, curvatures in 1/m, and points inside."""

    nodes: np.ndarray
    weights: np.ndarray
    normals: np.ndarray
    curvatures: np.ndarray
    inside: np.ndarray


def gauss(limits):
    """Nodes and weights on the panels between the limits."""
    node, weight = np.polynomial.legendre.leggauss(NODES)
    middle, half = (limits[1:] + limits[:-1]) / 2, (limits[1:] - limits[:-1]) / 2
    return (middle[:, None] + half[:, None] * node).ravel(), (half[:, None] * weight).ravel()


def side_limits(length, longest):
    """Ends of panels on a side with corners at 0 and `length`."""
    first = min(longest, length / 3)
    corner = first * 0.5 ** np.arange(CORNER_PANELS, -1, -1)
    count = int(np.ceil((length - 2 * first) / longest))
    middle = np.linspace(first, length - first, count + 1)
    return np.concatenate([[0.0], corner[:-1], middle, length - corner[-2::-1], [length]])


def rectangles(corners, longest):
    """Surface of rectangles, each the four corners counterclockwise."""
    nodes, weights, normals, inside = [], [], [], []
    random = np.random.default_rng(SEED)
    for a, b, c, d in corners:
        for start, end in ((a, b), (b, c), (c, d), (d, a)):
            direction = (end - start) / abs(end - start)
            place, weight = gauss(side_limits(abs(end - start), longest))
            nodes.append(start + direction * place)
            weights.append(weight)
            normals.append(np.full(len(place), -1j * direction))
        sides = np.array([b - a, d - a])
        margin = 0.4 * abs(sides).min() / abs(sides)
        shares = margin + (1 - 2 * margin) * random.random((INSIDE_POINTS, 2))
        inside.append(a + shares @ sides)
    joined = [np.concatenate(parts) for parts in (nodes, weights, normals)]
    return Surface(*joined, np.zeros(len(joined[0])), np.concatenate(inside))


def circle(radius, longest):
    """Surface of a circle about 0."""
    angle, weight = gauss(np.linspace(0, 2 * np.pi, int(np.ceil(2 * np.pi * radius / longest)) + 1))
    random = np.random.default_rng(SEED)
    inside = 0.7 * radius * np.sqrt(random.random(INSIDE_POINTS)) * np.exp(2j * np.pi * random.random(INSIDE_POINTS))
    normals = np.exp(1j * angle)
    return Surface(radius * normals, radius * weight, normals, np.full(len(angle), 1 / radius), inside)


def double_layer(k, points, surface):
    """Derivative of G = (i/4) H0(k r) along the normal at each node times its weight, a row for each point."""
    away = surface.nodes - points[:, None]
    distance = abs(away)
    apart = np.where(distance == 0, 1, distance)
    across = (away * surface.normals.conjugate()).real / apart
    # On a side the factor is exactly 0, except for rounding.
    across[abs(across) < 1e-9] = 0
    kernel = -0.25j * k * hankel1(1, k * apart) * across
    kernel = np.where(distance == 0, -surface.curvatures / (4 * np.pi), kernel)
    return kernel * surface.weights


def line_source(k, source, points):
    return 0.25j * hankel1(0, k * abs(points - source))


def surface_pressures(k, surface, sources):
    """Pressures at the nodes, a column for each source, by least squares with the square roots of the weights."""
    root = np.sqrt(surface.weights)
    inside_root = np.sqrt(surface.weights.sum() / len(surface.inside))
    on_surface = 0.5 * np.eye(len(root)) - double_layer(k, surface.nodes, surface)
    equations = [root[:, None] * on_surface / root, -inside_root * double_layer(k, surface.inside, surface) / root]
    free = [root[:, None] * np.array([line_source(k, source, surface.nodes) for source in sources]).T]
    free.append(inside_root * np.array([line_source(k, source, surface.inside) for source in sources]).T)
    left, right = np.vstack(equations), np.vstack(free)
    adjoint = left.conj().T
    return solve(adjoint @ left, adjoint @ right, assume_a="pos") / root[:, None]


def pressures(k, surface, sources, receivers):
    """Total field relative to the free field, a row for each source and a column for each receiver."""
    scattered = double_layer(k, receivers, surface) @ surface_pressures(k, surface, sources)
    free = np.array([line_source(k, source, receivers) for source in sources])
    return 1 + scattered.T / free


def longest_panel(k, thickness):
    """Panels are no longer than the body is thick: opposite sides are near each other."""
    return min(PANEL_WAVELENGTHS * 2 * np.pi / k, thickness)


def bar(k, width):
    x, y = width / 2, BAR_HEIGHT / 2
    corners = [complex(x, -y), complex(x, y), complex(-x, y), complex(-x, -y)]
    return rectangles([corners], longest_panel(k, width))


def bar_places(width):
    sources = np.array([complex(-width / 2 - x, y) for x, y in BAR_SOURCES])
    return sources, np.array([complex(width / 2 + x, y) for x, y in BAR_RECEIVERS])


def cylinder(k):
    return circle(CYLINDER_RADIUS, longest_panel(k, CYLINDER_RADIUS / 4))


def cylinder_places():
    return np.array([complex(*CYLINDER_SOURCE)]), np.array([complex(*place) for place in CYLINDER_RECEIVERS])


def cases(frequency):
    """Name, width, sources, receivers and pressures of each body at a frequency."""
    k = 2 * np.pi * frequency / SPEED_OF_SOUND
    for width in BAR_WIDTHS:
        places = bar_places(width)
        yield "bar", width, *places, pressures(k, bar(k, width), *places)
    places = cylinder_places()
    yield "cylinder", 2 * CYLINDER_RADIUS, *places, pressures(k, cylinder(k), *places)
    if frequency >= doorway.LOWEST:
        places = doorway.places()
        yield "doorway", doorway.WIDTH, *places, doorway.pressures(k, *places)


def write():
    lines = [
        "# Sound fields of line sources in two dimensions, made by: python scripts/references/boundary_elements.py",
        "# bar: rigid rectangle, width_m along x, 2 m along y, its middle at 0. cylinder: diameter width_m, at 0.",
        "# doorway: opening of width_m about y = 0 in an endless rigid wall, 0.1 m thick, its middle at x = 0.",
        "# re, im: total field relative to the free field of the line source, e^(-i w t), c = 343 m/s.",
        "# check_boundary_elements.py: bars change by at most 0.001 dB with finer panels, the cylinder is within 0.001 dB of its",
        "# series, the doorway changes by at most 0.03 dB with twice the modes, and by 0.17 dB with walls of 6 m (250, 500 Hz).",
        "body\twidth_m\tfrequency_hz\tsource_x\tsource_y\treceiver_x\treceiver_y\tre\tim",
    ]
    for frequency in OCTAVES:
        for body, width, sources, receivers, found in cases(frequency):
            for source, row in zip(sources, found):
                for receiver, p in zip(receivers, row):
                    numbers = [source.real, source.imag, receiver.real, receiver.imag]
                    places = "\t".join(f"{number:g}" for number in numbers)
                    lines.append(f"{body}\t{width:g}\t{frequency}\t{places}\t{p.real:.6f}\t{p.imag:.6f}")
        print(f"{frequency} Hz", file=sys.stderr)
    OUTPUT.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    write()
