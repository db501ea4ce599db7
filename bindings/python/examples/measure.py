"""Measures Echomarch and pyroomacoustics at equal error, in one run.

    python measure.py [-o FILE.md] [--error 0.01] [--rounds 8] [--one-core] [--quick]

Each program doubles its number of waves or rays until the error of T30 over several seeds is at most `--error`. The
error is the root mean square deviation from the program's own converged T30, the mean of two runs with many waves or
rays. It thus contains the spread over the seeds and the bias of few rays. Both programs compute exact reflections up to
the same order. Echomarch: T30 of `figures` at 1 kHz. pyroomacoustics: `measure_rt60(decay_db=30)` of its impulse
responses at 16 kHz; absorption does not depend on frequency. No place is on an axis of symmetry: there, reflections
arrive at the same time, and pyroomacoustics adds their pressures instead of their energies. The times are medians: in a
warm process, also the time of all its threads on processor cores, and of a whole process with the import and the first
response.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np

RATE_HZ = 16_000
RADIUS_M = 0.5
ORDER = 3
LEAST, MOST, CONVERGED = 1024, 1 << 17, 1 << 17


class Room:
    """A room with places in metres from a corner: x and z on the floor, y upwards."""

    def __init__(self, name, outline, height, absorption, scattering, sources, listeners):
        self.name, self.outline, self.height = name, outline, height
        self.absorption, self.scattering = absorption, scattering
        self.sources, self.listeners = sources, listeners

    def echomarch(self):
        import echomarch as em

        if len(self.outline) == 4:
            (width, depth), height = self.outline[2], self.height
            scene = em.Scene.empty(self.name)
            scene.scattering = self.scattering
            shape = f"Room(size: ({width}, {height}, {depth}))"
            scene.add_surface(shape, (width / 2, height / 2, depth / 2), material=self.absorption)
        else:
            # An L is the union of two boxes: the outline's corners 0, 1, 2 and 0, 4, 5.
            boxes = []
            for far in (self.outline[2], self.outline[4]):
                size = (far[0], self.height, far[1])
                middle = tuple(length / 2 for length in size)
                boxes.append(f"Translate(of: Box(size: {size}), by: {middle})")
            scene = em.Scene.empty(self.name)
            scene.scattering = self.scattering
            scene.add_surface(f"Complement(of: Union(of: [{', '.join(boxes)}]))", material=self.absorption)
        for index, place in enumerate(self.sources):
            scene.add_source(f"s{index}", place)
        for index, place in enumerate(self.listeners):
            scene.add_listener(f"l{index}", place, radius=RADIUS_M)
        return scene

    def pyroomacoustics(self, rays):
        import pyroomacoustics as pra

        material = pra.Material(self.absorption, self.scattering)
        corners = np.array(self.outline, dtype=float).T
        if len(self.outline) == 4:
            size = [*self.outline[2], self.height]
            room = pra.ShoeBox(size, fs=RATE_HZ, materials=material, max_order=ORDER, ray_tracing=True)
        else:
            room = pra.Room.from_corners(corners, fs=RATE_HZ, materials=material, max_order=ORDER, ray_tracing=True)
            room.extrude(self.height, materials=material)
        room.set_ray_tracing(n_rays=rays, receiver_radius=RADIUS_M)
        # pyroomacoustics: x, y on the floor, z upwards.
        for x, y, z in self.sources:
            room.add_source([x, z, y])
        for x, y, z in self.listeners:
            room.add_microphone([x, z, y])
        return room


def grid(xs, zs, height):
    return [(x, height, z) for x in xs for z in zs]


ROOMS = {
    "shoebox": Room("shoebox", [(0, 0), (8, 0), (8, 5), (0, 5)], 3.0, 0.2, 0.0, [(2.3, 1.6, 1.2)], [(6.1, 1.1, 3.4)]),
    "L": Room(
        "L", [(0, 0), (10, 0), (10, 4), (4, 4), (4, 9), (0, 9)], 3.0, 0.15, 0.3, [(8.5, 1.5, 2.0)], [(2, 1.2, 7.5)]
    ),
    "10 × 10": Room(
        "10 × 10",
        [(0, 0), (12, 0), (12, 8), (0, 8)],
        4.0,
        0.2,
        0.1,
        grid((1.1, 2, 3.1, 4, 5.2), (1.4, 6.1), 1.5),
        grid((7, 8.2, 9.1, 10.3, 11.2), (2.2, 5.5), 1.2),
    ),
}


def with_echomarch(room, waves, seed):
    """T30 of each pair in seconds."""
    import echomarch as em

    scene = room.echomarch()
    found = em.responses(scene.pairs(), waves=waves, order=ORDER, seed=seed)
    for r in found:
        r.ir(RATE_HZ)
    return [r.figures["t30"][4] for r in found]


def with_pyroomacoustics(room, rays, seed):
    """T30 of each pair in seconds."""
    import pyroomacoustics as pra

    pra.random.seed(seed)
    made = room.pyroomacoustics(rays)
    made.compute_rir()
    rirs = [rir for of_microphone in made.rir for rir in of_microphone]
    return [pra.experimental.measure_rt60(rir, fs=RATE_HZ, decay_db=30) for rir in rirs]


PROGRAMS = {"echomarch": with_echomarch, "pyroomacoustics": with_pyroomacoustics}


def converged(program, room):
    """T30 of each pair in seconds with many waves or rays."""
    return np.mean([PROGRAMS[program](room, CONVERGED // len(room.sources), 1_000 + seed) for seed in range(2)], axis=0)


def tried(program, room, count, rounds, true):
    """Relative error of T30 over seeds, mean T30, median seconds, and median seconds of all threads."""
    times, seconds, busy = [], [], []
    for seed in range(1, rounds + 1):
        begin, begin_busy = time.perf_counter(), time.process_time()
        times.append(PROGRAMS[program](room, count, seed))
        seconds.append(time.perf_counter() - begin)
        busy.append(time.process_time() - begin_busy)
    times = np.array(times)
    medians = statistics.median(seconds), statistics.median(busy)
    if np.isnan(times).any():
        return np.inf, np.nan, *medians
    error = np.sqrt(np.mean((times / true - 1.0) ** 2))
    return error, times.mean(), *medians


def whole_process(program, name, count, rounds):
    """Median seconds of a process that imports, traces once and ends."""
    seconds = []
    for seed in range(1, rounds + 1):
        begin = time.perf_counter()
        command = [sys.executable, __file__, "--once", program, name, str(count), str(seed)]
        subprocess.run(command, check=True, capture_output=True)
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds)


def measure(name, error, rounds, least=LEAST):
    """A row for each program: the smallest number of waves or rays with the error."""
    room, rows = ROOMS[name], {}
    for program in PROGRAMS:
        PROGRAMS[program](room, least, 1)
        true, count = converged(program, room), least
        while True:
            found, t30, seconds, busy = tried(program, room, count, rounds, true)
            shown = f"{found:.2%}, T30 {t30:.3f} s, {seconds:.3f} s, threads {busy:.3f} s"
            print(f"{name}, {program}: {count}: {shown}", file=sys.stderr, flush=True)
            if found <= error or count >= MOST:
                break
            count *= 2
        process = whole_process(program, name, count, min(rounds, 3))
        times = {"seconds": seconds, "busy": busy, "process": process}
        rows[program] = {"count": count, "error": found, "t30": float(np.mean(true)), **times}
    return rows


def markdown(all_rows, error, cores):
    import echomarch as em
    import pyroomacoustics as pra

    lines = [
        f"echomarch {em.__version__} on {em.renderer()}, pyroomacoustics {pra.__version__}, {cores} core(s). "
        f"T30 with an error of at most {error:.1%}.",
        "",
        "| room | program | waves or rays | error | converged T30 | warm | threads | whole process |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name, rows in all_rows.items():
        for program, row in rows.items():
            lines.append(
                f"| {name} | {program} | {row['count']:,} | {row['error']:.2%} | {row['t30']:.3f} s "
                f"| {row['seconds']:.3f} s | {row['busy']:.3f} s | {row['process']:.2f} s |"
            )
        ours, theirs = rows["echomarch"], rows["pyroomacoustics"]
        ratios = (theirs[key] / ours[key] for key in ("seconds", "busy", "process"))
        lines.append("| {} | **times as fast** | | | | **{:.1f}** | **{:.1f}** | **{:.1f}** |".format(name, *ratios))
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=pathlib.Path)
    parser.add_argument("--error", type=float, default=0.01)
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--one-core", action="store_true")
    parser.add_argument("--quick", action="store_true", help="two rounds and a rough error, for a trial")
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS), choices=list(ROOMS))
    parser.add_argument("--once", nargs=4, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.once:
        program, name, count, seed = given.once
        PROGRAMS[program](ROOMS[name], int(count), int(seed))
        return
    if given.one_core:
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    error, rounds = (0.2, 2) if given.quick else (given.error, given.rounds)
    # A run has a hundred pairs, each with its own error, so that few runs suffice.
    many = {"10 × 10": (min(rounds, 2), 4096)}
    all_rows = {name: measure(name, error, *many.get(name, (rounds, LEAST))) for name in given.rooms}
    text = markdown(all_rows, error, len(os.sched_getaffinity(0)))
    print(text)
    print(json.dumps(all_rows), file=sys.stderr)
    if given.output:
        given.output.write_text(text)


if __name__ == "__main__":
    main()
