"""The scenes of the comparison, as scene files of Echomarch and as text files for the other programs.

A is an empty room. B is the same room with two walls and three pillars. B16 … B1024 have 16 to
1024 thin pillars on an even grid instead of the three pillars. Coordinates are in metres from a corner of the room.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path

ROOM = (30.0, 20.0, 30.0)
SOURCE = (7.0, 5.0, 9.0)
LISTENER = (22.0, 8.0, 19.0)
LISTENER_RADIUS = 1.0
WALLS = [((12.0, 0.0, 0.0), (13.0, 20.0, 18.0)), ((18.0, 0.0, 12.0), (19.0, 20.0, 30.0))]
PILLARS = [(6.0, 22.0, 1.0), (15.5, 15.0, 1.0), (24.0, 8.0, 1.0)]
THIN = 0.3
NAMES = ["A", "B", "B16", "B64", "B256", "B1024"]
SEED = 1


@dataclass
class Scene:
    """A scene. A box is given by two corners, a pillar by x, z and radius."""

    name: str
    boxes: list = field(default_factory=list)
    pillars: list = field(default_factory=list)

    @property
    def surfaces(self):
        return 1 + len(self.boxes) + len(self.pillars)


def scene(name):
    if name == "A":
        return Scene(name)
    if name == "B":
        return Scene(name, WALLS, PILLARS)
    return Scene(name, WALLS, grid(int(name[1:])))


def grid(count):
    """`count` pillars on an even grid, except one that would contain the source."""
    side = math.isqrt(count)
    steps = [ROOM[0] * (step + 0.5) / side for step in range(side)]
    places = [(x, z) for z in steps for x in steps]
    source = (SOURCE[0], SOURCE[2])
    return [(x, z, THIN) for x, z in places if math.dist((x, z), source) > THIN]


def text(scene):
    """The text for the C++ programs (see scene.h)."""
    lines = [
        words("room", ROOM),
        words("source", SOURCE),
        words("listener", (*LISTENER, LISTENER_RADIUS)),
        words("turn", turn(SEED)),
    ]
    lines += [words("box", (*low, *high)) for low, high in scene.boxes]
    lines += [words("pillar", pillar) for pillar in scene.pillars]
    return "\n".join(lines) + "\n"


def words(name, numbers):
    return " ".join([name, *(f"{number:.9g}" for number in numbers)])


def ron(scene):
    """The scene file for Echomarch."""
    surfaces = [surface("room", f"Room(size: {vector(ROOM)})", middle((0, 0, 0), ROOM))]
    for low, high in scene.boxes:
        size = [high - low for low, high in zip(low, high)]
        surfaces.append(surface("wall", f"Box(size: {vector(size)})", middle(low, high)))
    for x, z, radius in scene.pillars:
        surfaces.append(surface("pillar", f"Cylinder(radius: {radius:.9g})", (x, 0, z)))
    return (
        f"// Scene {scene.name} of scripts/peers.sh.\n"
        f'Scene(\n    name: "{scene.name}",\n    surfaces: [\n'
        + "".join(f"        {line},\n" for line in surfaces)
        + f"    ],\n    source: Source(position: {vector(SOURCE)}),\n"
        f"    listener: Listener(position: {vector(LISTENER)}, radius: {LISTENER_RADIUS:.9g}),\n)\n"
    )


def surface(name, shape, position):
    return f'Surface(name: "{name}", shape: {shape}, position: {vector(position)})'


def middle(low, high):
    return [0.5 * (low + high) for low, high in zip(low, high)]


def vector(numbers):
    return "(" + ", ".join(f"{number:.9g}" for number in numbers) + ")"


def turn(seed):
    """The rotation of the lattice of directions that Echomarch draws for a seed: uniform over all
    rotations (Shoemake 1992) by SplitMix64, as in src/tracer/directions.rs."""
    share, first, second = (unit_interval(mixed(seed << 32 | counter)) for counter in range(3))
    a, b = math.sqrt(1 - share), math.sqrt(share)
    first, second = math.tau * first, math.tau * second
    return (a * math.sin(first), a * math.cos(first), b * math.sin(second), b * math.cos(second))


def mixed(index):
    limit = (1 << 64) - 1
    bits = (index + 1) * 0x9E3779B97F4A7C15 & limit
    bits = (bits ^ bits >> 30) * 0xBF58476D1CE4E5B9 & limit
    bits = (bits ^ bits >> 27) * 0x94D049BB133111EB & limit
    return bits ^ bits >> 31


def unit_interval(bits):
    return (bits >> 11) / (1 << 53)


def write(folder):
    """Writes all scenes, as NAME.ron and NAME.txt."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        made = scene(name)
        (folder / f"{name}.ron").write_text(ron(made))
        (folder / f"{name}.txt").write_text(text(made))


if __name__ == "__main__":
    import sys

    write(sys.argv[1])
