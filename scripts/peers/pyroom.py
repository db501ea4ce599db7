"""Runs the ray tracer of pyroomacoustics on a scene, with the interface of the C++ programs (see peer.h).

    pyroom.py SCENE.txt WAVES ITERATIONS FRAMES

Scene A is the shoe box of pyroomacoustics, the other scenes are its general room of polygons. Pillars are
prisms of 16 sides (the intersection tests every wall, so more sides would only be slower). Rays start in the given
directions, lose half of their energy at each wall, and end below a threshold of energy, which they reach
after ITERATIONS segments. The listener does not end rays, so a few rays are counted twice. The time
includes the computation of the directions and the tracer, which is written in C++, but not the
computation of the impulse response.
"""

import json
import math
import sys
import time
import warnings

import numpy as np
import pyroomacoustics as pra

SIDES = 16
GOLDEN_RATIO = 2654435769


def read(path):
    scene = {"box": [], "pillar": []}
    for line in open(path):
        word, *numbers = line.split()
        numbers = [float(number) for number in numbers]
        if word in ("box", "pillar"):
            scene[word].append(numbers)
        else:
            scene[word] = numbers
    return scene


def directions(scene, waves):
    """The lattice of glsl/direction/fibonacci.glsl."""
    wave = np.arange(waves, dtype=np.uint32)
    angle = 2 * np.pi * ((wave * np.uint32(GOLDEN_RATIO)) >> np.uint32(8)) / 16777216.0
    height = 1 - 2 * (wave + 0.5) / waves
    ring = np.sqrt(1 - height * height)
    points = np.stack([ring * np.cos(angle), height, ring * np.sin(angle)], axis=1)
    return (points @ rotation(*scene["turn"]).T).astype(np.float32)


def rotation(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def room(scene):
    # A wall absorbs half of the energy.
    material = pra.Material(0.5)
    if not scene["box"] and not scene["pillar"]:
        made = pra.ShoeBox(scene["room"], fs=16000, materials=material, max_order=-1, ray_tracing=True)
    else:
        walls = [
            pra.wall_factory(np.array(corners, dtype=np.float32).T, [0.5], [0.0], f"wall {index}")
            for index, corners in enumerate(polygons(scene))
        ]
        made = pra.Room(walls, fs=16000, max_order=-1, ray_tracing=True)
    made.add_microphone(scene["listener"][:3])
    return made


def polygons(scene):
    height = scene["room"][1]
    # Normals point from the air into the solid.
    yield from faces((0, 0, 0), scene["room"], inward=False)
    for box in scene["box"]:
        yield from list(faces(box[:3], box[3:], inward=True))[:4]
    for x, z, radius in scene["pillar"]:
        step = math.tau / SIDES
        wide = radius * math.sqrt(step / math.sin(step))
        corners = [(x + wide * math.cos(step * side), z + wide * math.sin(step * side)) for side in range(SIDES)]
        for (ax, az), (bx, bz) in zip(corners, corners[1:] + corners[:1]):
            yield [(ax, 0, az), (bx, 0, bz), (bx, height, bz), (ax, height, az)]


def faces(low, high, inward):
    """The six faces of a box, the upright faces first."""
    (ax, ay, az), (bx, by, bz) = low, high
    sides = [
        [(ax, ay, az), (ax, ay, bz), (ax, by, bz), (ax, by, az)],
        [(bx, ay, bz), (bx, ay, az), (bx, by, az), (bx, by, bz)],
        [(bx, ay, az), (ax, ay, az), (ax, by, az), (bx, by, az)],
        [(ax, ay, bz), (bx, ay, bz), (bx, by, bz), (ax, by, bz)],
        [(ax, ay, az), (bx, ay, az), (bx, ay, bz), (ax, ay, bz)],
        [(ax, by, bz), (bx, by, bz), (bx, by, az), (ax, by, az)],
    ]
    return (side[::-1] for side in sides) if inward else sides


def trace(made, scene, waves, iterations):
    """Traces all waves; returns the number of hits."""
    # The energy is below the threshold after `iterations` walls, but not after one wall fewer.
    made.set_ray_tracing(
        n_rays=waves,
        receiver_radius=scene["listener"][3],
        energy_thres=0.5 ** (iterations - 0.5),
        time_thres=1000.0,
    )
    made.room_engine.reset_mics()
    energies = np.ones((waves, 1), dtype=np.float32)
    made.room_engine.ray_tracing(directions(scene, waves), energies, np.array(scene["source"], dtype=np.float32))
    return sum(int(h.get_counts().sum()) for h in made.room_engine.microphones[0].histograms)


def main(path, waves, iterations, frames):
    # pyroomacoustics warns against this number of rays, which does not matter here.
    warnings.simplefilter("ignore")
    scene = read(path)
    made = room(scene)
    trace(made, scene, waves, iterations)
    milliseconds = []
    for _ in range(frames):
        began = time.perf_counter()
        trace(made, scene, waves, iterations)
        milliseconds.append(1e3 * (time.perf_counter() - began))
    up_to = [0] + [trace(made, scene, waves, count + 1) for count in range(iterations)]
    hits = [after - before for before, after in zip(up_to, up_to[1:])]
    print(json.dumps({"milliseconds": milliseconds, "hits": hits}))


if __name__ == "__main__":
    main(sys.argv[1], *(int(number) for number in sys.argv[2:5]))
