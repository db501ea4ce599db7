"""Why the decay times of Echomarch and pyroomacoustics differ in the rooms of measure.py.

    python decay_models.py [--rays N] [--rounds N] [--quick]

Two references that share no code with either program: image sources of the shoebox, and rays through a room with
vertical walls, written here with NumPy. The rays are scattered by one of two models:

- chance: a ray is scattered by Lambert's law with a probability of the scattering coefficient s. A share s of the energy
  is scattered, which is the definition of s in ISO 17497-1. Echomarch does this.
- blend: each ray continues in the direction s × (a direction by Lambert's law) + (1 − s) × (the mirrored direction).
  pyroomacoustics 0.10.1 does this.
"""

import argparse

import numpy as np

import measure

SPEED = 343.0
"""Speed of sound of both programs in m/s."""

RECORD_S = 1.4
BIN_S = 1e-3


def t30(times, energies):
    """T30 in s: a line through the backward integral from -5 to -35 dB (ISO 3382-1)."""
    bins = np.bincount((times / BIN_S).astype(int), weights=energies)
    left = np.cumsum(bins[::-1])[::-1]
    levels, at = 10 * np.log10(left[left > 0] / left[0]), BIN_S * np.arange(np.count_nonzero(left))
    fitted = (levels <= -5) & (levels >= -35)
    return -60 / np.polyfit(at[fitted], levels[fitted], 1)[0]


def image_sources(size, source, listener, absorption):
    """Times in s, energies in 1/m², and orders of the image sources of a shoebox."""
    offsets, orders = [], []
    for length, start, end in zip(size, source, listener):
        cells = np.arange(-int(SPEED * RECORD_S / length) - 2, int(SPEED * RECORD_S / length) + 3)
        offsets.append(cells * length + np.where(cells % 2 == 0, start, length - start) - end)
        orders.append(np.abs(cells))
    x, y, z = np.meshgrid(*offsets, indexing="ij", sparse=True)
    order = sum(np.meshgrid(*orders, indexing="ij", sparse=True))
    squares = x**2 + y**2 + z**2
    early = squares < (SPEED * RECORD_S) ** 2
    squares, order = squares[early], order[early]
    return np.sqrt(squares) / SPEED, (1 - absorption) ** order / (4 * np.pi * squares), order


class Walls:
    """Vertical walls over an outline (x, z; counter-clockwise seen from +y with z to the right of x), floor, ceiling."""

    def __init__(self, room):
        self.starts = np.array(room.outline, dtype=float)
        self.sides = np.roll(self.starts, -1, axis=0) - self.starts
        inwards = np.stack([-self.sides[:, 1], self.sides[:, 0]], axis=1)
        inwards /= np.linalg.norm(inwards, axis=1)[:, None]
        upright = np.stack([inwards[:, 0], np.zeros(len(inwards)), inwards[:, 1]], axis=1)
        self.normals = np.vstack([upright, [[0, 1, 0], [0, -1, 0]]])
        self.points = np.vstack([np.insert(self.starts, 1, 0, axis=1), [[0, 0, 0], [0, room.height, 0]]])

    def next_hits(self, places, directions):
        """Distances in m to the next wall, and its number, for each ray."""
        nearest, wall = np.full(len(places), np.inf), np.full(len(places), -1)
        for number, (normal, point) in enumerate(zip(self.normals, self.points)):
            towards = directions @ normal
            ahead = towards < 0
            distance = np.where(ahead, (point - places) @ normal / np.where(ahead, towards, -1), np.inf)
            # The plane of a wall beyond a corner may lie behind the ray.
            closer = ahead & (distance > -1e-9) & (distance < nearest)
            if number < len(self.starts):
                hits = places[:, ::2] + np.where(closer, distance, 0)[:, None] * directions[:, ::2]
                along = (hits - self.starts[number]) @ self.sides[number] / (self.sides[number] @ self.sides[number])
                closer &= (along >= 0) & (along <= 1)
            nearest[closer], wall[closer] = distance[closer], number
        return nearest, wall


def rays(room, source, listener, count, model, seed):
    """Times in s and energies in 1/m² of the rays that cross the listener's sphere."""
    random, walls = np.random.default_rng(seed), Walls(room)
    heights, turns = 1 - (2 * np.arange(count) + 1) / count, np.pi * (3 - 5**0.5) * np.arange(count)
    flat = np.sqrt(1 - heights**2)
    directions = np.stack([flat * np.cos(turns), heights, flat * np.sin(turns)], axis=1)
    places, energies, lengths = np.tile(np.array(source, dtype=float), (count, 1)), np.full(count, 1 / count), np.zeros(count)
    times, heard = [], []
    while len(places):
        distances, wall = walls.next_hits(places, directions)
        to = np.array(listener) - places
        ahead = np.einsum("ij,ij->i", to, directions)
        beside = np.einsum("ij,ij->i", to, to) - ahead**2
        crosses = (ahead > 0) & (ahead < distances) & (beside < measure.RADIUS_M**2)
        times.append((lengths + ahead)[crosses] / SPEED)
        heard.append(energies[crosses] / (np.pi * measure.RADIUS_M**2))
        # A ray that passes a corner within rounding meets no wall.
        on = (wall >= 0) & (lengths + distances < SPEED * RECORD_S)
        distances, normals = distances[on], walls.normals[wall[on]]
        places = places[on] + distances[:, None] * directions[on]
        directions = scattered(directions[on], normals, room.scattering, model, random)
        energies, lengths = energies[on] * (1 - room.absorption), lengths[on] + distances
    return np.concatenate(times), np.concatenate(heard)


def scattered(directions, normals, scattering, model, random):
    """The directions after a reflection."""
    mirrored = directions - 2 * np.einsum("ij,ij->i", directions, normals)[:, None] * normals
    on_sphere = random.normal(size=directions.shape)
    diffuse = normals + on_sphere / np.linalg.norm(on_sphere, axis=1)[:, None]
    diffuse /= np.linalg.norm(diffuse, axis=1)[:, None]
    if model == "chance":
        return np.where((random.random(len(mirrored)) < scattering)[:, None], diffuse, mirrored)
    blended = scattering * diffuse + (1 - scattering) * mirrored
    return blended / np.linalg.norm(blended, axis=1)[:, None]


def eyring(room):
    """Eyring's reverberation time in s, for a diffuse field."""
    corners = np.array(room.outline, dtype=float)
    after = np.roll(corners, -1, axis=0)
    floor = 0.5 * abs(np.sum(corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1]))
    area = 2 * floor + room.height * np.linalg.norm(after - corners, axis=1).sum()
    return 24 * np.log(10) / SPEED * floor * room.height / (-area * np.log(1 - room.absorption))


def tail_of_pyroomacoustics(room, count):
    """Energy of the late part: of the rays' histogram, and of the samples made from it, relative to it."""
    import pyroomacoustics as pra

    made = room.pyroomacoustics(count)
    made.compute_rir()
    [[[histogram]]] = made.rt_histograms
    # Without exact reflections the samples contain the late part alone.
    made.simulator_state["ism_needed"] = False
    energies = []
    for seed in range(20):
        pra.random.seed(seed)
        made.compute_rir()
        energies.append(np.sum(made.rir[0][0] ** 2))
    return histogram.sum(), np.mean(energies) / histogram.sum()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=int, default=50_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="only the shoebox and the L, and few rays of pyroomacoustics")
    given = parser.parse_args()
    shoebox = measure.ROOMS["shoebox"]
    (width, depth), height = shoebox.outline[2], shoebox.height
    size = (width, height, depth)
    times, energies, orders = image_sources(size, shoebox.sources[0], shoebox.listeners[0], shoebox.absorption)
    twice = np.where(orders == measure.ORDER, 2, 1) * energies
    print(f"shoebox: image sources {t30(times, energies):.3f} s", end="; ")
    print(f"with order {measure.ORDER} counted twice {t30(times, twice):.3f} s", flush=True)
    for name in ("L",) if given.quick else ("L", "10 × 10"):
        room = measure.ROOMS[name]
        pairs = list(zip(room.sources, room.listeners))[:: 4 if len(room.sources) > 1 else 1]
        for model in ("chance", "blend"):
            seeds = range(given.rounds)
            found = [t30(*rays(room, *pair, given.rays, model, seed)) for pair in pairs for seed in seeds]
            print(f"{name}, {model}: {np.mean(found):.3f} ± {np.std(found) / len(found) ** 0.5:.3f} s", flush=True)
        print(f"{name}, Eyring: {eyring(room):.3f} s")
    try:
        for count in (4_096,) if given.quick else (4_096, 32_768, 262_144):
            late, samples = tail_of_pyroomacoustics(measure.ROOMS["L"], count)
            print(f"L, pyroomacoustics, {count} rays: late energy {late:.3f}, of the samples {samples:.2f} times this")
    except ImportError:
        print("pyroomacoustics is not installed")


if __name__ == "__main__":
    main()
